"""Thresholds, chosen by hearing streams of people who took no part in teaching."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.stream.config import StreamConfig
from wigwag.stream.speaker import Look, Speaker, Thresholds
from wigwag.stream.sureness import doubted
from wigwag.stream.truth import Showing
from wigwag.stream.watcher import Hypothesis

_GOING_ON = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.985, 0.99, 0.995)
_AT_REST = (0.3, 0.4, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99)
_LEAST = min(*_GOING_ON, *_AT_REST)
_EARLY = 0.02
"""How much better or worse thresholds may be for deciding everything before its end, or nothing."""

_DOUBT, _MOST_DOUBT = 0.5, 8.0
"""Log odds by which a gesture is doubted more, and at most."""

_STRICTEST = Thresholds(_GOING_ON[-1], _AT_REST[-1])

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
    on_gestures: int
    """Of the false ones: those said while another gesture was shown."""
    early: int
    """Of those found: decided before the gesture's end."""
    missed: int
    hours: float
    """Of all streams."""
    everyday: Counter[str] = field(default_factory=Counter)
    """Of the false ones, by label: those said on everyday movement."""

    @property
    def f1(self) -> float:
        """Of events: right where the label is, once a gesture."""
        return 2 * self.found / max(2 * self.found + self.false + self.missed, 1)

    @property
    def false_per_hour(self) -> float:
        """False commands on everyday movement."""
        return (self.false - self.on_gestures) / max(self.hours, 1e-9)

    def worth(self, earliness: float) -> float:
        """What thresholds are chosen by: an F1 in which a false command is as bad as two missed ones.

        Of what is nearly as good, the earlier is preferred, by as much as it is wanted.
        """
        sure = 2 * self.found / max(2 * self.found + 2 * self.false + self.missed, 1)
        return sure + _EARLY * earliness * self.early / max(self.found, 1)


@dataclass(frozen=True, slots=True)
class Choice:
    """How sure to be."""

    thresholds: Thresholds
    doubts: Float[np.ndarray, " labels"]
    """So much less is each gesture believed, log odds: those that everyday movement is taken for."""


def choose(
    rehearsals: Sequence[Rehearsal],
    probabilities: Sequence[Float[np.ndarray, " looks"]],
    labels: Sequence[str],
    config: StreamConfig,
) -> Choice:
    """Return the thresholds of most worth that keep to the false commands allowed.

    One pair for all gestures, or one with doubts of those gestures that are said on everyday movement, one
    after the other, where that is worth more: else the gesture that is most like everyday movement, or like
    what other people gesture, would silence all. If none keep to it, those with the fewest. A command said of
    another gesture counts in the worth; it is no everyday movement, and nobody shows gestures for hours.
    """
    every = _Hearing(rehearsals, probabilities, labels, config)
    certain = np.zeros(len(labels))
    best, kept, free, wanted = (False, -np.inf, -np.inf), _STRICTEST, -np.inf, _STRICTEST
    looks = every.looks(certain)
    for going_on, at_rest in product(_GOING_ON, _AT_REST):
        thresholds = Thresholds(going_on, at_rest)
        tally = hear(rehearsals, looks, config, thresholds)
        if (worth := every.worth(tally)) >= best:
            best, kept = worth, thresholds
        if worth[-1] >= free:
            free, wanted = worth[-1], thresholds
    doubts = every.doubt(wanted)
    if every.worth(hear(rehearsals, every.looks(doubts), config, wanted)) > best:
        return Choice(wanted, doubts)
    return Choice(kept, certain)


class _Hearing:
    """Streams that are heard again and again."""

    def __init__(
        self,
        rehearsals: Sequence[Rehearsal],
        probabilities: Sequence[Float[np.ndarray, " looks"]],
        labels: Sequence[str],
        config: StreamConfig,
    ) -> None:
        self.rehearsals, self.probabilities = rehearsals, probabilities
        self.labels, self.config = labels, config

    def looks(self, doubts: Float[np.ndarray, " labels"]) -> list[list[Look]]:
        """Return what might be spoken of each stream."""
        return [
            _looks(one, doubted(sure, doubts[one.decided]), self.labels, self.config)
            for one, sure in zip(self.rehearsals, self.probabilities, strict=True)
        ]

    def worth(self, tally: Tally) -> tuple[bool, float, float]:
        """Return by what thresholds are compared: those that keep to what is allowed come first."""
        keeps = tally.false_per_hour <= self.config.false_per_hour
        return keeps, 0.0 if keeps else -tally.false_per_hour, tally.worth(self.config.earliness)

    def doubt(self, thresholds: Thresholds) -> Float[np.ndarray, " labels"]:
        """Doubt one gesture after the other, until no more is said on everyday movement than is allowed."""
        doubts = np.zeros(len(self.labels))
        tally = hear(self.rehearsals, self.looks(doubts), self.config, thresholds)
        while tally.false_per_hour > self.config.false_per_hour:
            tried = []
            for label, said in tally.everyday.items():
                number = self.labels.index(label)
                if doubts[number] >= _MOST_DOUBT:
                    continue
                more = doubts.copy()
                more[number] += _DOUBT
                then = hear(self.rehearsals, self.looks(more), self.config, thresholds)
                saved = tally.everyday.total() - then.everyday.total()
                tried.append((saved - (tally.found - then.found), said, number, then))
            if not tried:
                break
            _, _, number, tally = max(tried, key=lambda one: one[:3])
            doubts[number] += _DOUBT
        return doubts


def hear(
    rehearsals: Sequence[Rehearsal],
    looks: Sequence[Sequence[Look]],
    config: StreamConfig,
    thresholds: Thresholds,
) -> Tally:
    """Hear streams and count."""
    found = false = on_gestures = early = missed = 0
    everyday: Counter[str] = Counter()
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
                early += look.now_ns <= wanted[mine[0]].end_ns
            else:
                false += 1
                if any(_meets(look, showing) for showing in one.truth):
                    on_gestures += 1
                else:
                    everyday[look.label] += 1
        missed += len(wanted) - len(answered)
        hours += one.duration_s / 3600
    return Tally(found, false, on_gestures, early, missed, hours, everyday)


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
    return look.label == showing.label and _meets(look, showing)


def _meets(look: Look, showing: Showing) -> bool:
    return look.onset_ns <= showing.end_ns and look.now_ns >= showing.onset_ns
