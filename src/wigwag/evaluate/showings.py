"""Showings of a vocabulary's own examples: left out in turn, and played into a stream."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wigwag.datasets.recording import Mark, Recording
from wigwag.errors import InputError
from wigwag.evaluate.stream.moves import movement, resampled
from wigwag.features.augment import Augmentation
from wigwag.skeleton import Clip


def left_out(clips: Sequence[Clip], seed: int = 0) -> tuple[str, list[tuple[list[Clip], list[Clip]]]]:
    """Leave showings out as well as the examples allow.

    Whole people where two or more show every gesture; else every fourth showing of each gesture, or every
    third or second where there are fewer; else varied copies of the examples are judged.

    Args:
        clips: Labelled.
        seed: Of the copies.

    Returns:
        In words, what is left out, and of each turn the clips that teach and those that are judged.
    """
    shown: dict[str, Counter[str | None]] = {}
    for clip in clips:
        shown.setdefault(str(clip.label), Counter())[clip.subject] += 1
    if all(len(people) > 1 and None not in people for people in shown.values()):
        people = sorted({str(clip.subject) for clip in clips})
        groups = [people[i :: min(4, len(people))] for i in range(min(4, len(people)))]
        parts = [
            ([c for c in clips if c.subject not in g], [c for c in clips if c.subject in g]) for g in groups
        ]
        whole = [p for p in parts if {c.label for c in p[0]} == set(shown)]
        if len(whole) == len(parts):
            return f"people left out, {len(people)} in {len(groups)} turns", whole
    fewest = min(people.total() for people in shown.values())
    if fewest == 1:
        rng = np.random.default_rng([0xC0, seed])
        varied = Augmentation()
        copies = [replace(varied.apply(c, rng), name=f"{c.name}, varied") for c in clips for _ in range(4)]
        return "varied copies of the examples (there is one of some gesture): flatters", [
            (list(clips), copies)
        ]
    turns = min(4, fewest)
    place = {}
    for label in shown:
        for i, clip in enumerate(c for c in clips if c.label == label):
            place[id(clip)] = i % turns
    which = {2: "second", 3: "third", 4: "fourth"}[turns]
    return f"every {which} showing left out in turn", [
        ([c for c in clips if place[id(c)] != t], [c for c in clips if place[id(c)] == t])
        for t in range(turns)
    ]


def between_rests(
    clip: Clip, seed: int | Sequence[int] = 0, rest_s: float = 2.0, rate_hz: float = 30.0
) -> Recording:
    """Play a clip between two rests in its own first and last posture, with a millimetre or two of jitter.

    Args:
        clip: A showing.
        seed: Of the jitter.
        rest_s: Length of each rest.
        rate_hz: Poses a second.

    Returns:
        The stream; its mark is where the clip moves.
    """
    rng = np.random.default_rng([0xBE7, *np.atleast_1d(seed)])
    played = resampled(clip, np.arange(int(clip.duration_s * rate_hz) + 1) / rate_hz)
    rest = round(rest_s * rate_hz)
    joints = np.concatenate([np.repeat(played[:1], rest, 0), played, np.repeat(played[-1:], rest, 0)])
    joints += rng.normal(0, 0.0015, joints.shape)
    begin_s = rest / rate_hz
    try:
        onset_s, end_s = movement(clip)
    except InputError:  # a held posture: all of it is shown
        onset_s, end_s = 0.0, clip.duration_s
    mark = Mark(str(clip.label), round((begin_s + onset_s) * 1e9), round((begin_s + end_s) * 1e9))
    stream = Clip.at_rate(joints, rate_hz, None, clip.subject, f"{clip.name} between rests")
    return Recording(stream, (mark,))


__all__ = ["between_rests", "left_out"]
