"""A vehicle that is only looked at: for trying everything but flying."""

from __future__ import annotations

from wigwag.fly.values import Setpoint, VehicleState
from wigwag.vehicles.protocol import Capabilities, FlightMode, Vehicle


class DryVehicle:
    """Tells what another vehicle tells, and passes nothing on: no request, no set-point.

    Args:
        vehicle: The one that is looked at.

    Example:
        >>> from wigwag.sim.clocked import ClockedVehicle
        >>> dry = DryVehicle(ClockedVehicle())
        >>> dry.arm(), dry.mode.value, dry.kept
        (False, 'disarmed', ['arm'])
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self.kept: list[str] = []
        """Requests that were not passed on, in order."""
        self.kept_setpoints = 0
        """How many set-points were not passed on."""

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        return self._vehicle.mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        return self._vehicle.capabilities

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is set on it in a way that is unwise."""
        return self._vehicle.warnings

    @property
    def state(self) -> VehicleState:
        """What it says of itself."""
        return self._vehicle.state

    def connect(self) -> None:
        """Reach it."""
        self._vehicle.connect()

    def close(self) -> None:
        """Let go of it."""
        self._vehicle.close()

    def beat(self, now_ns: int) -> None:
        """Say that the loop is alive."""
        self._vehicle.beat(now_ns)

    def arm(self) -> bool:
        """Pass nothing on."""
        return self._keep("arm")

    def take_off(self, height_m: float = 1.5) -> bool:
        """Pass nothing on."""
        return self._keep(f"take off to {height_m:g} m")

    def land(self) -> bool:
        """Pass nothing on."""
        return self._keep("land")

    def hold(self) -> bool:
        """Pass nothing on."""
        return self._keep("hold")

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Pass nothing on."""
        self.kept_setpoints += 1
        return False

    def _keep(self, what: str) -> bool:
        self.kept.append(what)
        return False
