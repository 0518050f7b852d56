"""Every transition of the supervisor, a named row each. docs/safety.md is generated from this table."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from wigwag.fly.situation import Action, Mode


class Event(StrEnum):
    """What can happen. The order is the order of precedence: of two at once, the first one acts."""

    PILOT = "pilot"
    DOWN = "down"
    STOP = "stop"
    LAND = "land"
    LAND_ASKED = "land_asked"
    FAILSAFE = "failsafe"
    LINK_GONE = "link_gone"
    LINK_LOST = "link_lost"
    CLOCK_JUMPED = "clock_jumped"
    STATE_GONE = "state_gone"
    BATTERY_CRITICAL = "battery_critical"
    FENCE_BROKEN = "fence_broken"
    ILL = "ill"
    BATTERY_LOW = "battery_low"
    DEAF_LONG = "deaf_long"
    BLIND_LONG = "blind_long"
    PERSON_GONE = "person_gone"
    STATE_STALE = "state_stale"
    DEAF = "deaf"
    PERSON_SWAPPED = "person_swapped"
    PERSON_LOST = "person_lost"
    PERSON_FAR = "person_far"
    TIMEOUT = "timeout"
    NOT_LANDING = "not_landing"
    ARMED = "armed"
    LINK_BACK = "link_back"
    AIRBORNE = "airborne"
    TAKE_OFF = "take_off"
    MOVE = "move"
    MOVED = "moved"
    PERSON_SEEN = "person_seen"


@dataclass(frozen=True, slots=True)
class Transition:
    """One row of the table."""

    name: str
    event: Event
    sources: tuple[Mode, ...]
    target: Mode
    action: Action = Action.NONE
    after: str = ""
    """The limit that says how long the event has to last; empty: acts in the turn in which it is seen."""
    why: str = ""
    """For people to read."""


_FLOWN = (Mode.FOLLOWING, Mode.EXECUTING)
_STEERED = (*_FLOWN, Mode.HOLDING, Mode.LOST_PERSON)
_STARTED = (Mode.TAKING_OFF, *_STEERED)
_FLYING = (*_STARTED, Mode.LOST_LINK)
_AIR = (*_FLYING, Mode.LANDING, Mode.EMERGENCY, Mode.FAILSAFE)
_COMING_DOWN = (Mode.LANDING, Mode.EMERGENCY)

TABLE: tuple[Transition, ...] = (
    Transition(
        "the pilot takes over", Event.PILOT,
        (Mode.DISARMED, Mode.ARMING, Mode.READY, *_AIR), Mode.PILOT,
        why="A change of mode by radio or ground station is never fought, not even by the operator's stop.",
    ),
    Transition(
        "it stands", Event.DOWN, (Mode.READY, *_AIR, Mode.PILOT), Mode.DISARMED,
        why="The vehicle says that its propellers are locked: landed, or disarmed by somebody.",
    ),
    Transition(
        "stop on the ground", Event.STOP, (Mode.ARMING, Mode.READY), Mode.READY, Action.LAND,
        why="A take-off that has not begun is called off; a vehicle asked to land on the ground disarms.",
    ),
    Transition(
        "stop", Event.STOP, _AIR, Mode.HOLDING, Action.HOLD,
        why="Stop wins from everywhere, also when nothing is known any more.",
    ),
    Transition(
        "land on the ground", Event.LAND, (Mode.ARMING, Mode.READY), Mode.READY, Action.LAND,
        why="As stop.",
    ),
    Transition(
        "land", Event.LAND, (*_FLYING, Mode.FAILSAFE), Mode.LANDING, Action.LAND,
        why="A confirmed landing wins from everywhere, also when nothing is known any more.",
    ),
    Transition(
        "land, not yet confirmed", Event.LAND_ASKED, (*_FLYING, Mode.FAILSAFE), Mode.HOLDING, Action.HOLD,
        why="A landing shown too briefly works as a stop; the second showing lands.",
    ),
    Transition(
        "the autopilot's failsafe", Event.FAILSAFE,
        (Mode.DISARMED, Mode.READY, *_FLYING, *_COMING_DOWN, Mode.PILOT), Mode.FAILSAFE,
        after="ask_again_s",
        why="What the autopilot does by itself is not fought. After a request of ours it gets a moment.",
    ),
    Transition(
        "out of touch for long", Event.LINK_GONE, (Mode.LOST_LINK,), Mode.LANDING, Action.LAND,
        after="land_without_link_s",
        why="The vehicle may hear though it is not heard; its own failsafe has acted long since.",
    ),
    Transition(
        "out of touch", Event.LINK_LOST, _STARTED, Mode.LOST_LINK, Action.HOLD,
        after="max_link_age_s",
        why="What is not seen is not steered: it is asked to hold, then set-points stop, and the vehicle's "
        "own time-out holds it.",
    ),
    Transition(
        "the clock jumped on the ground", Event.CLOCK_JUMPED, (Mode.ARMING,), Mode.READY, Action.LAND,
        after="max_turn_s",
        why="Nobody takes off on the word of a moment ago.",
    ),
    Transition(
        "the clock jumped", Event.CLOCK_JUMPED,
        (Mode.TAKING_OFF, *_FLOWN, Mode.LOST_PERSON), Mode.HOLDING, Action.HOLD,
        after="max_turn_s",
        why="The loop hung, or the clock was set: no age can be trusted, and what was planned is old.",
    ),
    Transition(
        "no vehicle state for long", Event.STATE_GONE, _STARTED, Mode.EMERGENCY, Action.LAND,
        after="land_without_state_s",
        why="Without position nothing can be kept, neither place nor distance.",
    ),
    Transition(
        "battery critical", Event.BATTERY_CRITICAL, (*_FLYING, Mode.LANDING), Mode.EMERGENCY, Action.LAND,
        why="It comes down now, or falls later.",
    ),
    Transition(
        "beyond the fence", Event.FENCE_BROKEN, _STARTED, Mode.EMERGENCY, Action.LAND,
        why="Set-points never lead out: wind, or a position that jumped.",
    ),
    Transition(
        "the vehicle complains", Event.ILL, _STARTED, Mode.LANDING, Action.LAND,
        after="max_ill_s",
        why="Its own checks do not let it fly on.",
    ),
    Transition(
        "battery low", Event.BATTERY_LOW, _STARTED, Mode.LANDING, Action.LAND,
        why="Enough is left to land calmly.",
    ),
    Transition(
        "deaf for long", Event.DEAF_LONG, (Mode.HOLDING, Mode.LOST_PERSON), Mode.LANDING, Action.LAND,
        after="land_when_deaf_s",
        why="A drone that cannot hear stop does not stay in the air.",
    ),
    Transition(
        "blind for long", Event.BLIND_LONG, (Mode.HOLDING, Mode.LOST_PERSON), Mode.LANDING, Action.LAND,
        after="land_when_blind_s",
        why="Without a picture of now it cannot hear stop.",
    ),
    Transition(
        "nobody seen for long", Event.PERSON_GONE, (Mode.HOLDING, Mode.LOST_PERSON), Mode.LANDING,
        Action.LAND, after="land_when_lost_s",
        why="Nobody is in command.",
    ),
    Transition(
        "no fresh vehicle state", Event.STATE_STALE,
        (Mode.TAKING_OFF, *_FLOWN, Mode.LOST_PERSON), Mode.HOLDING, Action.HOLD,
        after="max_state_age_s",
        why="A set-point is computed from a place; from an old place it leads anywhere.",
    ),
    Transition(
        "the recogniser fails", Event.DEAF,
        (Mode.TAKING_OFF, *_FLOWN, Mode.LOST_PERSON), Mode.HOLDING, Action.HOLD,
        why="Stop may not have been heard.",
    ),
    Transition(
        "another person", Event.PERSON_SWAPPED, (*_FLOWN, Mode.LOST_PERSON), Mode.HOLDING, Action.HOLD,
        why="Nobody walks that fast: whoever is seen now was not the operator. A command of theirs, as the "
        "engaged operator, goes on.",
    ),
    Transition(
        "the person is lost", Event.PERSON_LOST, _FLOWN, Mode.LOST_PERSON,
        after="max_pose_age_s",
        why="What is not seen is not followed: it hovers. So it does when the camera shows nothing new.",
    ),
    Transition(
        "the person is too far", Event.PERSON_FAR, _FLOWN, Mode.LOST_PERSON,
        why="From so far neither place nor gestures can be trusted.",
    ),
    Transition(
        "not armed in time", Event.TIMEOUT, (Mode.ARMING,), Mode.DISARMED,
        after="arming_s",
        why="The vehicle does not want to; the operator may ask again.",
    ),
    Transition(
        "not up in time", Event.TIMEOUT, (Mode.TAKING_OFF,), Mode.LANDING, Action.LAND,
        after="take_off_s",
        why="Something keeps it down.",
    ),
    Transition(
        "a movement without end", Event.TIMEOUT, (Mode.EXECUTING,), Mode.HOLDING, Action.HOLD,
        after="executing_s",
        why="Something keeps it from getting there.",
    ),
    Transition(
        "asked to land again", Event.NOT_LANDING, (Mode.LANDING,), Mode.LANDING, Action.LAND,
        after="ask_again_s",
        why="The vehicle refused, or did not hear.",
    ),
    Transition(
        "asked to land again, emergency", Event.NOT_LANDING, (Mode.EMERGENCY,), Mode.EMERGENCY, Action.LAND,
        after="ask_again_s",
        why="The vehicle refused, or did not hear.",
    ),
    Transition(
        "armed as asked", Event.ARMED, (Mode.ARMING,), Mode.TAKING_OFF, Action.TAKE_OFF,
        why="Take-off follows arming without another gesture.",
    ),
    Transition(
        "armed by somebody", Event.ARMED, (Mode.DISARMED, *_STEERED, Mode.FAILSAFE, Mode.PILOT), Mode.READY,
        why="It stands on the ground, and its propellers may turn.",
    ),
    Transition(
        "in touch again", Event.LINK_BACK, (Mode.LOST_LINK,), Mode.HOLDING,
        why="A command goes on.",
    ),
    Transition(
        "it is up", Event.AIRBORNE, (Mode.TAKING_OFF,), Mode.FOLLOWING,
        why="From here on the operator is followed.",
    ),
    Transition(
        "found in the air", Event.AIRBORNE, (Mode.DISARMED, Mode.READY), Mode.HOLDING,
        why="Somebody else took off and hands it over.",
    ),
    Transition(
        "given back", Event.AIRBORNE, (Mode.PILOT, Mode.FAILSAFE), Mode.HOLDING,
        why="The pilot, or the autopilot's failsafe, lets go of it. A command goes on.",
    ),
    Transition(
        "take off", Event.TAKE_OFF, (Mode.DISARMED,), Mode.ARMING, Action.ARM,
        why="Only after the operator confirmed it.",
    ),
    Transition(
        "take off, armed already", Event.TAKE_OFF, (Mode.READY,), Mode.TAKING_OFF, Action.TAKE_OFF,
        why="Only after the operator confirmed it.",
    ),
    Transition(
        "a command", Event.MOVE, (*_FLOWN, Mode.HOLDING), Mode.EXECUTING,
        why="A movement of stated length; the next command replaces it.",
    ),
    Transition(
        "the movement ends", Event.MOVED, (Mode.EXECUTING,), Mode.FOLLOWING,
        why="It got where it should, or gave up.",
    ),
    Transition(
        "seen again", Event.PERSON_SEEN, (Mode.LOST_PERSON,), Mode.FOLLOWING,
        why="The same person, where they can have walked to.",
    ),
)  # fmt: skip
"""What leads from where to where. What is not in here changes nothing."""


def arrange(table: tuple[Transition, ...]) -> dict[Mode, tuple[Transition, ...]]:
    """Sort a table by source, the rows of each in the order of precedence of their events.

    Raises:
        ValueError: If two rows answer the same event in the same mode.
    """
    precedence = {event: place for place, event in enumerate(Event)}
    arranged: dict[Mode, tuple[Transition, ...]] = {}
    for mode in Mode:
        rows = sorted((row for row in table if mode in row.sources), key=lambda row: precedence[row.event])
        if len({row.event for row in rows}) < len(rows):
            raise ValueError(f"Two transitions answer one event in {mode}: {[row.name for row in rows]}.")
        arranged[mode] = tuple(rows)
    return arranged


MASKED_BY_STOP = frozenset(
    {
        Event.BATTERY_CRITICAL, Event.FENCE_BROKEN, Event.ILL, Event.BATTERY_LOW, Event.STATE_GONE,
        Event.DEAF_LONG, Event.BLIND_LONG, Event.PERSON_GONE,
    }
)  # fmt: skip
"""Reasons to land that a stop suspends for ``respite_s``."""
