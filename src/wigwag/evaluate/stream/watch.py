"""A system watches streams; what it said is set against the truth and becomes a record."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.datasets.recording import Mark, Recording
from wigwag.evaluate.metrics import people_interval, wilson_interval
from wigwag.evaluate.stream.material import TWINS
from wigwag.evaluate.stream.metrics import (
    Match,
    Watched,
    delays,
    f1,
    jaccard,
    match_by_decision,
    match_by_moment,
    match_by_overlap,
    poisson_interval,
)
from wigwag.evaluate.stream.systems import Listener
from wigwag.gesture import Gesture
from wigwag.skeleton import Pose

Progress = Callable[[int, int], None]
"""Called with (streams done, streams in all)."""

Poses = Sequence[Pose]


@dataclass(frozen=True, slots=True)
class Session:
    """What a system said while it watched one recording, and what was true."""

    name: str
    """Of the stream."""
    person: str
    """Who was watched."""
    duration_s: float
    """Length of the stream."""
    step_s: float
    """From one pose to the next, median."""
    marks: tuple[Mark, ...]
    """The gestures shown."""
    scenes: tuple[Mark, ...]
    """What else was shown."""
    events: tuple[Gesture, ...]
    """Commands, in the order of their decisions."""
    update_ms: Float[np.ndarray, " poses"]
    """Processor time of each update."""
    exceptions: int = 0
    """How many updates raised one."""
    fold: str = ""
    """Who had taught the system, where that differs."""


def poses_of(recording: Recording) -> list[Pose]:
    """Return a recording's poses, every landmark seen."""
    visibility = np.ones(13)
    stream = recording.stream
    joints = np.asarray(stream.joints, dtype=np.float64)
    return [Pose(j, visibility, int(s)) for j, s in zip(joints, stream.stamps_ns, strict=True)]


def watch(
    listener: Listener, recording: Recording, poses: Poses | None = None, *, tolerant: bool = False
) -> Session:
    """Let a system watch one recording from its beginning to its end.

    Args:
        listener: Is reset first.
        recording: With its truth.
        poses: What is seen of it, if that is not everything.
        tolerant: Count exceptions and go on, instead of letting them through.
    """
    listener.reset()
    events, took, exceptions = [], [], 0
    for pose in poses_of(recording) if poses is None else poses:
        begin = time.thread_time_ns()
        try:
            gesture = listener.update(pose)
        except Exception:
            if not tolerant:
                raise
            exceptions += 1
            gesture = None
        took.append((time.thread_time_ns() - begin) * 1e-6)
        if gesture is not None and gesture.label is not None:
            events.append(gesture)
    stream = recording.stream
    return Session(
        stream.name,
        str(stream.subject),
        stream.duration_s,
        float(np.median(np.diff(stream.stamps_ns))) * 1e-9,
        recording.marks,
        recording.scenes,
        tuple(events),
        np.array(took, dtype=np.float32),
        exceptions,
    )


def watched(session: Session, events: Sequence[Gesture] | None = None) -> Watched:
    """Return what is to be counted of a session: all its commands, or these of them."""
    kept = session.events if events is None else tuple(events)
    return Watched(session.duration_s, session.marks, kept, session.person)


def twins_apart(session: Session) -> tuple[tuple[Gesture, ...], tuple[Gesture, ...]]:
    """Part commands into those that are judged, and those that name what an everyday movement truly is."""
    judged: list[Gesture] = []
    twins: list[Gesture] = []
    for event in session.events:
        scene = scene_at(session, event)
        (twins if scene is not None and TWINS.get(scene.label) == event.label else judged).append(event)
    return tuple(judged), tuple(twins)


def scene_at(session: Session, event: Gesture) -> Mark | None:
    """Return the everyday movement that an event overlaps most, if it overlaps any."""
    best, most = None, 0
    for scene in session.scenes:
        inside = min(scene.end_ns, max(event.end_ns, event.decided_ns)) - max(scene.onset_ns, event.onset_ns)
        if inside > most:
            best, most = scene, inside
    return best


