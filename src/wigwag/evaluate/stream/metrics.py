"""Figures of merit of commands in streams. No two benchmarks share one, so here are all of them.

Everything is counted from two lists a stream: what was truly shown (:class:`Mark`) and which commands fell
(:class:`~wigwag.gesture.Gesture` with a label). Events without a label are no commands and are ignored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.datasets.recording import Mark
from wigwag.errors import InputError
from wigwag.gesture import Gesture

IOU = 0.5
"""Least overlap of an event that counts in event F1."""

ACTION_POINT_S = 0.333
"""How far a decision may lie from an action point (Nowozin and Shotton 2012; Fothergill et al. 2012)."""


@dataclass(frozen=True, slots=True)
class Watched:
    """One stream that was watched to its end."""

    duration_s: float
    """Seconds of stream."""
    marks: tuple[Mark, ...]
    """The truth."""
    events: tuple[Gesture, ...]
    """Commands: events with a label, in the order of their decisions."""
    person: str = ""
    """Who was watched."""

    def __post_init__(self) -> None:
        """Check that only commands are counted.

        Raises:
            InputError: If the duration is not positive or an event has no label.
        """
        if not self.duration_s > 0:
            raise InputError(f"Watched.duration_s must be positive, but got {self.duration_s}.")
        if any(event.label is None for event in self.events):
            raise InputError("Watched.events holds an event without a label, which is no command; drop it.")


@dataclass(frozen=True, slots=True)
class Match:
    """What became of the marks and events of one stream."""

    found: tuple[tuple[Mark, Gesture], ...]
    """Each mark that was answered by the right command, with that command."""
    missed: tuple[Mark, ...]
    false: tuple[Gesture, ...]
    """Commands that nobody gave: of a wrong label, repeated, or on something that is no gesture."""


def iou(mark: Mark, event: Gesture) -> float:
    """Return the intersection over union of two intervals, 0 to 1; 0 if either has no length.

    Example:
        >>> iou(Mark("a", 0, 10), Gesture("a", 1.0, onset_ns=5, end_ns=15))
        0.3333333333333333
    """
    inside = min(mark.end_ns, event.end_ns) - max(mark.onset_ns, event.onset_ns)
    union = max(mark.end_ns, event.end_ns) - min(mark.onset_ns, event.onset_ns)
    return max(inside, 0) / union if union > 0 else 0.0


def match_by_overlap(watched: Watched, least: float = IOU) -> Match:
    """Pair events with marks of their label that they overlap by ``least`` or more, one to one.

    The pair that overlaps most comes first. This is the matching of segmental F1 (Lea et al., "Temporal
    Convolutional Networks for Action Segmentation and Detection", CVPR 2017, F1@50). The event's interval
    is from ``onset_ns`` to ``end_ns``; who decides before the end states when the end is expected.
    """
    pairs = [
        (iou(mark, event), m, e)
        for m, mark in enumerate(watched.marks)
        for e, event in enumerate(watched.events)
        if mark.label == event.label
    ]
    return _greedy(watched, [(score, m, e) for score, m, e in pairs if score >= least and score > 0])


def match_by_decision(watched: Watched) -> Match:
    """Pair each event with the mark of its label that it is about, one to one; the earliest decision counts.

    An event is about a mark that its interval, from ``onset_ns`` to ``decided_ns``, meets. This is what an
    operator feels: the right command came, whatever the system thinks about where the gesture began. A
    second command for the same gesture is one too many. (SHREC 2022, Emporio et al., counts detections
    likewise but wants half of the gesture covered.)
    """
    pairs = []
    for m, mark in enumerate(watched.marks):
        for e, event in enumerate(watched.events):
            last = max(event.decided_ns, event.end_ns)
            if mark.label == event.label and event.onset_ns <= mark.end_ns and last >= mark.onset_ns:
                pairs.append((-float(event.decided_ns), m, e))
    return _greedy(watched, pairs)


def match_by_moment(watched: Watched, tolerance_s: float = ACTION_POINT_S) -> Match:
    """Pair each event with a mark of its label whose end its decision lies within ``tolerance_s`` of.

    For action points, which are moments (Nowozin and Shotton, "Action Points", Microsoft Research TR
    2012-68). The nearest pair comes first.
    """
    pairs = []
    for m, mark in enumerate(watched.marks):
        for e, event in enumerate(watched.events):
            away_s = abs(event.decided_ns - mark.end_ns) * 1e-9
            if mark.label == event.label and away_s <= tolerance_s:
                pairs.append((-away_s, m, e))
    return _greedy(watched, pairs)


def _greedy(watched: Watched, pairs: list[tuple[float, int, int]]) -> Match:
    marks: dict[int, int] = {}
    taken: set[int] = set()
    for _, m, e in sorted(pairs, key=lambda pair: (-pair[0], pair[1], pair[2])):
        if m not in marks and e not in taken:
            marks[m] = e
            taken.add(e)
    return Match(
        tuple((mark, watched.events[marks[m]]) for m, mark in enumerate(watched.marks) if m in marks),
        tuple(mark for m, mark in enumerate(watched.marks) if m not in marks),
        tuple(event for e, event in enumerate(watched.events) if e not in taken),
    )


def f1(matches: Sequence[Match]) -> float | None:
    """Return 2 TP / (2 TP + FP + FN) over all streams together; None if there is neither mark nor event."""
    found = sum(len(m.found) for m in matches)
    wrong = sum(len(m.missed) + len(m.false) for m in matches)
    return 2 * found / (2 * found + wrong) if found + wrong else None


def poisson_interval(count: float, hours: float) -> tuple[float, float]:
    """Exact 95 % interval of a rate, events an hour (Garwood, Biometrika 1936).

    Args:
        count: Events seen; may be a fraction where the same material was watched several times.
        hours: Hours watched.

    Raises:
        InputError: If the count is negative or the time is not positive.

    Example:
        >>> [round(x, 2) for x in poisson_interval(0, 2.0)]
        [0.0, 1.84]
    """
    from scipy.stats import chi2

    if count < 0 or not hours > 0:
        raise InputError(f"Expected a count from 0 and hours above 0, but got {count} and {hours}.")
    # Of far less than one event the lower limit is far below any number; the library says NaN there.
    low = float(np.nan_to_num(chi2.ppf(0.025, 2 * count))) / 2 if count > 0 else 0.0
    return low / hours, float(chi2.ppf(0.975, 2 * count + 2)) / 2 / hours


def jaccard(watched: Sequence[Watched]) -> float | None:
    """Mean over streams and classes of the overlap in time of what is shown and what is understood.

    ChaLearn's index (Escalera et al., "ChaLearn Looking at People Challenge 2014", ECCV Workshops 2014):
    for each stream and each class that is shown or answered in it, the time that both cover over the time
    that either covers; 0 for a class that is on one side only. None if there is nothing on either side.
    """
    shares = []
    for one in watched:
        for label in sorted({m.label for m in one.marks} | {str(e.label) for e in one.events}):
            shown = _union([(m.onset_ns, m.end_ns) for m in one.marks if m.label == label])
            said = _union([(e.onset_ns, e.end_ns) for e in one.events if e.label == label])
            both = _length(shown) + _length(said) - _length(_union(shown + said))
            either = _length(_union(shown + said))
            shares.append(both / either if either else 0.0)
    return float(np.mean(shares)) if shares else None


def _union(spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    joined: list[tuple[int, int]] = []
    for begin, end in sorted(spans):
        if joined and begin <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((begin, end))
    return joined


def _length(spans: list[tuple[int, int]]) -> int:
    return sum(end - begin for begin, end in spans)


@dataclass(frozen=True, slots=True)
class Delays:
    """When commands fell, over all marks that were answered. Every array has one entry a mark."""

    from_end_s: Float[np.ndarray, " found"]
    """From the gesture's true end to the decision; below 0: decided before the end."""
    from_onset_s: Float[np.ndarray, " found"]
    """From the gesture's true beginning to the decision."""
    share_seen: Float[np.ndarray, " found"]
    """Share of the gesture's length that had passed at the decision, at most 1."""


def delays(matches: Sequence[Match]) -> Delays:
    """Measure when the decisions fell."""
    found = [pair for match in matches for pair in match.found]
    end = np.array([(event.decided_ns - mark.end_ns) * 1e-9 for mark, event in found])
    onset = np.array([(event.decided_ns - mark.onset_ns) * 1e-9 for mark, event in found])
    lengths = np.array([max(mark.duration_s, 1e-9) for mark, _ in found])
    return Delays(end, onset, np.clip(onset / lengths, 0.0, 1.0))


__all__ = [
    "ACTION_POINT_S", "IOU", "Delays", "Match", "Watched", "delays", "f1", "iou", "jaccard",
    "match_by_decision", "match_by_moment", "match_by_overlap", "poisson_interval",
]  # fmt: skip
