"""How well a flight went: what was shown, what was understood, how the drone kept its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

from wigwag.gesture import Gesture
from wigwag.sim.script import Shown


class Outcome(StrEnum):
    """What became of a showing or an event."""

    RECOGNISED = "recognised"
    WRONG = "wrong"
    MISSED = "missed"
    FALSE_ON_OTHER = "false on another gesture"
    FALSE_ON_NOTHING = "false on nothing"
    LEFT_ALONE = "rightly left alone"


@dataclass(frozen=True, slots=True)
class Row:
    """One turn of the loop, judged by the simulator's truth. The chain never sees any of this."""

    time_s: float
    found: bool
    """The middle of the hips was measured within 0.3 m of the truth."""
    flying: bool
    """Following or executing a command: its errors count."""
    bearing_deg: float
    """The operator's true bearing from the drone's nose."""
    distance_error_m: float
    """True horizontal distance less the distance to be kept at that moment."""
    drone_m: tuple[float, float, float]
    operator_m: tuple[float, float, float]
    pose_ms: float
    loop_ms: float
    """Everything: rendering, depth noise, physics, pose, lift, recognition, control."""
    mode: str
    sought: bool = True
    """By the script the operator had engaged by then, so that they ought to be found: whether or not they
    were understood."""


@dataclass(slots=True)
class FlightLog:
    """What is gathered during a flight."""

    rows: list[Row] = field(default_factory=list)
    events: list[Gesture] = field(default_factory=list)
    """Only gestures with a label."""
    shown: list[Shown] = field(default_factory=list)

    def append(self, other: FlightLog, offset_s: float) -> None:
        """Add another flight that began ``offset_s`` after this one."""
        shift_ns = round(offset_s * 1e9)
        self.rows += [replace(row, time_s=row.time_s + offset_s) for row in other.rows]
        self.shown += [
            replace(s, start_s=s.start_s + offset_s, end_s=s.end_s + offset_s) for s in other.shown
        ]
        self.events += [
            replace(
                e,
                onset_ns=e.onset_ns + shift_ns,
                end_ns=e.end_ns + shift_ns,
                decided_ns=e.decided_ns + shift_ns,
            )
            for e in other.events
        ]


@dataclass(frozen=True, slots=True)
class Judgement:
    """Each showing and each event with its outcome."""

    showings: list[tuple[Shown, Outcome, Gesture | None]]
    false_events: list[tuple[Gesture, Outcome]]


def judge(showings: Sequence[Shown], events: Sequence[Gesture], patience_s: float = 2.0) -> Judgement:
    """Give every event to the showing it was decided in, or within ``patience_s`` after its end.

    The first event in a command's time decides its outcome. Every further event, every event during another
    gesture and every event at any other time is a false command.

    Args:
        showings: What was done, in any order.
        events: Labelled gestures, each with ``decided_ns``.
        patience_s: How long after the end of a showing its event may come.
    """
    ordered = sorted(showings, key=lambda showing: showing.start_s)
    given: dict[int, Gesture] = {}
    false: list[tuple[Gesture, Outcome]] = []
    for event in sorted(events, key=lambda event: event.decided_ns):
        at_s = event.decided_ns * 1e-9
        owners = [i for i, s in enumerate(ordered) if s.start_s <= at_s <= s.end_s + patience_s]
        owner = owners[-1] if owners else None
        # Just after the start of the next gesture an event still belongs to the one before, if that has none.
        if len(owners) > 1 and event.end_ns * 1e-9 <= ordered[owners[-1]].start_s:
            owner = owners[-2]
        if owner is None:
            false.append((event, Outcome.FALSE_ON_NOTHING))
        elif not ordered[owner].is_command:
            false.append((event, Outcome.FALSE_ON_OTHER))
        elif owner in given:
            false.append((event, Outcome.FALSE_ON_NOTHING))
        else:
            given[owner] = event
    judged: list[tuple[Shown, Outcome, Gesture | None]] = []
    for i, showing in enumerate(ordered):
        own = given.get(i)
        if not showing.is_command:
            hit = any(
                showing.start_s <= event.decided_ns * 1e-9 <= showing.end_s + patience_s
                for event, outcome in false
                if outcome is Outcome.FALSE_ON_OTHER
            )
            judged.append((showing, Outcome.FALSE_ON_OTHER if hit else Outcome.LEFT_ALONE, None))
        elif own is None:
            judged.append((showing, Outcome.MISSED, None))
        elif own.label == showing.label:
            judged.append((showing, Outcome.RECOGNISED, own))
        else:
            judged.append((showing, Outcome.WRONG, own))
    return Judgement(judged, false)


def summarise(log: FlightLog) -> dict[str, Any]:
    """Reduce a flight to the figures of ``summary.json``."""
    judgement = judge(log.shown, log.events)
    outcomes = [outcome for _, outcome, _ in judgement.showings]
    commands = [s for s in log.shown if s.is_command]
    delays = [
        event.decided_ns * 1e-9 - showing.end_s
        for showing, outcome, event in judgement.showings
        if outcome is Outcome.RECOGNISED and event is not None
    ]
    rows, flown = log.rows, [row for row in log.rows if row.flying]
    sought = [row for row in rows if row.sought]
    bearing = np.abs([row.bearing_deg for row in flown])
    distance = np.abs([row.distance_error_m for row in flown])
    loop = np.array([row.loop_ms for row in rows])
    on_nothing = sum(outcome is Outcome.FALSE_ON_NOTHING for _, outcome in judgement.false_events)
    return {
        "gestures": {
            "shown": len(commands),
            "recognised": outcomes.count(Outcome.RECOGNISED),
            "wrong": outcomes.count(Outcome.WRONG),
            "missed": outcomes.count(Outcome.MISSED),
            "decided_after_end_s_median": _round(np.median(delays)) if delays else None,
        },
        "others_shown": len(log.shown) - len(commands),
        "false_commands": len(judgement.false_events),
        "false_on_nothing": on_nothing,
        "false_on_others": len(judgement.false_events) - on_nothing,
        "pose": {
            "frames": len(sought),
            "found": _round(np.mean([row.found for row in sought]), 4) if sought else 0.0,
            "ms_median": _round(np.median([row.pose_ms for row in rows])),
        },
        "follow": {
            "bearing_error_deg": {"mean": _round(bearing.mean()), "max": _round(bearing.max())},
            "distance_error_m": {"mean": _round(distance.mean()), "max": _round(distance.max())},
            "frames": len(flown),
        }
        if flown
        else None,
        "loop": {
            "hz": _round(1000.0 / loop.mean(), 1),
            "ms_median": _round(np.median(loop)),
            "ms_p95": _round(np.percentile(loop, 95)),
        },
    }


def _round(value: Any, digits: int = 3) -> float:
    return round(float(value), digits)
