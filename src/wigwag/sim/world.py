"""The whole world around the chain: an operator, a drone, and the camera it carries."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.fly.operator import Mount
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.exposure import Exposure, ExposureConfig
from wigwag.sim.noise import SensorNoise, SensorNoiseConfig
from wigwag.sim.paint import Look
from wigwag.sim.quadrotor import Quadrotor, QuadrotorConfig
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig
from wigwag.skeleton import KINECT20
from wigwag.vehicles.simulated import AutopilotConfig, SimulatedVehicle

_LEFT_HIP, _RIGHT_HIP = KINECT20.index("left_hip"), KINECT20.index("right_hip")


class Body(Protocol):
    """Anything that moves like a person, for example ``wigwag.sim.motion.Operator``."""

    def step(
        self, t_s: float, dt_s: float, drone_position_m: Float[np.ndarray, 3]
    ) -> Float[np.ndarray, "20 3"]:
        """Go on to time ``t_s``; joints in metres, world ENU, in the order of ``KINECT20``."""
        ...


@dataclass(frozen=True, slots=True)
class WorldConfig:
    """Everything about the world that can be set."""

    rate_hz: float = 30.0
    """Of the camera."""
    delay_frames: int = 1
    """How many frames the picture is late when the chain gets it."""
    intrinsics: Intrinsics = field(default_factory=Intrinsics)
    mount: Mount = field(default_factory=Mount)
    quadrotor: QuadrotorConfig = field(default_factory=QuadrotorConfig)
    autopilot: AutopilotConfig = field(default_factory=AutopilotConfig)
    scene: SceneConfig = field(default_factory=SceneConfig)
    noise: SensorNoiseConfig | None = field(default_factory=SensorNoiseConfig)
    """``None``: a perfect sensor."""
    exposure: ExposureConfig | None = None
    """How dark it is; ``None``: broad daylight."""

    def __post_init__(self) -> None:
        """Check what would otherwise surface far from here."""
        if not self.rate_hz > 0:
            raise InputError(f"WorldConfig.rate_hz must be above 0, but got {self.rate_hz}.")
        if self.delay_frames < 0:
            raise InputError(f"WorldConfig.delay_frames must be 0 or more, but got {self.delay_frames}.")


@dataclass(frozen=True, slots=True)
class Truth:
    """How it really was when a picture was taken. For judging only: the chain never sees it."""

    stamp_ns: int
    joints_m: Float[np.ndarray, "20 3"]
    """Kinect-20, world frame ENU."""
    camera: CameraPose
    drone: VehicleState
    """The true one, world frame ENU."""
    others_m: tuple[Float[np.ndarray, "20 3"], ...] = ()
    """Everybody else's joints, Kinect-20, world frame ENU."""

    @property
    def other_hip_centers_m(self) -> Float[np.ndarray, "others 3"]:
        """Middle of everybody else's hips, world frame."""
        others = np.asarray(self.others_m).reshape(-1, len(KINECT20), 3)
        return np.asarray((others[:, _LEFT_HIP] + others[:, _RIGHT_HIP]) / 2)

    @property
    def hip_center_m(self) -> Float[np.ndarray, 3]:
        """Middle of the hips, world frame."""
        return np.asarray((self.joints_m[_LEFT_HIP] + self.joints_m[_RIGHT_HIP]) / 2)

    @property
    def hip_center_camera_m(self) -> Float[np.ndarray, 3]:
        """Middle of the hips, camera optical frame."""
        return self.camera.to_camera(self.hip_center_m)

    @property
    def distance_m(self) -> float:
        """Horizontal distance from the drone to the middle of the hips."""
        away = (self.hip_center_m - self.drone.position_m)[:2]
        return float(np.hypot(away[0], away[1]))

    @property
    def bearing_rad(self) -> float:
        """Where the operator stands from the drone's nose, positive to the left, within pi."""
        away = self.hip_center_m - self.drone.position_m
        angle = np.arctan2(away[1], away[0]) - self.drone.heading_rad
        return float((angle + np.pi) % (2 * np.pi) - np.pi)


@dataclass(slots=True)
class Spent:
    """Milliseconds that the newest step took, by part."""

    physics_ms: float = 0.0
    operator_ms: float = 0.0
    render_ms: float = 0.0
    noise_ms: float = 0.0


