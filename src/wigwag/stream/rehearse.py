"""Thresholds, chosen by hearing streams of people who took no part in teaching."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.stream.config import StreamConfig
from wigwag.stream.speaker import Look, Speaker, Thresholds
from wigwag.stream.truth import Showing
from wigwag.stream.watcher import Hypothesis

_GOING_ON = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.985, 0.99, 0.995)
_AT_REST = (0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99)
_LEAST = min(*_GOING_ON, *_AT_REST)
_ROOM = 1.15
"""The nearest example may be so many times as far as it has ever been when the label was right."""


@dataclass(slots=True)
class Rehearsal:
    """One stream as it looks to what other people have taught."""

    fold: int
    truth: tuple[Showing, ...]
    duration_s: float
    hypotheses: list[Hypothesis]
    signs: Float[np.ndarray, "looks signs"]
    decided: Int[np.ndarray, " looks"]
    right: Bool[np.ndarray, " looks"]
    doubtful: Bool[np.ndarray, " looks"]


@dataclass(frozen=True, slots=True)
class Tally:
    """What came of hearing streams with one pair of thresholds."""

    found: int
    false: int
    missed: int
    hours: float

    @property
    def f1(self) -> float:
        """Of events: right where the label is, once a gesture."""
        return 2 * self.found / max(2 * self.found + self.false + self.missed, 1)

    @property
    def false_per_hour(self) -> float:
        """False commands."""
        return self.false / max(self.hours, 1e-9)


def choose(
    rehearsals: Sequence[Rehearsal],
    probabilities: Sequence[Float[np.ndarray, " looks"]],
    labels: Sequence[str],
    config: StreamConfig,
) -> Thresholds:
    """Return the thresholds with the best event F1 that keep to the false commands allowed.

    If none keep to it, those with the fewest false commands.
    """
    looks = [_looks(one, sure, labels, config) for one, sure in zip(rehearsals, probabilities, strict=True)]
    best, chosen = (False, -np.inf, -np.inf), Thresholds(_GOING_ON[-1], _AT_REST[-1])
    for going_on, at_rest in product(_GOING_ON, _AT_REST):
        thresholds = Thresholds(going_on, at_rest)
        tally = hear(rehearsals, looks, config, thresholds)
        keeps = tally.false_per_hour <= config.false_per_hour
        # Of equals the stricter: it comes later.
        worth = (keeps, tally.f1 if keeps else -tally.false_per_hour, tally.f1)
        if worth >= best:
            best, chosen = worth, thresholds
    return chosen


def hear(
    rehearsals: Sequence[Rehearsal],
    looks: Sequence[Sequence[Look]],
    config: StreamConfig,
    thresholds: Thresholds,
) -> Tally:
    """Hear streams and count."""
    found = false = missed = 0
    hours = 0.0
    for one, seen in zip(rehearsals, looks, strict=True):
        speaker = Speaker(config, thresholds)
        spoken = [look for look in seen if speaker.hear(look)]
        wanted = [showing for showing in one.truth if speaker.may(showing.label)]
        answered: set[int] = set()
        for look in spoken:
            mine = [n for n, showing in enumerate(wanted) if n not in answered and _about(look, showing)]
            if mine:
                answered.add(mine[0])
                found += 1
            else:
                false += 1
        missed += len(wanted) - len(answered)
        hours += one.duration_s / 3600
    return Tally(found, false, missed, hours)


def limits_of(rehearsals: Sequence[Rehearsal], labels: int) -> Float[np.ndarray, " labels"]:
    """Return how many times the usual distance the nearest example of each gesture may be away."""
    times: list[list[float]] = [[] for _ in range(labels)]
    for one in rehearsals:
        for i in np.flatnonzero(one.right):
            times[one.decided[i]].append(float(np.exp(-one.signs[i, 4])))
    every = [t for mine in times for t in mine]
    usual = float(np.quantile(every, 0.99)) if every else np.inf
    return np.array([_ROOM * max(max(mine, default=usual), usual) for mine in times])


def _looks(
    one: Rehearsal, sure: Float[np.ndarray, " looks"], labels: Sequence[str], config: StreamConfig
) -> list[Look]:
    """Return those looks of a stream that might be spoken."""
    may = np.array([config.commands is None or label in config.commands for label in labels])
    looks = []
    for i in np.flatnonzero((sure >= _LEAST) & may[one.decided]):
        h, label, progress = one.hypotheses[i], labels[one.decided[i]], float(one.signs[i, 3])
        looks.append(Look(label, float(sure[i]), progress, h.onset_ns, h.now_ns, h.resting, False, ""))
    return looks


def _about(look: Look, showing: Showing) -> bool:
    """Say whether a decision is about a showing."""
    if look.label != showing.label:
        return False
    return look.onset_ns <= showing.end_ns and look.now_ns >= showing.onset_ns
