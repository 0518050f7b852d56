"""A simulated person without pixels before a vehicle that lives elsewhere: an autopilot in its own simulator.

What pixels do to poses is left out but for its measured noise and bias; ``MountedSource`` renders them.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.protocol import Source
from wigwag.errors import CameraError
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.sim.clips import LANDMARK_BIAS, SensorConfig, landmark_noise
from wigwag.sim.gestures import perform
from wigwag.sim.motion import Operator
from wigwag.sim.person import Person
from wigwag.sim.script import Act, Script, Walk
from wigwag.skeleton import KINECT20, Landmark, Pose, from_kinect20

_FOREVER_S = 1e6
_SILENT_S = 2.0
_NOISE_FRAMES = 900
"""So many frames of noise are drawn, and then again from the first."""
_SEEN = (Landmark.NOSE, Landmark.LEFT_HIP, Landmark.RIGHT_HIP)
"""Nobody is found in a picture that does not show these."""


@dataclass(frozen=True, slots=True)
class Arc(Walk):
    """A walk along part of a circle: the direction bends evenly, the speed is ``speed_m_s`` throughout."""

    def velocity(self, t_s: float) -> Float[np.ndarray, 2]:
        """Velocity at a time of the session, m/s, world ENU."""
        since = t_s - self.start_s
        if not 0 < since < self.duration_s:
            return np.zeros(2)
        speed = self.speed_m_s * min(1.0, since / self.ramp_s(), (self.duration_s - since) / self.ramp_s())
        angle = self.direction_rad + self.bend_rad * since / self.duration_s
        return np.array([speed * math.cos(angle), speed * math.sin(angle)])


@dataclass(frozen=True, slots=True)
class StageConfig:
    """Who is seen, from how far, and by which camera."""

    seed: int = 1
    """Chooses the person and all noise."""
    distance_m: float = 6.5
    """How far ahead of the vehicle's nose the person stands at first."""
    rate_hz: float = 30.0
    """Pictures a second."""
    delay_s: float = 0.05
    """How old a picture is when it comes."""
    half_view_rad: tuple[float, float] = (0.75, 0.50)
    """Half the field of view, across and down: that of a RealSense D435's depth by default."""
    mount: Mount = field(default_factory=lambda: Mount(pitch_down_rad=0.17))
    """How the camera sits on the vehicle. The default sees a standing person's raised hands from the ground,
    and their hips from 3 m above it."""
    sensor: SensorConfig = field(default_factory=SensorConfig)
    """What camera and pose network add to the truth."""