class World:
    """Operator, drone and camera on one clock, stepped by hand.

    Args:
        config: What the world is like.
        seed: Draws clothes, surroundings, gusts, and all noise.
        operator: Who stands in front of the drone.
        look: How the operator looks; drawn from the seed if ``None``. A known person's head and limbs fit
            if it is ``Look.from_seed(seed, person.height_m)``.
        others: Who else is there, and how each looks.
        clock: Processor seconds of the calling thread, for ``spent`` only.

    Example:
        >>> import numpy as np
        >>> class Statue:
        ...     def step(self, t_s, dt_s, drone_position_m):
        ...         return np.linspace([4, 0, 1.7], [4, 0, 0.0], 20)
        >>> world = World(WorldConfig(), seed=1, operator=Statue())
        >>> frame = world.step(Setpoint((0.2, 0.0, 0.0)))
        >>> frame.rgb.shape, world.now_ns - frame.stamp_ns
        ((480, 640, 3), 33333333)
    """

    def __init__(
        self,
        config: WorldConfig,
        seed: int,
        operator: Body,
        look: Look | None = None,
        *,
        others: Sequence[tuple[Body, Look]] = (),
        clock: Callable[[], float] = time.thread_time,
    ) -> None:
        self.config = config
        self.spent = Spent()
        self._operator, self._look, self._clock = operator, look or Look.from_seed(seed), clock
        self._quadrotor = Quadrotor(config.quadrotor, seed)
        self._vehicle = SimulatedVehicle(
            self._quadrotor, config.autopilot, airborne=config.quadrotor.position_m[2] > 0
        )
        self._noise = SensorNoise(config.noise, config.intrinsics, seed) if config.noise else None
        self._exposure = Exposure(config.exposure, seed) if config.exposure else None
        self._others = tuple(others)
        self._count = 0
        self._joints, self._joints_of_others = self._move(1.0 / config.rate_hz)
        middle = (self._joints[_LEFT_HIP] + self._joints[_RIGHT_HIP])[:2] / 2
        clear = np.stack([middle, np.asarray(config.quadrotor.position_m[:2], float)])
        self._renderer = Renderer(config.intrinsics, Scene(config.scene, seed, clear=clear))
        self._pending: deque[tuple[Frame, Truth]] = deque()
        """Pictures that are on their way, oldest first."""
        self._fill()

    @property
    def vehicle(self) -> SimulatedVehicle:
        """The drone, as the pilot talks to it."""
        return self._vehicle

    @property
    def now_ns(self) -> int:
        """The time, nanoseconds since the world began."""
        return self._quadrotor.state.stamp_ns

    @property
    def truth(self) -> Truth:
        """How it was when the frame returned last was taken."""
        return self._returned

    @property
    def truth_now(self) -> Truth:
        """How it is now: later than the frame returned last by the camera's delay."""
        return Truth(self.now_ns, self._joints, self._camera(), self._quadrotor.state, self._joints_of_others)

    def step(self, setpoint: Setpoint | None = None) -> Frame:
        """Go on by one frame of the camera and return the newest picture that has arrived.

        Args:
            setpoint: Sent to the vehicle first, as of now; ``None`` sends nothing.
        """
        if setpoint is not None:
            self._vehicle.send(setpoint, self.now_ns)
        self._count += 1
        target_s = self._count / self.config.rate_hz
        dt_s = target_s - self._quadrotor.time_s
        began = self._clock()
        self._vehicle.step(dt_s)
        flown = self._clock()
        self._joints, self._joints_of_others = self._move(dt_s)
        self.spent.physics_ms = 1e3 * (flown - began)
        self.spent.operator_ms = 1e3 * (self._clock() - flown)
        self._pending.append(self._shoot(self.truth_now))
        frame, self._returned = self._pending.popleft()
        return frame

    def _fill(self) -> None:
        """Let the first pictures be on their way, as if the world had stood still before."""
        period_ns = 1e9 / self.config.rate_hz
        frame, truth = self._shoot(self.truth_now)
        self._returned = truth
        for k in range(self.config.delay_frames, 0, -1):
            stamp = round(-(k - 1) * period_ns)
            self._pending.append((Frame(frame.rgb, frame.depth_mm, frame.intrinsics, stamp), truth))

    def _move(self, dt_s: float) -> tuple[Float[np.ndarray, "20 3"], tuple[Float[np.ndarray, "20 3"], ...]]:
        at = self._quadrotor.state.position_m
        bodies = [self._operator, *(body for body, _ in self._others)]
        moved = [np.asarray(body.step(self._quadrotor.time_s, dt_s, at), dtype=np.float64) for body in bodies]
        return moved[0], tuple(moved[1:])

    def _camera(self) -> CameraPose:
        mount = self.config.mount
        return CameraPose.on_body(
            self._quadrotor.state.position_m, self._quadrotor.rotation, mount.offset_m, mount.pitch_down_rad
        )

    def _shoot(self, truth: Truth) -> tuple[Frame, Truth]:
        began = self._clock()
        looks = [self._look, *(look for _, look in self._others)]
        people = list(zip((truth.joints_m, *truth.others_m), looks, strict=True))
        rgb, depth = self._renderer.render(truth.camera, people)
        rendered = self._clock()
        if self._exposure is not None:
            rgb = self._exposure.apply(rgb)
        if self._noise is not None:
            rgb, depth = self._noise.apply(rgb, depth)
        self.spent.render_ms = 1e3 * (rendered - began)
        self.spent.noise_ms = 1e3 * (self._clock() - rendered)
        return Frame(rgb, depth, self.config.intrinsics, truth.stamp_ns), truth
