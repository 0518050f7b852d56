"""Vehicles by how they answer set-points: what was seen of two autopilots, without flying either.

A response is what remains of a vehicle for whoever steers it by velocities: how late it answers, how quickly,
and whether it overshoots. It costs little, which is what tests of many flights need.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.quadrotor import EstimateConfig
from wigwag.sim.wind import Gusts, WindConfig


@dataclass(frozen=True, slots=True)
class ResponseConfig:
    """How a vehicle answers.

    Raises:
        InputError: If a time is negative or a limit is not positive.
    """

    dead_time_s: float = 0.12
    """Nothing happens for so long after a new velocity."""
    natural_1_s: float = 6.0
    """Natural frequency of the velocity loop, radians a second."""
    damping: float = 1.0
    """Of the velocity loop; below 1 it overshoots."""
    max_acceleration_m_s2: float = 4.0
    max_jerk_m_s3: float = 40.0
    yaw_dead_time_s: float = 0.08
    yaw_lag_s: float = 0.08
    """First-order lag of the rate of turning."""
    telemetry_s: float = 0.04
    """How old a state is when it is told."""
    drag: float = 0.0
    """Share of the wind that moves the vehicle before its loop answers."""
    position_m: tuple[float, float, float] = (0.0, 0.0, 1.5)
    """Where it starts, world ENU; at height 0 with motors off."""
    heading_rad: float = 0.0
    wind: WindConfig = field(default_factory=lambda: WindConfig(gust_m_s=0.0))
    estimate: EstimateConfig = field(default_factory=EstimateConfig)

    def __post_init__(self) -> None:
        """Check what would make it unstable."""
        times = (self.dead_time_s, self.yaw_dead_time_s, self.telemetry_s)
        limits = (self.natural_1_s, self.damping, self.max_acceleration_m_s2, self.max_jerk_m_s3)
        if min(times) < 0 or min(limits) <= 0 or not self.yaw_lag_s > 0:
            raise InputError(
                f"ResponseConfig needs times of 0 or more and limits above 0, but got {times}, {limits} and "
                f"yaw_lag_s={self.yaw_lag_s}."
            )


def px4_like(**changes: object) -> ResponseConfig:
    """Return a response as PX4 1.16 showed it: velocity after 0.25 s, overshooting; yaw after 0.15-0.18 s."""
    return ResponseConfig(
        **{
            "dead_time_s": 0.10, "natural_1_s": 4.5, "damping": 0.5, "max_acceleration_m_s2": 5.0,
            "yaw_dead_time_s": 0.09, "yaw_lag_s": 0.08, "drag": 0.15, **changes,
        }  # type: ignore[arg-type]
    )  # fmt: skip


def ardupilot_like(**changes: object) -> ResponseConfig:
    """Return a response as ArduCopter 4.7 showed it: velocity after 0.26 s, little jerk; yaw after 0.13 s."""
    return ResponseConfig(
        **{
            "dead_time_s": 0.12, "natural_1_s": 7.0, "damping": 1.0, "max_acceleration_m_s2": 2.5,
            "max_jerk_m_s3": 6.0, "yaw_dead_time_s": 0.07, "yaw_lag_s": 0.06, "drag": 0.10, **changes,
        }  # type: ignore[arg-type]
    )  # fmt: skip


class Response:
    """An ``Airframe`` that answers as configured; a stand-in for ``Quadrotor`` where many flights are flown.

    Args:
        config: How it answers.
        seed: Draws gusts and what it believes of itself.
    """

    def __init__(self, config: ResponseConfig | None = None, seed: int = 0) -> None:
        self.config = config = config or ResponseConfig()
        self.time_s = 0.0
        self.motors_on = config.position_m[2] > 0
        self._position = np.array(config.position_m, dtype=np.float64)
        self._velocity, self._acceleration = np.zeros(3), np.zeros(3)
        self._heading, self._turning = config.heading_rad, 0.0
        self._asked: deque[tuple[float, Float[np.ndarray, " 3"], float]] = deque([_NOTHING])
        self._gusts = Gusts(config.wind, seed)
        self._blown = np.zeros(3)
        self._windy = config.wind.gust_m_s > 0 or any(config.wind.mean_m_s)
        self.push_m_s2 = np.zeros(3)
        """A force from outside a unit of mass, world ENU: a gust that nobody foresaw."""
        self._rng = np.random.default_rng([seed, 0x2E5])
        self._home = np.array([config.position_m[0], config.position_m[1], 0.0])
        self._wander, self._heading_wander = np.zeros(3), 0.0
        self._told: deque[VehicleState] = deque()
        self._believe(0.0)

    def step(self, setpoint: Setpoint, dt_s: float) -> None:
        """Fly on for ``dt_s`` seconds under one set-point, in steps of 20 ms at most."""
        steps = max(1, math.ceil(dt_s / 0.02 - 1e-9))
        for _ in range(steps):
            self._step(setpoint, dt_s / steps)
        self._believe(dt_s)

    def set_motors(self, on: bool) -> None:
        """Start or stop the motors. Stopped in the air, it falls."""
        if on and not self.motors_on:
            self._velocity, self._acceleration = np.zeros(3), np.zeros(3)
            self._asked = deque([_NOTHING])
        self.motors_on = on

    @property
    def on_ground(self) -> bool:
        """Whether it touches the ground."""
        return bool(self._position[2] <= 0.002)

    @property
    def state(self) -> VehicleState:
        """The truth, for evaluation."""
        roll, pitch = self._tilt()
        return VehicleState(
            self._position.copy(), self._velocity.copy(), self._heading, self._stamp_ns(), roll, pitch,
            self.motors_on,
        )  # fmt: skip

    @property
    def measured(self) -> VehicleState:
        """What it believes: noisy, drifting, a little old; position from where it was switched on."""
        return self._told[0]

    def _stamp_ns(self) -> int:
        return round(self.time_s * 1e9)

    def _step(self, setpoint: Setpoint, dt: float) -> None:
        c = self.config
        self.time_s += dt
        if not self.motors_on:
            self._velocity = np.zeros(3) if self.on_ground else self._velocity - [0.0, 0.0, 9.81 * dt]
            self._move(dt)
            return
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        forward, left, up = setpoint.velocity_m_s
        asked = np.array([cos * forward - sin * left, sin * forward + cos * left, up])
        self._asked.append((self.time_s, asked, setpoint.yaw_rate_rad_s))
        wanted = self._late(c.dead_time_s)[1]
        turning = self._late(c.yaw_dead_time_s)[2]
        while len(self._asked) > 1 and self._asked[1][0] < self.time_s - c.dead_time_s - c.yaw_dead_time_s:
            self._asked.popleft()
        # Second order: v'' = w^2 (u - v) - 2 z w v'
        jerk = (
            c.natural_1_s**2 * (wanted - self._velocity) - 2 * c.damping * c.natural_1_s * self._acceleration
        )
        jerk = _bounded(jerk, c.max_jerk_m_s3)
        self._acceleration = _bounded(self._acceleration + jerk * dt, c.max_acceleration_m_s2)
        self._velocity = self._velocity + (self._acceleration + self.push_m_s2) * dt
        if self._windy and not self.on_ground:
            blown = c.drag * self._gusts.update(self.time_s, self._position)
            self._velocity, self._blown = self._velocity + blown - self._blown, blown
        self._turning += (turning - self._turning) * (1.0 - math.exp(-dt / c.yaw_lag_s))
        self._heading = (self._heading + self._turning * dt + math.pi) % (2 * math.pi) - math.pi
        self._move(dt)

    def _late(self, dead_time_s: float) -> tuple[float, Float[np.ndarray, " 3"], float]:
        """Return what was asked for a dead time ago."""
        then = self.time_s - dead_time_s
        found = self._asked[0]
        for asked in self._asked:
            if asked[0] > then + 1e-9:
                break
            found = asked
        return found

    def _move(self, dt: float) -> None:
        self._position = self._position + self._velocity * dt
        if self._position[2] <= 0.0:
            self._position[2] = 0.0
            self._velocity = np.array([0.0, 0.0, max(self._velocity[2], 0.0)])

    def _tilt(self) -> tuple[float, float]:
        """Roll and pitch that the acceleration takes, FLU."""
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        east, north = self._acceleration[0], self._acceleration[1]
        forward, left = cos * east + sin * north, -sin * east + cos * north
        return math.atan2(-left, 9.81), math.atan2(forward, 9.81)

    def _believe(self, dt: float) -> None:
        """Let its belief stray for ``dt`` seconds."""
        e, n = self.config.estimate, self._rng.standard_normal(13)
        self._wander = self._wander + e.position_walk_m * math.sqrt(dt) * n[:3]
        self._heading_wander += e.heading_walk_rad * math.sqrt(dt) * n[3]
        roll, pitch = self._tilt()
        self._told.append(
            VehicleState(
                self._position - self._home + self._wander + e.position_noise_m * n[4:7],
                self._velocity + e.velocity_noise_m_s * n[7:10],
                self._heading + self._heading_wander + e.heading_noise_rad * n[12],
                self._stamp_ns(),
                roll + e.attitude_noise_rad * n[10],
                pitch + e.attitude_noise_rad * n[11],
                self.motors_on,
            )
        )
        old_ns = self._stamp_ns() - round(self.config.telemetry_s * 1e9)
        while len(self._told) > 1 and self._told[1].stamp_ns <= old_ns:
            self._told.popleft()


_NOTHING = (-math.inf, np.zeros(3), 0.0)


def _bounded(vector: Float[np.ndarray, " 3"], most: float) -> Float[np.ndarray, " 3"]:
    size = math.sqrt(float(vector @ vector))
    return vector if size <= most else vector * (most / size)
