"""A world without pixels: poses come straight from where people stand, as a good camera would measure them.

For many flights in little time: faults, limits, the follow law. What pixels do to poses is left out, but for
noise, lateness and loss; ``World`` has the rest.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.skeleton import Landmark, Pose
from wigwag.vehicles.protocol import Vehicle
from wigwag.vehicles.simulated import Airframe, AutopilotConfig, SimulatedVehicle

HIPS_M = 0.95
"""Height of a person's hips."""

_FIGURE = np.zeros((13, 3))
for _landmark, (_left, _up) in {
    Landmark.NOSE: (0, 0.75), Landmark.LEFT_SHOULDER: (0.2, 0.5), Landmark.RIGHT_SHOULDER: (-0.2, 0.5),
    Landmark.LEFT_ELBOW: (0.25, 0.2), Landmark.RIGHT_ELBOW: (-0.25, 0.2),
    Landmark.LEFT_WRIST: (0.25, -0.05), Landmark.RIGHT_WRIST: (-0.25, -0.05),
    Landmark.LEFT_HIP: (0.12, 0), Landmark.RIGHT_HIP: (-0.12, 0),
    Landmark.LEFT_KNEE: (0.12, -0.45), Landmark.RIGHT_KNEE: (-0.12, -0.45),
    Landmark.LEFT_HEEL: (0.12, -0.9), Landmark.RIGHT_HEEL: (-0.12, -0.9),
}.items():  # fmt: skip
    _FIGURE[_landmark, 1:] = _left, _up
"""A person with lowered arms about their hips, facing along +x; y to their left, z up."""

Walk = Callable[[float], tuple[float, float]]
"""Where a person stands (x and y, metres, world ENU) at a time in seconds."""


class Flown(Airframe, Protocol):
    """An airframe that tells the truth about itself, for whoever looks from it and whoever judges."""

    @property
    def state(self) -> VehicleState:
        """The truth."""
        ...


class Stepped(Vehicle, Protocol):
    """A vehicle that lives on a clock turned by hand."""

    def step(self, dt_s: float) -> None:
        """Fly on for ``dt_s`` seconds."""
        ...


@dataclass(frozen=True, slots=True)
class SketchConfig:
    """How a pose is measured."""

    rate_hz: float = 30.0
    delay_s: float = 0.05
    """How old a picture is when it comes."""
    jitter_s: float = 0.0
    """Further delay of single pictures, up to this."""
    lost: float = 0.0
    """Share of pictures in which nobody is found."""
    noise_m: float = 0.012
    """Of each landmark, across the line of sight; twice as much along it."""
    sight_m: float = 10.0
    """Nobody is found farther away than this."""
    half_view_rad: float = 0.48
    """Nor farther from the middle of the picture than this."""
    mount: Mount = field(default_factory=Mount)
    autopilot: AutopilotConfig = field(default_factory=AutopilotConfig)


@dataclass(slots=True)
class Faults:
    """What is wrong just now. A world's faults are set while it runs."""

    no_frames: bool = False
    frozen: bool = False
    """The camera repeats its last picture, under new stamps."""
    late_s: float = 0.0
    """Further delay of every picture."""
    hidden: bool = False
    """The person is behind something."""
    other: Walk | None = None
    """Somebody else, who is found in the person's stead."""
    broken_pose: bool = False
    """Landmarks that are no numbers."""