class Stage(Source):
    """A camera without pixels, and what finds the person in its pictures.

    The world begins where the vehicle stands when the first picture is taken: the person stands ahead of its
    nose. They stand, and face the drone, until told what to do by ``show`` and ``walk``.

    Args:
        eyes: Where the camera's carrier is, world ENU: its own state, or the truth where that is known.
        wait: Lets so many seconds pass.
        now_ns: Monotonic nanoseconds, the clock of the states' stamps.
        config: Who is seen, and how.
    """

    address = "stage:"

    def __init__(
        self, eyes: Callable[[], VehicleState], wait: Callable[[float], object], now_ns: Callable[[], int],
        config: StageConfig | None = None,
    ) -> None:  # fmt: skip
        self.config = c = config or StageConfig()
        self._eyes, self._wait, self.now_ns = eyes, wait, now_ns
        self.person = Person.random(c.seed)
        across, down = (math.tan(half) for half in c.half_view_rad)
        self._intrinsics = Intrinsics(fx=320.0 / across, fy=240.0 / down)
        rng = np.random.default_rng([c.seed, 0x57A6E])
        typical = np.full((_NOISE_FRAMES, 13), 4.5)
        self._noise = landmark_noise(rng, typical, c.sensor)
        if c.sensor.bias:
            self._noise = self._noise + LANDMARK_BIAS * self.person.height_m
        self.turn: Callable[[], None] = lambda: None
        """Called once a picture, before it is taken: whoever directs."""
        self.time_s = 0.0
        """Since the first picture."""
        self._operator: Operator | None = None
        self._began_ns = self._last_ns = self._count = 0
        self._due_s = 0.0
        self._pending: deque[Frame] = deque()
        self._poses: dict[int, Pose | None] = {}

    @property
    def place_m(self) -> Float[np.ndarray, " 2"]:
        """Where the person truly is, x and y, world ENU."""
        assert self._operator is not None
        return self._operator.root_xy

    def show(self, label: str, take: int) -> float:
        """Let the person show a gesture from now on.

        Args:
            label: Its name.
            take: Draws how exactly it is shown this time.

        Returns:
            How long it takes, seconds.
        """
        assert self._operator is not None
        motion = perform(label, self.person, [self.config.seed, take])
        script = self._operator.script
        self._operator.script = replace(script, acts=(*script.acts, Act(self.time_s, motion)))
        return motion.duration_s

    def walk(self, speed_m_s: float, radius_m: float, seconds: float) -> None:
        """Let the person walk along a circle from now on, first away from the vehicle, then to its left."""
        assert self._operator is not None
        script, away = self._operator.script, self._operator.heading_rad + math.pi
        arc = Arc(self.time_s, seconds, away, speed_m_s, bend_rad=speed_m_s / radius_m * seconds)
        self._operator.script = replace(script, walks=(*script.walks, arc))

    def open(self) -> None:
        """Nothing to open."""

    def close(self) -> None:
        """Nothing to let go of."""

    def read(self) -> Frame:
        """Let time go on to the next picture that comes, and return it.

        Raises:
            CameraError: If the vehicle tells nothing new of itself for two seconds.
        """
        heard_ns = self.now_ns()
        while True:
            now_s = self.now_ns() * 1e-9
            self._due_s = max(self._due_s, now_s - 1 / self.config.rate_hz) + 1 / self.config.rate_hz
            self._wait(max(self._due_s - now_s, 0.0))
            state = self._eyes()
            if state.stamp_ns > self._last_ns:
                heard_ns = self.now_ns()
                self.turn()
                self._shoot(state)
            elif self.now_ns() - heard_ns > _SILENT_S * 1e9:
                raise CameraError("the vehicle that carries the camera has said nothing new for two seconds.")
            come = None
            while self._pending and self.now_ns() - self._pending[0].stamp_ns >= self.config.delay_s * 1e9:
                come = self._pending.popleft()
            if come is not None:
                return come

    def __call__(self, frame: Frame) -> Pose | None:
        """Find the person in a picture of this stage: a pose source for the pilot."""
        return self._poses.get(frame.stamp_ns)

    def _shoot(self, state: VehicleState) -> None:
        """Take a picture of the person: a few bytes that are like no other's."""
        c = self.config
        if self._operator is None:
            ahead = np.array([math.cos(state.heading_rad), math.sin(state.heading_rad)])
            x, y = state.position_m[:2] + c.distance_m * ahead
            script = Script((), (), (), _FOREVER_S)
            self._operator = Operator(
                self.person, script, (float(x), float(y)), state.heading_rad + math.pi, seed=c.seed
            )
            self._began_ns, self._last_ns = state.stamp_ns, state.stamp_ns - round(1e9 / c.rate_hz)
        step_s = (state.stamp_ns - self._last_ns) * 1e-9
        self._last_ns = state.stamp_ns
        self.time_s = (state.stamp_ns - self._began_ns) * 1e-9
        joints = self._operator.step(self.time_s + 1 / 30, step_s, state.position_m)
        self._count += 1
        self._poses[state.stamp_ns] = self._seen(state, joints)
        while len(self._poses) > 2 * c.rate_hz:
            del self._poses[next(iter(self._poses))]
        rgb = np.frombuffer(self._count.to_bytes(4, "little") * 12, np.uint8).reshape(4, 4, 3)
        depth = np.full((4, 4), 1000 + self._count % 5000, np.uint16)
        self._pending.append(Frame(rgb, depth, self._intrinsics, state.stamp_ns))

    def _seen(self, state: VehicleState, joints: Float[np.ndarray, "20 3"]) -> Pose | None:
        """Measure the person as the camera and the pose network do; ``None``: not in the picture."""
        mount = self.config.mount
        body = (joints - state.position_m) @ rotation(state) - mount.offset_m
        cos, sin = math.cos(mount.pitch_down_rad), math.sin(mount.pitch_down_rad)
        forward, down = cos * body[:, 0] - sin * body[:, 2], -sin * body[:, 0] - cos * body[:, 2]
        # Kinect axes and back: the one place that knows which joint stands in for which landmark.
        seen = from_kinect20(np.stack([body[:, 1], -down, forward], axis=1), KINECT20)
        across, along = self.config.half_view_rad
        for right, low, far in seen[list(_SEEN)]:
            if far <= 0 or abs(math.atan2(right, far)) > across or abs(math.atan2(low, far)) > along:
                return None
        return Pose(seen + self._noise[self._count % _NOISE_FRAMES], np.ones(13), state.stamp_ns)


__all__ = ["Arc", "Stage", "StageConfig"]
