"""What every drone can be asked, whoever built it."""

from __future__ import annotations

from enum import StrEnum
from typing import Protocol

from wigwag.fly.values import Setpoint, VehicleState


class FlightMode(StrEnum):
    """What a vehicle is doing."""

    DISARMED = "disarmed"
    """On the ground, propellers locked."""
    READY = "ready"
    """Armed on the ground, waiting for take-off."""
    TAKING_OFF = "taking_off"
    HOLDING = "holding"
    """Hovering on its own."""
    STEERED = "steered"
    """Following set-points."""
    LANDING = "landing"


class Vehicle(Protocol):
    """A drone that takes body-frame velocities.

    Requests return whether the vehicle accepts them, at once; ``mode`` tells how far it has come. A
    vehicle whose set-points stop coming holds its place by itself.
    """

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        ...

    def connect(self) -> None:
        """Reach the vehicle; raises ``WigwagError`` if it cannot be reached."""
        ...

    @property
    def state(self) -> VehicleState:
        """What the drone believes of itself now."""
        ...

    def arm(self) -> bool:
        """Ask it to unlock the propellers."""
        ...

    def take_off(self, height_m: float = 1.5) -> bool:
        """Ask it to climb to a height above the ground and hold."""
        ...

    def land(self) -> bool:
        """Ask it to come down where it is and lock the propellers."""
        ...

    def hold(self) -> bool:
        """Ask it to stop and hover, whatever it is doing."""
        ...

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Send a set-point computed at ``stamp_ns`` (monotonic nanoseconds).

        Returns:
            Whether it will be flown: not on the ground, nor during take-off and landing, nor if too old.
        """
        ...
