"""MSRC-12: from action points, which are moments, to the movements that they stand in, for teaching."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from wigwag.datasets.recording import Mark, Recording
from wigwag.evaluate.stream.body import activity
from wigwag.evaluate.stream.lessons import Lesson
from wigwag.evaluate.stream.moves import resampled
from wigwag.skeleton import Clip

_RATE_HZ = 30.0
_LONGEST_S = 2.5
"""A movement begins at most so long before its action point, and ends at most so long after."""
_LULL_S = 0.15
_REST_M_S = 0.25
_REST_SHARE = 0.15

EXAMPLES_EACH = 6
"""So many examples of a gesture are taught of each person."""


@dataclass(frozen=True, slots=True)
class PointFold:
    """People who teach and people who are judged."""

    name: str
    taught: tuple[str, ...]
    judged: tuple[str, ...]


def point_folds(people: Sequence[str], count: int = 5) -> list[PointFold]:
    """Leave people out, every ``count``-th together.

    Args:
        people: All of them.
        count: How many folds; no more than people.
    """
    ordered = sorted(people)
    folds = []
    for number in range(min(count, len(ordered))):
        judged = tuple(ordered[number::count])
        folds.append(PointFold(f"fold {number + 1}", tuple(p for p in ordered if p not in judged), judged))
    return folds


def with_movements(recording: Recording) -> Recording:
    """Give each action point the movement around it.

    The body is fastest at some moment from one second before the action point to a little after it. From
    there the movement reaches back, and forward from the action point, to where the landmarks have been
    slower for 0.15 s than 0.25 m/s or 15 % of that speed, but not beyond the neighbouring action points.

    Returns:
        The recording, its marks from onset to end, each with ``point_ns``.
    """
    stream, marks = recording.stream, recording.marks
    times = np.arange(0.0, stream.duration_s, 1 / _RATE_HZ)
    if len(times) < 4 or not marks:
        return recording
    speed = activity(resampled(stream, times), _RATE_HZ)
    points = [mark.onset_ns * 1e-9 for mark in marks]
    found = []
    for number, mark in enumerate(marks):
        low = points[number - 1] + 0.3 if number else 0.0
        high = points[number + 1] - 0.1 if number + 1 < len(points) else times[-1]
        onset_s, end_s = _around(speed, points[number], max(low, 0.0), high)
        found.append(Mark(mark.label, round(onset_s * 1e9), round(end_s * 1e9), mark.onset_ns))
    return replace(recording, marks=tuple(found))


def _around(
    speed: Float[np.ndarray, " n"], point_s: float, low_s: float, high_s: float
) -> tuple[float, float]:
    last = len(speed) - 1
    point = min(round(point_s * _RATE_HZ), last)
    low = max(round(max(low_s, point_s - _LONGEST_S) * _RATE_HZ), 0)
    high = min(round(min(high_s, point_s + _LONGEST_S) * _RATE_HZ), last)
    near = slice(max(point - round(_RATE_HZ), low), min(point + 4, high) + 1)
    if near.stop <= near.start:
        return point_s, point_s
    peak = near.start + int(np.argmax(speed[near]))
    limit = max(_REST_M_S, _REST_SHARE * float(speed[peak]))
    lull = round(_LULL_S * _RATE_HZ)
    onset, slow = peak, 0
    for i in range(peak, low - 1, -1):
        slow = slow + 1 if speed[i] < limit else 0
        if slow >= lull:
            break
        onset = i if slow == 0 else onset
    end, slow = max(peak, point), 0
    for i in range(end, high + 1):
        slow = slow + 1 if speed[i] < limit else 0
        if slow >= lull:
            break
        end = i if slow == 0 else end
    return min(onset / _RATE_HZ, point_s), max(end / _RATE_HZ, point_s)


def point_lesson(recordings: Sequence[Recording], fold: PointFold, seed: int = 0) -> Lesson:
    """Return what a fold's training people teach: whole movements, and their streams.

    Args:
        recordings: MSRC-12 with action points as marks.
        fold: Who teaches.
        seed: Chooses the examples.
    """
    mine = [with_movements(r) for r in recordings if r.stream.subject in fold.taught]
    rng = np.random.default_rng([0x9012, seed])
    by_person: dict[tuple[str, str], list[Clip]] = {}
    for recording in mine:
        for clip in _cut(recording):
            by_person.setdefault((str(clip.label), str(clip.subject)), []).append(clip)
    gestures = []
    for key in sorted(by_person):
        clips = by_person[key]
        gestures += [clips[int(i)] for i in np.sort(rng.permutation(len(clips))[:EXAMPLES_EACH])]
    return Lesson(gestures, streams=mine, seed=seed)


def _cut(recording: Recording) -> Iterator[Clip]:
    stream = recording.stream
    for number, mark in enumerate(recording.marks):
        low, high = np.searchsorted(stream.stamps_ns, [mark.onset_ns, mark.end_ns + 1])
        stamps = stream.stamps_ns[low:high]
        if high - low >= 6 and float(np.diff(stamps).max()) < 0.3e9:
            yield Clip(
                stream.joints[low:high],
                stamps - stamps[0],
                mark.label,
                stream.subject,
                f"{stream.name}_{number}",
            )


__all__ = ["EXAMPLES_EACH", "PointFold", "point_folds", "point_lesson", "with_movements"]
