"""What the supervisor is told, what it answers, and the words both are made of."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from wigwag.fly.values import Command, Setpoint


class Mode(StrEnum):
    """What is being flown: the supervisor's own state."""

    DISARMED = "disarmed"
    """On the ground, propellers locked."""
    ARMING = "arming"
    """A confirmed take-off was asked for; the vehicle is unlocking its propellers."""
    READY = "ready"
    """On the ground with propellers that may turn, and nothing is under way."""
    TAKING_OFF = "taking_off"
    """The autopilot climbs to the height of the flight."""
    FOLLOWING = "following"
    """The follow law steers."""
    EXECUTING = "executing"
    """A command's bounded movement, on top of the follow law."""
    HOLDING = "holding"
    """Stays where it is, turned to the operator, until a command moves it."""
    LOST_PERSON = "lost_person"
    """Hovers and waits for the operator to be seen again."""
    LOST_LINK = "lost_link"
    """The vehicle is not heard: it was asked to hold, nothing is sent."""
    LANDING = "landing"
    """The autopilot comes down where it is; a stop holds it."""
    EMERGENCY = "emergency"
    """A landing that goes on by itself after a stop."""
    FAILSAFE = "failsafe"
    """The autopilot flies what nobody asked for; only the operator's stop and land are passed on."""
    PILOT = "pilot"
    """A pilot flies by radio or ground station: nothing is sent, nothing is asked."""


class Craft(StrEnum):
    """What the vehicle says that it is doing."""

    DOWN = "down"
    """Stands with propellers locked."""
    ARMED = "armed"
    """Stands with propellers that may turn."""
    CLIMBING = "climbing"
    """Takes off."""
    AIRBORNE = "airborne"
    """Flies, and takes set-points."""
    SINKING = "sinking"
    """Lands."""
    OWN = "own"
    """Follows a failsafe of its own."""
    PILOTED = "piloted"
    """Is in a pilot's hands."""


class Action(StrEnum):
    """What the vehicle itself is to be asked, besides the set-point."""

    NONE = "none"
    ARM = "arm"
    TAKE_OFF = "take_off"
    LAND = "land"
    HOLD = "hold"


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known at one moment. All stamps are of one monotonic clock, nanoseconds."""

    now_ns: int
    craft: Craft
    """What the vehicle is doing."""
    state_ns: int
    """When the oldest part of the vehicle's newest state was measured."""
    link_ns: int
    """When the vehicle was last heard of at all."""
    position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of the vehicle, world frame ENU; the height counts from where it was armed."""
    heading_rad: float = 0.0
    """Of the vehicle, anticlockwise from east."""
    battery: float | None = None
    """Share of the charge that is left, 0 to 1; ``None``: not known."""
    healthy: bool = True
    """Whether the vehicle's own checks are content."""
    camera_ns: int | None = None
    """When the camera last gave a picture of now; ``None``: never."""
    pose_ns: int | None = None
    """When the operator was last seen; ``None``: never."""
    distance_m: float | None = None
    """Horizontal distance to the operator; ``None``: not known."""
    bearing_rad: float = 0.0
    """Where the operator stands from the drone's nose, positive to the left."""
    person: int = 0
    """Counts up when whoever is tracked cannot be who was tracked before."""
    engaged_ns: int | None = None
    """Since when somebody has been the operator without a break; ``None``: nobody is."""
    rested_ns: int | None = None
    """When the operator's body was last at rest; ``None``: nobody can tell."""
    deaf_ns: int | None = None
    """Since when the recogniser has failed without a decision in between; ``None``: it works."""
    moving: bool = False
    """Whether a command's movement has not come to its end."""
    command: Command | None = None
    """What the operator asks for now; ``None`` most of the time."""
    held_s: float = 0.0
    """How long the gesture behind the command was shown."""
    withheld: bool = False
    """Whether somebody at the console keeps it where it is until they let go."""


def sound(now: Situation) -> Situation:
    """Return the same situation without what is no number: that is not known, and guards would let it pass.

    A vehicle whose place or heading is no number has told no state; an operator who is nowhere is not seen.

    Example:
        >>> told = Situation(5 * 10**9, Craft.AIRBORNE, 5 * 10**9, 5 * 10**9, distance_m=float("nan"))
        >>> sound(told).distance_m is None
        True
    """
    changes: dict[str, Any] = {}
    if not all(map(math.isfinite, (*now.position_m, now.heading_rad))):
        changes |= {"position_m": (0.0, 0.0, 0.0), "heading_rad": 0.0, "state_ns": now.now_ns - _NEVER_NS}
    if now.distance_m is not None and not (math.isfinite(now.distance_m) and math.isfinite(now.bearing_rad)):
        changes |= {"distance_m": None, "bearing_rad": 0.0}
    if now.battery is not None and not math.isfinite(now.battery):
        changes["battery"] = None
    return replace(now, **changes) if changes else now


_NEVER_NS = 10**15


@dataclass(frozen=True, slots=True)
class Verdict:
    """What may be done."""

    mode: Mode
    action: Action = Action.NONE
    accepted: Command | None = None
    """The command, if it is obeyed."""
    row: str = ""
    """The name of the transition that was taken; empty: none."""
    reason: str = ""
    """Why a command was not obeyed, or not as it was asked for. For people to read."""


@dataclass(frozen=True, slots=True)
class Permit:
    """What may be sent."""

    setpoint: Setpoint | None
    """To be sent at once, before any action; ``None``: send nothing."""
    changed: str = ""
    """The guards that changed the wish, by name. For people to read."""


@dataclass(frozen=True, slots=True)
class Memory:
    """What the supervisor remembers from one turn to the next."""

    mode: Mode
    since_ns: int = 0
    """When this mode began."""
    now_ns: int | None = None
    """When the last turn was; ``None``: there was none."""
    person: int = 0
    """Whom the operator was last taken for."""
    state_ok_ns: int = 0
    """When the vehicle's state was last fresh. This and the next five begin with the flight."""
    link_ok_ns: int = 0
    """When the vehicle was last in touch."""
    health_ok_ns: int = 0
    """When the vehicle's own checks were last content."""
    person_ok_ns: int = 0
    """When the operator was last in view."""
    camera_ok_ns: int = 0
    """When the camera last showed something new."""
    hearing_ok_ns: int = 0
    """When the recogniser last worked."""
    commanded_ns: int | None = None
    """When a command was last heard that was obeyed or waits for its confirmation."""
    stopped_ns: int | None = None
    """When the operator last said stop."""
    asked_ns: int | None = None
    """When something was last asked of the vehicle."""
    pending: Command | None = None
    """A command that was heard at ``commanded_ns`` and waits for its confirmation."""


def age_s(now_ns: int, stamp_ns: int | None) -> float:
    """Return how old a stamp is, seconds: infinite if there is none, or if it lies in the future.

    A stamp from the future was given by a clock that was set back since; nothing is known of its age.

    Example:
        >>> age_s(3_000_000_000, 1_000_000_000), age_s(0, None), age_s(0, 1_000_000_000)
        (2.0, inf, inf)
    """
    if stamp_ns is None:
        return float("inf")
    age = (now_ns - stamp_ns) * 1e-9
    return age if age > -FUTURE_S else float("inf")


FUTURE_S = 0.1
"""Stamps may run ahead of the loop's clock by so much: a state that comes in while the loop computes."""