class SketchWorld:
    """A person, a vehicle, and a camera that measures poses, on one clock stepped by hand.

    Args:
        airframe: What flies, such as ``Response`` or ``Quadrotor``.
        person: Where the person is.
        config: How a pose is measured.
        seed: Draws noise and loss.
        vehicle: What steers the airframe and is stepped with the world; by default a ``SimulatedVehicle``.

    Example:
        >>> from wigwag.sim.response import Response
        >>> world = SketchWorld(Response(), lambda t: (4.0, 0.0))
        >>> for _ in range(10):
        ...     frame = world.step()
        >>> pose = world(frame)
        >>> bool(abs(pose.hip_center[2] - 3.9) < 0.1)
        True
    """

    def __init__(
        self, airframe: Flown, person: Walk, config: SketchConfig | None = None, seed: int = 0,
        vehicle: Stepped | None = None,
    ) -> None:  # fmt: skip
        self.config = config = config or SketchConfig()
        self.airframe, self.person, self.faults = airframe, person, Faults()
        self.vehicle: Stepped = vehicle or SimulatedVehicle(
            airframe, config.autopilot, airborne=not airframe.on_ground
        )
        self._rng = np.random.default_rng([seed, 0x5CE7])
        self._pending: deque[tuple[int, Frame]] = deque()
        """Pictures on their way: when they come, and what they are."""
        self._taken: deque[tuple[int, VehicleState, tuple[float, float]]] = deque(maxlen=90)
        """Where vehicle and person were when the pictures were taken."""
        self._intrinsics = Intrinsics()
        self._count = 0
        self._last: Frame | None = None

    @property
    def now_ns(self) -> int:
        """The time, nanoseconds since the world began."""
        return self.airframe.state.stamp_ns

    @property
    def person_m(self) -> tuple[float, float]:
        """Where the person is."""
        return self.person(self.now_ns * 1e-9)

    @property
    def distance_m(self) -> float:
        """True horizontal distance from the vehicle to the person."""
        x, y = self.person_m
        at = self.airframe.state.position_m
        return math.hypot(x - at[0], y - at[1])

    @property
    def bearing_rad(self) -> float:
        """True bearing of the person from the vehicle's nose, positive to the left."""
        x, y = self.person_m
        state = self.airframe.state
        angle = math.atan2(y - state.position_m[1], x - state.position_m[0]) - state.heading_rad
        return (angle + math.pi) % (2 * math.pi) - math.pi

    def step(self) -> Frame | None:
        """Go on by one frame of the camera; return the newest picture that came, ``None``: none came."""
        period_s = 1.0 / self.config.rate_hz
        self.vehicle.step(period_s)
        now_ns = self.now_ns
        if not self.faults.no_frames:
            self._shoot(now_ns)
        frame = None
        while self._pending and self._pending[0][0] <= now_ns:
            frame = self._pending.popleft()[1]
        return frame

    def __call__(self, frame: Frame) -> Pose | None:
        """Find the person in a frame of this world: a pose source for the pilot.

        Raises:
            InputError: While ``faults.broken_pose``.
        """
        found = next((taken for taken in self._taken if taken[0] == frame.stamp_ns), None)
        if found is None or self.faults.hidden or self._rng.random() < self.config.lost:
            return None
        _, state, person = found
        joints = self._seen(state, person)
        if self.faults.broken_pose:
            joints[:] = np.nan
        middle = joints[[Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean(axis=0)
        if (
            abs(math.atan2(middle[0], middle[2])) > self.config.half_view_rad
            or middle[2] > self.config.sight_m
        ):
            return None
        return Pose(joints, np.ones(13), frame.stamp_ns)

    def _shoot(self, now_ns: int) -> None:
        """Take a picture: a few bytes that are like no other's."""
        faults, config = self.faults, self.config
        self._count += 1
        rgb = np.frombuffer(self._count.to_bytes(4, "little") * 12, np.uint8).reshape(4, 4, 3)
        depth = np.full((4, 4), 1000 + self._count % 5000, np.uint16)
        if faults.frozen and self._last is not None:
            rgb, depth = self._last.rgb, np.asarray(self._last.depth_mm)
        frame = self._last = Frame(rgb, depth, self._intrinsics, now_ns)
        late_s = config.delay_s + faults.late_s + config.jitter_s * self._rng.random()
        self._pending.append((now_ns + round(late_s * 1e9), frame))
        person = self.person(now_ns * 1e-9) if faults.other is None else faults.other(now_ns * 1e-9)
        self._taken.append((now_ns, self.airframe.state, person))

    def _seen(self, state: VehicleState, person: tuple[float, float]) -> Float[np.ndarray, "13 3"]:
        """Place the figure, facing the vehicle, and measure it: camera optical frame."""
        mount, (x, y) = self.config.mount, person
        facing = math.atan2(state.position_m[1] - y, state.position_m[0] - x)
        cos, sin = math.cos(facing), math.sin(facing)
        world = _FIGURE @ np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) + [x, y, HIPS_M]
        body = (world - state.position_m) @ rotation(state) - mount.offset_m
        cos, sin = math.cos(mount.pitch_down_rad), math.sin(mount.pitch_down_rad)
        forward, down = cos * body[:, 0] - sin * body[:, 2], -sin * body[:, 0] - cos * body[:, 2]
        noise = self.config.noise_m * self._rng.standard_normal((13, 3)) * [1.0, 1.0, 2.0]
        return np.asarray(np.stack([-body[:, 1], down, forward], axis=1) + noise)
