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
_EARLY = 0.02
"""How much better or worse thresholds may be for deciding everything before its end, or nothing."""

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
    deliberate: bool = False
    """As in :class:`~wigwag.stream.truth.LabelledStream`."""


@dataclass(frozen=True, slots=True)
class Tally:
    """What came of hearing streams with one pair of thresholds."""

    found: int
    false: int
    on_gestures: int
    """Of the false ones: those said while another gesture was shown, or of deliberate movement."""
    early: int
    """Of those found: decided before the gesture's end."""
    missed: int
    hours: float
    """Of all streams but those of deliberate movement."""

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


def choose(
    rehearsals: Sequence[Rehearsal],
    probabilities: Sequence[Float[np.ndarray, " looks"]],
    labels: Sequence[str],
    config: StreamConfig,
) -> Thresholds:
    """Return the thresholds of most worth that keep to the false commands allowed.

    If none keep to it, those with the fewest. A command said of another gesture counts in the worth; it is
    no everyday movement, and nobody shows gestures for hours. Few people leave many thresholds equally good:
    the middle ones are taken, which are farthest from where gestures of others would be lost and from where
    what is none would be spoken.
    """
    looks = [_looks(one, sure, labels, config) for one, sure in zip(rehearsals, probabilities, strict=True)]
    best, equal = (False, -np.inf, -np.inf), [Thresholds(_GOING_ON[-1], _AT_REST[-1])]
    for going_on, at_rest in product(_GOING_ON, _AT_REST):
        thresholds = Thresholds(going_on, at_rest)
        tally = hear(rehearsals, looks, config, thresholds)
        keeps = tally.false_per_hour <= config.false_per_hour
        least = 0.0 if keeps else -tally.false_per_hour
        worth = (keeps, least, tally.worth(config.earliness))
        if worth > best:
            best, equal = worth, [thresholds]
        elif worth == best:
            equal.append(thresholds)
    going_on = _middle([one.going_on for one in equal])
    return Thresholds(going_on, _middle([one.at_rest for one in equal if one.going_on == going_on]))


def _middle(values: Sequence[float]) -> float:
    """Return the middle one of different values, the lower of two."""
    ordered = sorted(set(values))
    return ordered[(len(ordered) - 1) // 2]


def hear(
    rehearsals: Sequence[Rehearsal],
    looks: Sequence[Sequence[Look]],
    config: StreamConfig,
    thresholds: Thresholds,
) -> Tally:
    """Hear streams and count."""
    found = false = on_gestures = early = missed = 0
    hours = 0.0
    for one, seen in zip(rehearsals, looks, strict=True):
        speaker = Speaker(config, thresholds)
        spoken = [said for look in seen if (said := speaker.hear(look)) is not None]
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
                on_gestures += one.deliberate or any(_meets(look, showing) for showing in one.truth)
        missed += len(wanted) - len(answered)
        hours += 0.0 if one.deliberate else one.duration_s / 3600
    return Tally(found, false, on_gestures, early, missed, hours)


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
    """Return those looks of a stream that might be spoken, or at which one that waits might be."""
    may = np.array([config.commands is None or label in config.commands for label in labels])
    looks = []
    resting = np.array([h.resting for h in one.hypotheses])
    for i in np.flatnonzero(((sure >= _LEAST) & may[one.decided]) | resting):
        h, label, progress = one.hypotheses[i], labels[one.decided[i]], float(one.signs[i, 3])
        looks.append(Look(label, float(sure[i]), progress, h.onset_ns, h.now_ns, h.resting, False, ""))
    return looks


def _about(look: Look, showing: Showing) -> bool:
    """Say whether a decision is about a showing."""
    return look.label == showing.label and _meets(look, showing)


def _meets(look: Look, showing: Showing) -> bool:
    return look.onset_ns <= showing.end_ns and look.now_ns >= showing.onset_ns
