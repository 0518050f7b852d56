"""What every drone can be asked, whoever built it."""

from __future__ import annotations

from dataclasses import dataclass
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
    MANUAL = "manual"
    """A pilot has it: its mode was changed by radio or ground station, to whatever. Every request and
    set-point is refused until the pilot gives it back, or it stands disarmed."""
    FAILSAFE = "failsafe"
    """The autopilot flies by itself what nobody asked for (link, battery, fence): set-points are refused,
    hold and land are passed on. Ask for those only if the operator does."""


AIRBORNE = frozenset({FlightMode.HOLDING, FlightMode.STEERED})
"""Modes in which set-points are taken."""


@dataclass(frozen=True, slots=True)
class Capabilities:
    """What a vehicle can and cannot do, known once it is connected."""

    name: str
    """What it is, such as ``PX4 1.16.0``. For people to read."""
    max_setpoint_age_s: float
    """A set-point older than this is never flown; the vehicle is then stopped."""
    own_timeout_s: float | None = None
    """How long the vehicle flies on by itself once this program is dead; ``None``: not known."""
    arms: bool = True
    """Whether it can be armed by request. If not, a pilot arms it."""
    takes_off: bool = True
    """Whether it takes off by request. If not, a pilot does."""
    battery: bool = False
    """Whether it reports its battery."""
    health: bool = False
    """Whether it reports its own checks (``VehicleState.healthy``)."""
    pilot: bool = False
    """Whether it tells when a pilot takes over (``FlightMode.MANUAL``)."""


class Vehicle(Protocol):
    """A drone that takes body-frame velocities.

    Requests never wait for the vehicle: they return at once whether they are in place; ``mode`` tells how
    far it has come, and ``state.denied`` what the vehicle refused. ``take_off`` may follow ``arm`` at once:
    it is carried out when the vehicle is armed, within a few seconds or not at all. There is no disarming in
    the air: a vehicle is disarmed by landing. One whose set-points stop coming holds its place by itself.
    """

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        ...

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        ...

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is set on it in a way that is unwise for flying near people; known once connected."""
        ...

    def connect(self) -> None:
        """Reach the vehicle; raises ``WigwagError`` if it cannot be reached. The one call that waits."""
        ...

    def close(self) -> None:
        """Let go of it: steered, it is told to hold first. More than once does no harm."""
        ...

    @property
    def state(self) -> VehicleState:
        """What the drone believes of itself now."""
        ...

    def beat(self, now_ns: int) -> None:
        """Say that the loop is alive; call it every turn, on the ground too (``send`` says it as well).

        A vehicle that is steered by a loop that stops beating is told to stand still, then to hold, and
        hears no more heartbeats, whatever threads of this process live on.
        """
        ...

    def arm(self) -> bool:
        """Ask it to unlock the propellers."""
        ...

    def take_off(self, height_m: float = 1.5) -> bool:
        """Ask it to climb to a height above where it stands and hold."""
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
            Whether it will be flown: not on the ground, nor during take-off and landing, nor if too old, nor
            while a pilot has the vehicle.
        """
        ...
