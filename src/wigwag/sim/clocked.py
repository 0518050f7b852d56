"""A simulated drone that lives on a clock: as a vehicle of its own, without a world to step it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.quadrotor import Quadrotor, QuadrotorConfig
from wigwag.vehicles.protocol import Capabilities, FlightMode
from wigwag.vehicles.simulated import SimulatedVehicle

_LONGEST_S = 1.0
"""A program that slept for longer wakes up in the same place."""


class ClockedVehicle:
    """``SimulatedVehicle`` over a RotorPy quadrotor that catches up with the clock whenever it is spoken to.

    Args:
        seed: Of wind and of what it believes of itself.
        clock: Monotonic nanoseconds, the clock of all stamps.

    Example:
        >>> now = [0]
        >>> drone = ClockedVehicle(seed=1, clock=lambda: now[0])
        >>> drone.arm(), drone.take_off(1.0)
        (True, True)
        >>> for _ in range(100):
        ...     now[0] += 33_000_000
        ...     mode = drone.mode
        >>> mode
        <FlightMode.HOLDING: 'holding'>
    """

    def __init__(self, seed: int = 0, clock: Callable[[], int] = time.monotonic_ns) -> None:
        self._quadrotor = Quadrotor(QuadrotorConfig(position_m=(0.0, 0.0, 0.0)), seed)
        self._vehicle = SimulatedVehicle(self._quadrotor)
        self._clock = clock
        self._offset_ns = clock()

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        return self._now().mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        return self._vehicle.capabilities

    @property
    def warnings(self) -> tuple[str, ...]:
        """None."""
        return ()

    @property
    def state(self) -> VehicleState:
        """What it believes of itself."""
        state = self._now().state
        return replace(state, stamp_ns=state.stamp_ns + self._offset_ns)

    def connect(self) -> None:
        """Nothing to reach."""

    def close(self) -> None:
        """Hold, if it is steered."""
        self._now().close()

    def beat(self, now_ns: int) -> None:
        """Let it catch up."""
        self._now()

    def arm(self) -> bool:
        """Start the motors."""
        return self._now().arm()

    def take_off(self, height_m: float = 1.5) -> bool:
        """Climb and hold."""
        return self._now().take_off(height_m)

    def land(self) -> bool:
        """Come down and stop the motors."""
        return self._now().land()

    def hold(self) -> bool:
        """Stop and hover."""
        return self._now().hold()

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Take a set-point."""
        return self._now().send(setpoint, stamp_ns - self._offset_ns)

    def _now(self) -> SimulatedVehicle:
        """Fly on to the time of the clock."""
        behind_s = (self._clock() - self._offset_ns) * 1e-9 - self._quadrotor.time_s
        if behind_s > _LONGEST_S:
            self._offset_ns += int((behind_s - _LONGEST_S) * 1e9)
            behind_s = _LONGEST_S
        if behind_s > 0:
            self._vehicle.step(behind_s)
        return self._vehicle
