"""A drone as a point that follows velocities late: enough to test what an autopilot is told, and fast."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.fly.values import HOVER, Setpoint, VehicleState


@dataclass(frozen=True, slots=True)
class PointMassConfig:
    """How late it follows. The delays are those measured on PX4 and ArduPilot in software."""

    velocity_delay_s: float = 0.12
    velocity_time_s: float = 0.20
    """Of the first-order lag that follows the delay; motion sets in after about a quarter of a second."""
    yaw_delay_s: float = 0.10
    yaw_time_s: float = 0.06
    max_acceleration_m_s2: float = 4.0
    position_noise_m: float = 0.003
    velocity_noise_m_s: float = 0.01
    angle_noise_rad: float = 0.002


class PointMass:
    """An airframe for ``SimulatedVehicle`` and for ``FakeAutopilot``.

    Args:
        config: How it follows.
        seed: Draws the noise of what it believes.
        position_m: Where it starts, ENU; at height 0 it stands.
        heading_rad: Anticlockwise from east.
    """

    def __init__(
        self, config: PointMassConfig | None = None, seed: int = 0,
        position_m: tuple[float, float, float] = (0.0, 0.0, 0.0), heading_rad: float = 0.0,
    ) -> None:  # fmt: skip
        self.config = config or PointMassConfig()
        self.wind_m_s = np.zeros(3)
        """Added to what it flies; set it for a gust."""
        self.time_s = 0.0
        self._rng = np.random.default_rng([seed, 0x90])
        self._position, self._velocity = np.array(position_m, float), np.zeros(3)
        self._heading, self._yaw_rate = heading_rad, 0.0
        self._motors = position_m[2] > 0
        self._orders: deque[tuple[float, Setpoint]] = deque()
        self._noise = self._rng.standard_normal(9)

    @property
    def on_ground(self) -> bool:
        """Whether it touches the ground."""
        return bool(self._position[2] <= 1e-6)

    @property
    def yaw_rate_rad_s(self) -> float:
        """How fast it turns, anticlockwise."""
        return self._yaw_rate

    @property
    def state(self) -> VehicleState:
        """The truth."""
        return VehicleState(
            self._position.copy(), self._velocity.copy(), self._heading, self._stamp_ns(), armed=self._motors
        )

    @property
    def measured(self) -> VehicleState:
        """What it believes."""
        c, n = self.config, self._noise
        return VehicleState(
            self._position + c.position_noise_m * n[:3],
            self._velocity + c.velocity_noise_m_s * n[3:6],
            self._heading + c.angle_noise_rad * n[6],
            self._stamp_ns(),
            c.angle_noise_rad * n[7],
            c.angle_noise_rad * n[8],
            self._motors,
        )

    def set_motors(self, on: bool) -> None:
        """Start or stop the motors."""
        self._motors = on
        self._orders.clear()

    def step(self, setpoint: Setpoint, dt_s: float) -> None:
        """Fly on for ``dt_s`` seconds, best in steps of 20 ms or less."""
        c = self.config
        self.time_s += dt_s
        self._orders.append((self.time_s, setpoint))
        wanted = self._ordered(c.velocity_delay_s)
        turn = self._ordered(c.yaw_delay_s).yaw_rate_rad_s if self._motors and not self.on_ground else 0.0
        while len(self._orders) > 1 and self._orders[1][0] < self.time_s - 1.0:
            self._orders.popleft()
        self._yaw_rate += (turn - self._yaw_rate) * min(1.0, dt_s / c.yaw_time_s)
        self._heading += self._yaw_rate * dt_s
        if self._motors:
            self._fly(wanted, dt_s)
        else:
            self._velocity = np.array([0.0, 0.0, self._velocity[2] - 9.81 * dt_s])
        self._position = self._position + self._velocity * dt_s
        if self._position[2] <= 0:
            self._position[2] = 0.0
            self._velocity = np.zeros(3)
        self._noise = self._rng.standard_normal(9)

    def _fly(self, wanted: Setpoint, dt_s: float) -> None:
        c = self.config
        forward, left, up = wanted.velocity_m_s
        cos, sin = np.cos(self._heading), np.sin(self._heading)
        target = np.array([cos * forward - sin * left, sin * forward + cos * left, up])
        if not self.on_ground:
            target = target + self.wind_m_s
        change: Float[np.ndarray, " 3"] = (target - self._velocity) * min(1.0, dt_s / c.velocity_time_s)
        size, most = float(np.linalg.norm(change)), c.max_acceleration_m_s2 * dt_s
        self._velocity = self._velocity + (change if size <= most else change * (most / size))
        if self.on_ground:
            self._velocity[:2] = 0.0

    def _ordered(self, delay_s: float) -> Setpoint:
        """Return the set-point that takes effect now."""
        for at_s, setpoint in reversed(self._orders):
            if at_s <= self.time_s - delay_s:
                return setpoint
        return HOVER

    def _stamp_ns(self) -> int:
        return round(self.time_s * 1e9)
