"""A quadrotor by RotorPy under a velocity loop, and what it believes of itself."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.wind import Gusts, WindConfig

_G = 9.81


@dataclass(frozen=True, slots=True)
class EstimateConfig:
    """How far the drone's belief about itself strays: a fused visual-inertial or GPS estimate."""

    position_walk_m: float = 0.02
    """Random walk of the position, metres after one second (it grows as the square root of time)."""
    position_noise_m: float = 0.005
    velocity_noise_m_s: float = 0.03
    heading_walk_rad: float = 0.002
    """Random walk of the heading, radians after one second."""
    heading_noise_rad: float = 0.003
    attitude_noise_rad: float = 0.003
    """Of roll and pitch."""

    @classmethod
    def exact(cls) -> EstimateConfig:
        """Return the estimate of a drone that knows everything."""
        return cls(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class QuadrotorConfig:
    """An AscTec Hummingbird (0.5 kg) that follows velocity set-points.

    Raises:
        InputError: If it would start below the ground or the loop is too slow for its motors.
    """

    position_m: tuple[float, float, float] = (0.0, 0.0, 1.5)
    """Where it starts, world frame ENU; at height 0 it stands on the ground with motors off."""
    heading_rad: float = 0.0
    rate_hz: float = 100.0
    """Rate of the inner loop and of the physics' steps, at least."""
    max_acceleration_m_s2: float = 2.5
    """How fast a new velocity is taken up, horizontally and vertically."""
    max_yaw_acceleration_rad_s2: float = 6.0
    max_tilt_rad: float = 0.45
    tilt_time_s: float = 0.09
    """How long the attitude loop needs to tilt; the airframe's."""
    velocity_gain: float = 5.5
    """1/s; acceleration a velocity error asks for."""
    position_gain: float = 2.5
    """1/s; velocity that lagging behind the commanded path asks for. Holds against wind and drag."""
    wind: WindConfig = field(default_factory=WindConfig)
    estimate: EstimateConfig = field(default_factory=EstimateConfig)

    def __post_init__(self) -> None:
        """Check what would otherwise fall out of the sky."""
        if self.position_m[2] < 0:
            raise InputError(
                f"QuadrotorConfig.position_m must not lie below the ground, but its height is "
                f"{self.position_m[2]} m; use 0 to start on the ground."
            )
        if not self.rate_hz >= 100:
            raise InputError(
                f"QuadrotorConfig.rate_hz must be 100 or more for the motors to be integrated stably, "
                f"but got {self.rate_hz}."
            )


class Quadrotor:
    """Closed loop of RotorPy's multirotor, seeded, stepped by hand.

    The loop sees the drone's own estimate, not the truth. It moves a point along the commanded velocity
    and steers the drone after it, so that drag leaves no steady error and gusts do not carry it away.

    Args:
        config: Airframe, loop, wind and estimate.
        seed: The same seed and the same set-points give the same flight.
    """

    def __init__(self, config: QuadrotorConfig | None = None, seed: int = 0) -> None:
        # RotorPy takes most of a second to import, so only who flies pays for it.
        from rotorpy.vehicles.hummingbird_params import quad_params
        from rotorpy.vehicles.multirotor import Multirotor

        from wigwag.sim.kutta import Kutta3

        self.config = config = config or QuadrotorConfig()
        self._mass = float(quad_params["mass"])
        hover = float(np.sqrt(self._mass * _G / 4 / quad_params["k_eta"]))
        # Rotor drag at hover, 1/s: force per velocity and mass.
        per_speed = np.array([quad_params["k_d"], quad_params["k_d"], quad_params["k_z"]])
        self._drag = 4 * hover / self._mass * per_speed
        self._idle_rotors = np.full(4, 0.25 * hover)
        self._plant = Multirotor(
            quad_params, control_abstraction="cmd_ctatt", aero=True, enable_ground=True,
            integrator_kwargs={"method": Kutta3},
        )  # fmt: skip
        self._gusts = Gusts(config.wind, seed)
        self._rng = np.random.default_rng([seed, 0xE57])
        self.time_s = 0.0
        self.motors_on = config.position_m[2] > 0
        half = config.heading_rad / 2
        self._state = {
            "x": np.array(config.position_m, float), "v": np.zeros(3),
            "q": np.array([0.0, 0.0, np.sin(half), np.cos(half)]), "w": np.zeros(3), "wind": np.zeros(3),
            "rotor_speeds": np.full(4, hover) if self.motors_on else np.zeros(4),
        }  # fmt: skip
        self._home = np.array([config.position_m[0], config.position_m[1], 0.0])
        self._wander, self._heading_wander = np.zeros(3), 0.0
        self._estimate(0.0)
        self._restart_loop()

    def step(self, setpoint: Setpoint, dt_s: float) -> None:
        """Fly on for ``dt_s`` seconds under one set-point, in steps no longer than the inner loop's."""
        steps = max(1, math.ceil(dt_s * self.config.rate_hz - 1e-9))
        for _ in range(steps):
            self._step(setpoint, dt_s / steps)

    def set_motors(self, on: bool) -> None:
        """Start or stop the motors. Stopped in the air, it falls."""
        if on and not self.motors_on:
            self._restart_loop()
            self._state["rotor_speeds"] = self._idle_rotors.copy()
        self.motors_on = on

    @property
    def on_ground(self) -> bool:
        """Whether it touches the ground."""
        return bool(self._state["x"][2] <= 0.002)

    @property
    def rotation(self) -> Float[np.ndarray, "3 3"]:
        """True attitude: body FLU directions into the world frame."""
        return _matrix(self._state["q"])

    @property
    def state(self) -> VehicleState:
        """The truth, for evaluation; position in the world frame itself."""
        roll, pitch, heading = _euler(self._state["q"])
        return VehicleState(
            self._state["x"].copy(), self._state["v"].copy(), heading, self._stamp_ns(), roll, pitch,
            self.motors_on,
        )  # fmt: skip

    @property
    def measured(self) -> VehicleState:
        """What the drone believes: noisy, drifting, position counted from where it was switched on."""
        roll, pitch, heading = self._believed_attitude
        return VehicleState(
            self._believed_position - self._home, self._believed_velocity.copy(), heading,
            self._stamp_ns(), roll, pitch, self.motors_on,
        )  # fmt: skip

    def _stamp_ns(self) -> int:
        return round(self.time_s * 1e9)

    def _step(self, setpoint: Setpoint, dt: float) -> None:
        self.time_s += dt
        if not self.motors_on and self.on_ground:
            self._state["v"], self._state["w"] = np.zeros(3), np.zeros(3)
            self._state["x"][2] = 0.0
            self._state["rotor_speeds"] = np.zeros(4)
        else:
            self._state["wind"] = self._gusts.update(self.time_s, self._state["x"])
            if self.on_ground:  # the ground slows the air down to nothing
                self._state["wind"] = np.zeros(3)
            control = self._control(setpoint, dt) if self.motors_on else _OFF
            self._state = self._plant.step(self._state, control, dt)
            if self._state["x"][2] < 0:
                self._state["x"][2] = 0.0
        self._estimate(dt)

    def _restart_loop(self) -> None:
        """Forget where the loop was steering to."""
        self._target = self._believed_position.copy()
        self._velocity, self._path = np.zeros(3), np.zeros(3)
        self._heading = self._believed_attitude[2]
        self._yaw_rate = 0.0

    def _control(self, setpoint: Setpoint, dt: float) -> dict[str, object]:
        """Thrust and attitude that follow a set-point."""
        c = self.config
        limit = c.max_yaw_acceleration_rad_s2 * dt
        self._yaw_rate += float(np.clip(setpoint.yaw_rate_rad_s - self._yaw_rate, -limit, limit))
        self._heading += self._yaw_rate * dt
        forward, left, up = setpoint.velocity_m_s
        cos, sin = np.cos(self._believed_attitude[2]), np.sin(self._believed_attitude[2])
        wanted = np.array([cos * forward - sin * left, sin * forward + cos * left, up])
        change = wanted - self._velocity
        size = float(np.sqrt(change @ change))
        if size > c.max_acceleration_m_s2 * dt:
            change *= c.max_acceleration_m_s2 * dt / size
        self._velocity = self._velocity + change
        # The drone first has to tilt, so the path it is held to runs that much behind the push it gets.
        follow = 1.0 - math.exp(-dt / c.tilt_time_s)
        self._path += (self._velocity - self._path) * np.array([follow, follow, 1.0])
        lag = self._target + self._path * dt - self._believed_position
        # Behind by more than this, the target waits: no rush after a gust or a landing.
        reach = max(1.0, float(np.sqrt(lag @ lag)) / 0.6)
        lag = lag / reach
        self._target = self._believed_position + lag
        error = self._path + c.position_gain * lag - self._believed_velocity
        push = change / dt + self._drag * self._path  # what the flight needs if nothing disturbs it
        acceleration = push + c.velocity_gain * error + np.array([0.0, 0.0, _G])
        acceleration[2] = np.clip(acceleration[2], 0.3 * _G, 1.7 * _G)
        most = acceleration[2] * np.tan(c.max_tilt_rad)
        level = float(np.hypot(acceleration[0], acceleration[1]))
        if level > most:
            acceleration[:2] *= most / level
        b3 = acceleration / np.sqrt(acceleration @ acceleration)
        up_now = _matrix(self._state["q"])[:, 2]
        thrust = self._mass * float(acceleration @ up_now)
        # The attitude loop damps the rate itself and so lags a turn by kd / kp; turn it that far ahead.
        lead = self._plant.kd_att / self._plant.kp_att * self._yaw_rate
        true_heading = self._heading - self._heading_wander + lead
        return {"cmd_thrust": max(thrust, 0.0), "cmd_q": _quaternion(b3, true_heading)}

    def _estimate(self, dt: float) -> None:
        """Let the drone's belief stray for ``dt`` seconds."""
        e, rng = self.config.estimate, self._rng
        n = rng.standard_normal(13)
        self._wander = self._wander + e.position_walk_m * np.sqrt(dt) * n[:3]
        self._heading_wander += e.heading_walk_rad * np.sqrt(dt) * n[3]
        self._believed_position = self._state["x"] + self._wander + e.position_noise_m * n[4:7]
        self._believed_velocity = self._state["v"] + e.velocity_noise_m_s * n[7:10]
        roll, pitch, heading = _euler(self._state["q"])
        self._believed_attitude = (
            roll + e.attitude_noise_rad * n[10],
            pitch + e.attitude_noise_rad * n[11],
            heading + self._heading_wander + e.heading_noise_rad * n[12],
        )


_OFF: dict[str, object] = {"cmd_thrust": 0.0, "cmd_q": np.array([0.0, 0.0, 0.0, 1.0])}


def _matrix(q: Float[np.ndarray, 4]) -> Float[np.ndarray, "3 3"]:
    """Rotation matrix of a unit quaternion (x, y, z, w)."""
    x, y, z, w = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def _euler(q: Float[np.ndarray, 4]) -> tuple[float, float, float]:
    """Roll, pitch and heading (turns about x, then y, then z), FLU."""
    x, y, z, w = (float(c) for c in q)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return float(roll), float(pitch), float(heading)


def _quaternion(up: Float[np.ndarray, 3], heading: float) -> Float[np.ndarray, 4]:
    """Quaternion (x, y, z, w) that turns by a heading and then tilts the body's up to ``up`` (unit)."""
    tilt = np.array([-up[1], up[0], 0.0, 1.0 + up[2]])
    tilt /= np.sqrt(tilt @ tilt)
    s, c = np.sin(heading / 2), np.cos(heading / 2)
    x, y, _, w = tilt
    return np.array([x * c + y * s, y * c - x * s, w * s, w * c])