def figures(sessions: Sequence[Session], repeats: float = 1, points: bool = False) -> dict[str, Any]:
    """Return the record of a run: every figure of merit over all its sessions.

    Args:
        sessions: At least one.
        repeats: How often the same material was shown in other orders. Repeats are not independent: the
            interval of false commands an hour is that of one pass, count and hours divided by it.
        points: Whether the marks are action points: overlaps have no meaning then.
    """
    parted = [twins_apart(session) for session in sessions]
    seen = [watched(s, judged) for s, (judged, _) in zip(sessions, parted, strict=True)]
    hours = sum(w.duration_s for w in seen) / 3600
    n_twins = sum(len(twins) for _, twins in parted)
    events = sum(len(w.marks) for w in seen)
    said = [(match_by_moment if points else match_by_decision)(w) for w in seen]
    answered = sum(len(m.found) for m in said)
    false = sum(len(m.false) for m in said)
    when = delays(said)
    rate_hz = float(np.median([1 / session.step_s for session in sessions]))
    took = np.concatenate([s.update_ms for s in sessions])
    causes = Counter(
        _cause(s, m.false[i]) for s, m in zip(sessions, said, strict=True) for i in range(len(m.false))
    )
    return {
        "hours": hours,
        "hours_distinct": hours / repeats,
        "people": len({w.person for w in seen}),
        "events": events,
        "event_f1": None if points or not events else f1([match_by_overlap(w) for w in seen]),
        "detection_rate": answered / events if events else None,
        "detection_rate_ci95": _found_interval(seen, said) if events else None,
        "false_positive_rate": false / events if events else None,
        "false_commands": false,
        "false_commands_per_hour": false / hours,
        "false_commands_ci95": list(poisson_interval(false / repeats, hours / repeats)),
        "false_commands_of": [f"{cause}: {count}" for cause, count in causes.most_common()],
        "twins": n_twins,
        "false_commands_per_hour_with_twins": (false + n_twins) / hours,
        "jaccard": None if points or not events else jaccard(seen),
        "delay_from_end_s_median": _median(when.from_end_s),
        "delay_from_end_s_p90": _quantile(when.from_end_s, 0.9),
        "delay_from_end_frames_median": _median(when.from_end_s * rate_hz),
        "delay_from_onset_s_median": _median(when.from_onset_s),
        "decided_before_end": float(np.mean(when.from_end_s < 0)) if len(when.from_end_s) else None,
        "share_seen_median": None if points else _median(when.share_seen),
        "action_point_f1": f1([match_by_moment(w) for w in seen]) if points else None,
        "ms_per_pose_median": float(np.median(took)),
        "ms_per_pose_mean": float(np.mean(took)),
        "ms_per_pose_p99": float(np.quantile(took, 0.99)),
    }


def _found_interval(seen: Sequence[Watched], said: Sequence[Match]) -> list[float]:
    """Return the 95 % interval of the detection rate on new people: whole people are drawn again.

    Where every gesture is found, or none, that has no width: Wilson's score over the gestures stands in.
    """
    right: list[float] = []
    people: list[str] = []
    for one, match in zip(seen, said, strict=True):
        right += [1.0] * len(match.found) + [0.0] * len(match.missed)
        people += [one.person] * len(one.marks)
    if sum(right) in (0, len(right)):
        return list(wilson_interval(round(sum(right)), len(right)))
    return list(people_interval(np.array(right), people, 0))


def _cause(session: Session, event: Gesture) -> str:
    """Say on what a false command fell, and what it was."""
    for mark in session.marks:
        if event.onset_ns <= mark.end_ns and max(event.end_ns, event.decided_ns) >= mark.onset_ns:
            return f"{event.label} {'again ' if mark.label == event.label else ''}on {mark.label}"
    scene = scene_at(session, event)
    return f"{event.label} on {scene.label if scene else 'rest'}"


def _median(values: np.ndarray) -> float | None:
    return float(np.median(values)) if len(values) else None


def _quantile(values: np.ndarray, share: float) -> float | None:
    return float(np.quantile(values, share)) if len(values) else None


__all__ = ["Session", "figures", "poses_of", "scene_at", "twins_apart", "watch", "watched"]
