"""What a fake autopilot is like, and what goes wrong in it."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class Faults:
    """What goes wrong in the autopilot itself; set and cleared while it flies."""

    deny: set[int] = field(default_factory=set)
    """MAV_CMDs that are refused."""
    mute: set[int] = field(default_factory=set)
    """MAV_CMDs that are carried out and never acknowledged."""
    deaf: bool = False
    """Hears nothing at all; goes on sending."""
    silent: bool = False
    """Sends nothing at all; goes on hearing."""
    frozen: bool = False
    """Repeats its last position, with time going on."""
    warning: bool = False
    """Says critical because something is amiss, and does nothing about it."""
    system: int | None = None
    """System id it sends under, instead of its own."""


@dataclass(frozen=True, slots=True)
class FakeConfig:
    """What the fake is like."""

    system: int = 1
    gps: bool = True
    """Without GPS it has no origin until it is given one."""
    settle_s: float = 1.0
    """How long after its start its estimator is ready, and it can be armed."""
    amsl_m: float = 488.0
    """Altitude above the sea of the place where it stands."""
    spool_up_s: float = 0.0
    """How long its motors take from the request to take off until they lift it."""
    climb_m_s: float = 1.5
    descend_m_s: float = 1.0
    battery: float = 0.9
    drain_1_s: float = 0.0
    """Share of the charge used a second."""
    clock_rate: float = 1.0
    """How fast its clock runs: below 1 for a simulator on a computer that does not keep up."""
    key: bytes | None = None
    """MAVLink 2 signing key."""
    radius_m: float = 50.0
    """Of the geofence."""
    ceiling_m: float = 30.0
