"""How sure to be: learned from people left out of teaching, and from gestures that nobody taught."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.special import logsumexp

from wigwag.recognise.acceptance import BACKGROUND, Acceptance, Trials, nearest_of_each, signs_of
from wigwag.recognise.ridge import gram_matrix, normal_matrices, solve, solve_apart

_MOST_FOLDS = 8
_CLASS_FOLDS = 7
_USUAL_TEMPERATURE, _USUAL_TEMPERATURE_APART = 6.0, 12.0
_USUAL_SIGNS = np.array([[0.4, 1.0, 1.4, -0.4, 0.0, 0.6], [1.0, 2.0, 2.0, 0.4, 0.8, 1.6]])
_LEAST_TYPICAL = 0.5
"""No gesture is expected to be shown more alike than this by two people; in usual distances, all views."""


class Doubt:
    """What a ridge recogniser makes of clips whose people, or whose gestures, took no part in teaching.

    Every person is left out in turn, and every half of them: once with all gestures taught, and seven
    times with a seventh of the gestures untaught, when any decision for a gesture is wrong. What is seen
    then sets the threshold below which a decision is refused, and how sharply scores become probabilities.

    What is decided is what all views say at once; among the signs that it is right is what they say each by
    itself, on average (:attr:`~wigwag.recognise.ridge.EmpiricalMapRidge.weights_apart`): of a movement that
    nobody taught, some view is nearly always sure, but rarely all of them. With 21 gestures taught by three
    training people of UTD-MHAD, 29 instead of 36 % of the other six are accepted at 95 % of those taught;
    26 % with sevenths of the gestures untaught instead of thirds, which leave too little (3 draws;
    over 7 draws, with thirds, 26 instead of 30 %).

    Args:
        false_reject: See :class:`~wigwag.recognise.acceptance.Acceptance`.

    Attributes:
        acceptance: Fitted.
        temperature: By which scores are multiplied before softmax.
        typical: How far the nearest example by another person usually is, a gesture.
        taught_background: Whether there were clips that are no gesture.
    """

    def __init__(self, false_reject: float) -> None:
        self.acceptance = Acceptance(false_reject)
        self.temperature = _USUAL_TEMPERATURE

    def fit(
        self,
        features: Float[np.ndarray, "examples features"],
        relative: Float[np.ndarray, "clips clips"],
        numbers: Int[np.ndarray, " clips"],
        people: Int[np.ndarray, " clips"],
        ridge: float,
        *,
        apart: bool = False,
    ) -> Self:
        """Leave people and gestures out, teach, and look.

        Args:
            features: Similarities to all clips, several a clip side by side; first the rows of the clips
                themselves, then as many of each set of copies.
            relative: Distances between the clips.
            numbers: Their gestures; ``BACKGROUND``: none.
            people: Whose they are.
            ridge: Weight of the penalty.
            apart: What is decided is what the views say each by itself, too.
        """
        classes = int(numbers.max()) + 1
        self.taught_background = bool((numbers == BACKGROUND).any())
        self.typical = _typical(relative, numbers, people, classes)
        lesson = _Lesson(self, features, relative, numbers, ridge, apart)
        trials, held = Trials(), Held([], [])
        for fold in _folds(people):
            out = np.isin(people, fold)
            lesson.leave_out(out, _class_folds(numbers, classes), trials, held)
        if not trials.signs:  # one clip of one gesture: nothing can be left out, so expect what is usual
            trials.add(_USUAL_SIGNS, np.array([True, True]))
        self.acceptance.fit(trials)
        self.temperature = _temperature(held, _USUAL_TEMPERATURE_APART if apart else _USUAL_TEMPERATURE)
        return self

    def background(self, scores: Float[np.ndarray, "clips classes+1"]) -> Float[np.ndarray, " clips"]:
        """Return the score of 'no gesture', -1 where it was not taught."""
        return np.asarray(scores[:, -1] if self.taught_background else np.full(len(scores), -1.0))

    def add_gesture(self) -> None:
        """Expect of one more gesture what is usual for the others."""
        self.typical = np.append(self.typical, np.median(self.typical))

    def forget_gesture(self, number: int) -> None:
        """Take one gesture away."""
        self.typical = np.delete(self.typical, number)

    def facts(self) -> dict[str, Any]:
        """Return what was learned, as plain numbers."""
        return {
            "acceptance": self.acceptance.facts(),
            "temperature": self.temperature,
            "typical": self.typical.tolist(),
            "taught_background": self.taught_background,
        }

    def restore(self, facts: dict[str, Any]) -> Self:
        """Take back what ``facts`` gave."""
        self.acceptance.restore(facts["acceptance"])
        self.temperature = float(facts["temperature"])
        self.typical = np.array(facts["typical"])
        self.taught_background = bool(facts["taught_background"])
        return self


def targets_of(
    numbers: Int[np.ndarray, " examples"], classes: int
) -> Float[np.ndarray, "examples classes+1"]:
    """Return 1 for what an example is and -1 for what it is not; the last column is 'no gesture'."""
    targets = np.full((len(numbers), classes + 1), -1.0)
    targets[np.arange(len(numbers)), numbers] = 1.0  # BACKGROUND, -1, is the last column
    return targets


@dataclass(frozen=True, slots=True)
class _Lesson:
    """Everything that could be taught, of which some is left out."""

    doubt: Doubt
    features: Float[np.ndarray, "examples features"]
    relative: Float[np.ndarray, "clips clips"]
    numbers: Int[np.ndarray, " clips"]
    ridge: float
    apart: bool

    def leave_out(
        self,
        out: Bool[np.ndarray, " clips"],
        unknowns: list[Bool[np.ndarray, " clips"]],
        trials: Trials,
        held: Held,
    ) -> None:
        """Teach without some people, then without some gestures too; note what is made of these."""
        views = self.features.shape[1] // len(out)
        here = np.flatnonzero(~out)
        whole = self.features[np.ix_(self._rows(~out), np.repeat(~out, views))].astype(np.float64)
        gram, normals = gram_matrix(whole), normal_matrices(whole, views)
        for unknown in [np.zeros(len(out), dtype=bool), *unknowns]:
            everything = not unknown.any()
            shown = np.flatnonzero(out if everything else out & unknown)
            kept = ~(out | unknown)
            if len(shown) == 0 or not (self.numbers[kept] != BACKGROUND).any():
                continue
            stay = ~unknown[here]
            rows, columns = np.tile(stay, len(whole) // len(here)), np.repeat(stay, views)
            taught, less, lesser = whole, gram, normals
            if not everything:
                # What is left out is a sum of its own: taken off, not everything else computed anew.
                taught = whole[np.ix_(rows, columns)]
                less = (gram - gram_matrix(whole[:, ~columns]))[np.ix_(rows, rows)]
                gone = normal_matrices(whole[~rows], views)
                lesser = [(n - g)[np.ix_(stay, stay)] for n, g in zip(normals, gone, strict=True)]
            targets = targets_of(
                np.tile(self.numbers, len(self.features) // len(out)), len(self.doubt.typical)
            )
            targets = targets[self._rows(kept)]
            apart = solve_apart(taught, targets, lesser, self.ridge * len(taught))
            weights = apart if self.apart else taught.T @ solve(less, targets, self.ridge)
            self._judge(shown, kept, (weights, apart), trials, held if everything else None)

    def _rows(self, clips: Bool[np.ndarray, " clips"]) -> Bool[np.ndarray, " examples"]:
        return np.tile(clips, len(self.features) // len(clips))

    def _judge(
        self,
        shown: Int[np.ndarray, " shown"],
        kept: Bool[np.ndarray, " clips"],
        weights: tuple[np.ndarray, np.ndarray],
        trials: Trials,
        held: Held | None,
    ) -> None:
        """Note what ``weights``, all views' and each by itself, make of the clips shown."""
        doubt, numbers = self.doubt, self.numbers
        gestures = np.unique(numbers[kept & (numbers != BACKGROUND)])
        similar = self.features[np.ix_(shown, np.repeat(kept, self.features.shape[1] // len(kept)))]
        scores, apart = (similar @ w for w in weights)
        near = nearest_of_each(self.relative[np.ix_(shown, kept)], numbers[kept], len(doubt.typical))
        decided, signs = signs_of(
            scores[:, gestures], doubt.background(scores), near[:, gestures], doubt.typical[gestures],
            apart[:, gestures],
        )  # fmt: skip
        trials.add(signs, gestures[decided] == numbers[shown])
        if held is not None:
            known = np.isin(numbers[shown], gestures)
            held.scores.append(scores[known, :-1])
            held.numbers.append(numbers[shown][known])


@dataclass(slots=True)
class Held:
    """Scores of clips whose people, but not whose gestures, were left out."""

    scores: list[Float[np.ndarray, "clips classes"]]
    numbers: list[Int[np.ndarray, " clips"]]


def _temperature(held: Held, usual: float) -> float:
    """Choose the sharpness at which softmax of the scores is the best forecast of what was shown."""
    if not sum(map(len, held.numbers)):  # nobody was left out whose gestures others show too
        return usual
    scores, numbers = np.concatenate(held.scores), np.concatenate(held.numbers)
    candidates = np.geomspace(1.0, 30.0, 35)
    surprise = [
        float(np.mean(logsumexp(t * scores, axis=1) - t * scores[np.arange(len(scores)), numbers]))
        for t in candidates
    ]
    return float(candidates[int(np.argmin(surprise))])


def person_folds(people: Int[np.ndarray, " clips"]) -> list[Int[np.ndarray, " people"]]:
    """Leave each person out, or so many at a time that there are eight turns; none if there is only one."""
    names = np.unique(people)
    if len(names) < 2:
        return []
    shuffled = np.random.default_rng(0).permutation(names)
    return np.array_split(shuffled, min(len(names), _MOST_FOLDS))


def _folds(people: Int[np.ndarray, " clips"]) -> list[Int[np.ndarray, " people"]]:
    """Leave people out as in ``person_folds``, and then each half of them.

    With all but one of a few people in training, hardly anything goes wrong; a new person who moves unlike
    any of them is not among these trials. Halves are the harder and, for that, the more honest ones.
    """
    folds = person_folds(people)
    names = np.concatenate(folds) if folds else np.zeros(0, dtype=int)
    return folds + (np.array_split(names, 2) if len(names) > 3 else [])


def _class_folds(numbers: Int[np.ndarray, " clips"], classes: int) -> list[np.ndarray]:
    """Mark the clips of a seventh of the gestures, seven times; nothing where there are only two."""
    if classes < 3:
        return []
    parts = np.array_split(np.random.default_rng(0).permutation(classes), min(classes, _CLASS_FOLDS))
    return [np.isin(numbers, part) for part in parts]


def _typical(
    relative: Float[np.ndarray, "clips clips"],
    numbers: Int[np.ndarray, " clips"],
    people: Int[np.ndarray, " clips"],
    classes: int,
) -> Float[np.ndarray, " classes"]:
    """Return, for each gesture, how far the nearest example by somebody else usually is."""
    others = (numbers[:, None] == numbers) & (people[:, None] != people) & (numbers != BACKGROUND)[:, None]
    nearest = np.where(others, relative, np.inf).min(axis=1)
    seen = np.isfinite(nearest)
    if not seen.any():  # one example of each gesture: as far as clips are from each other, halved
        return np.full(classes, max(float(np.median(relative)) / 2, _LEAST_TYPICAL))
    overall = float(np.median(nearest[seen]))
    result = np.empty(classes)
    for number in range(classes):
        # Four clips' worth of the overall value steady a gesture of few examples.
        near = np.append(nearest[seen & (numbers == number)], [overall] * 4)
        logs = np.log(np.maximum(near, _LEAST_TYPICAL))
        result[number] = np.exp(logs.mean())
    return result
