"""How sure is a decision? Learned from what happens to people, and to gestures, left out of training."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.special import expit

BACKGROUND = -1
"""Stands for 'a movement that is no gesture' where labels are numbers."""

_CLIP = 3.0
"""Log ratios of distances beyond this (a factor of 20) say no more than this."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What the distances of one clip to all references say about the decision for one class."""

    decided: int
    """Number of the class that the k nearest vote for; ``BACKGROUND`` if they are no gesture."""
    share: float
    """Share of the k nearest that vote for it."""
    nearest: float
    """Distance to the nearest reference of that class."""
    rival: float
    """Distance to the nearest reference of anything else; infinite if there is nothing else."""


def weigh(
    distances: Float[np.ndarray, " references"],
    numbers: Int[np.ndarray, " references"],
    voters: Int[np.ndarray, " k"],
    voter_distances: Float[np.ndarray, " k"],
) -> Evidence:
    """Let the nearest references vote; a tie goes to the class with the smaller sum of distances."""
    candidates = np.unique(numbers[voters])
    votes = [
        (-np.sum(numbers[voters] == c), voter_distances[numbers[voters] == c].mean(), c) for c in candidates
    ]
    count, _, decided = min(votes)
    same = numbers == decided
    return Evidence(
        decided=int(decided),
        share=float(-count) / len(voters),
        nearest=float(distances[same].min()),
        rival=float(distances[~same].min()) if not same.all() else np.inf,
    )


def held_out(
    distances: Float[np.ndarray, "clips clips"], subjects: list[str | None]
) -> Bool[np.ndarray, "clips clips"]:
    """Say which references each training clip may meet as if it were new: those of other people.

    Where only one person is known, or a clip has no person, only the clip itself is left out.
    """
    known = {s for s in subjects if s is not None}
    people = np.array(
        [f"{s}" if s is not None and len(known) > 1 else f"#{i}" for i, s in enumerate(subjects)]
    )
    return np.asarray((people[:, None] != people[None, :]) & np.isfinite(distances))


def choose_k(
    distances: Float[np.ndarray, "clips clips"],
    numbers: Int[np.ndarray, " clips"],
    allowed: Bool[np.ndarray, "clips clips"],
    candidates: tuple[int, ...],
) -> tuple[int, dict[int, float]]:
    """Choose k by the accuracy with which other people's clips decide each clip.

    The smallest k within one standard error of the best is taken: a larger one needs more examples of
    each gesture than a new user has.
    """
    order = np.argsort(np.where(allowed, distances, np.inf), axis=1, kind="stable")
    accuracy = {}
    for k in candidates:
        right = []
        for i in np.flatnonzero(numbers != BACKGROUND):
            voters = order[i, : min(k, int(allowed[i].sum()))]
            if len(voters):
                right.append(weigh(distances[i], numbers, voters, distances[i][voters]).decided == numbers[i])
        accuracy[k] = float(np.mean(right)) if right else 0.0
    best = max(accuracy.values())
    error = np.sqrt(best * (1 - best) / max(1, int(np.sum(numbers != BACKGROUND))))
    return min(k for k in candidates if accuracy[k] >= best - error), accuracy


class Confidence:
    """Turns the evidence for a decision into the probability that acting on it is right.

    It learns from the training clips alone, each judged by other people's references: once as it is, and
    once with its own gesture taken away from the references, as if it were a movement nobody taught, when
    any decision for a gesture is wrong. A logistic regression weighs three things: the margin (log of
    rival over nearest distance), the novelty (log of nearest over the distance that is typical between
    people who show this gesture), and the share of votes. A nearer rival, a farther example or fewer votes
    never make it surer. Where it was taught other movements as background, or its gestures lie far apart,
    few of these trials go wrong, and it is sure of nearly everything that comes as far as a gesture.

    ``threshold_`` lets at most ``false_accept`` of the movements that are not a taught gesture pass as
    one, unless that would turn away more than ``false_reject`` of the right decisions. ``novelty_limit_``
    is twice what nearly every right decision (99 %) stays below: beyond it a movement is unlike anything
    taught, whatever the margin says.
    """

    def __init__(self, false_accept: float = 0.02, false_reject: float = 0.05) -> None:
        self.false_accept = false_accept
        self.false_reject = false_reject

    def fit(
        self,
        distances: Float[np.ndarray, "clips clips"],
        numbers: Int[np.ndarray, " clips"],
        allowed: Bool[np.ndarray, "clips clips"],
        k: int,
    ) -> Self:
        """Learn from the distances between training clips, at a given k."""
        self._learn_typical(distances, numbers, allowed)
        rows: list[list[float]] = []
        right: list[bool] = []
        movements = 0
        for i, number in enumerate(numbers):
            masks = [allowed[i]]
            if number != BACKGROUND:
                masks.append(allowed[i] & (numbers != number))
            movements += number == BACKGROUND or len(masks) == 2
            for mask in masks:
                evidence = _evidence(distances[i], numbers, mask, k)
                if evidence is not None and evidence.decided != BACKGROUND:
                    rows.append(self._features(evidence))
                    right.append(evidence.decided == number)
        self._learn(np.array(rows).reshape(-1, 3), np.array(right, dtype=bool), int(movements))
        return self

    def _learn_typical(
        self, distances: np.ndarray, numbers: Int[np.ndarray, " clips"], allowed: np.ndarray
    ) -> None:
        same = allowed & (numbers[:, None] == numbers[None, :])
        nearest = np.where(same, distances, np.inf).min(axis=1)
        gesture = (numbers != BACKGROUND) & np.isfinite(nearest)
        if not gesture.any():  # every gesture is known from one clip or one person: any distance will do
            finite = distances[allowed]
            typical = float(np.median(finite)) if finite.size else 1.0
            self.typical_ = np.full(numbers.max() + 1, max(typical, 1e-12))
            return
        overall = np.median(nearest[gesture])
        self.typical_ = np.array(
            [
                # Four clips' worth of the overall value steady a class of few clips.
                np.exp(
                    np.mean(
                        np.log(np.maximum(np.append(nearest[gesture & (numbers == c)], [overall] * 4), 1e-12))
                    )
                )
                for c in range(numbers.max() + 1)
            ]
        )

    def _learn(self, rows: np.ndarray, right: np.ndarray, movements: int) -> None:
        if right.all() or not right.any():
            # Nothing was ever wrong (or right), so there is nothing to weigh: novelty alone, falling through
            # one half at twice the typical distance.
            self.weights_, self.offset_ = np.array([0.0, -4.0, 0.0]), 4.0 * np.log(2.0)
        else:
            self.weights_, self.offset_ = _fit_logistic(rows, right)
        scores = expit(rows @ self.weights_ + self.offset_) if len(rows) else np.zeros(0)
        wrong = np.sort(scores[~right])[::-1]
        allowed = int(self.false_accept * movements)
        kind = float(np.quantile(scores[right], self.false_reject)) if right.any() else 0.5
        if len(wrong) == 0:  # nothing to guard against was ever seen
            self.threshold_ = kind
        else:  # just above the first that must not pass
            strict = np.nextafter(wrong[allowed], 1.0) if len(wrong) > allowed else 0.0
            self.threshold_ = float(min(strict, kind))
        usual = np.quantile(rows[right, 1], 0.99) if right.any() else np.log(2.0)
        self.novelty_limit_ = 2.0 * float(np.exp(max(usual, 0.0)))
        self.rates_ = {
            "false_accept": float(np.sum(scores[~right] >= self.threshold_) / max(movements, 1)),
            "false_reject": float(np.mean(scores[right] < self.threshold_)) if right.any() else 0.0,
        }

    def _features(self, evidence: Evidence) -> list[float]:
        margin = np.log(np.maximum(evidence.rival, 1e-12) / max(evidence.nearest, 1e-12))
        return [
            float(np.clip(margin, -_CLIP, _CLIP)),
            float(np.clip(np.log(self.novelty(evidence)), -_CLIP, _CLIP)),
            evidence.share,
        ]

    def novelty(self, evidence: Evidence) -> float:
        """How far the nearest example is, in distances that are typical between people."""
        return max(evidence.nearest, 1e-12) / float(self.typical_[evidence.decided])

    def __call__(self, evidence: Evidence) -> float:
        """Return the probability that acting on the decision is right."""
        return float(expit(np.dot(self.weights_, self._features(evidence)) + self.offset_))


def _evidence(
    distances: np.ndarray, numbers: Int[np.ndarray, " references"], mask: np.ndarray, k: int
) -> Evidence | None:
    """Weigh one training clip against the references that it may meet; None if there are none."""
    kept = np.flatnonzero(mask)
    if len(kept) == 0:
        return None
    near = distances[kept]
    voters = np.argsort(near, kind="stable")[:k]
    return weigh(near, numbers[kept], voters, near[voters])


def _fit_logistic(
    rows: Float[np.ndarray, "decisions 3"], right: Bool[np.ndarray, " decisions"]
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Fit a logistic regression whose weights have the sign that sense demands, lightly held at 0."""
    from scipy.optimize import minimize  # 20 MB that only teaching needs

    sign = np.where(right, 1.0, -1.0)

    def loss(x: np.ndarray) -> tuple[float, np.ndarray]:
        z = sign * (rows @ x[:3] + x[3])
        slope = -sign * expit(-z)
        value = float(np.sum(np.logaddexp(0, -z)) + 0.5 * x[:3] @ x[:3])
        return value, np.append(rows.T @ slope + x[:3], slope.sum())

    bounds = [(0, None), (None, 0), (0, None), (None, None)]  # margin, novelty, share, offset
    x = minimize(loss, np.zeros(4), jac=True, method="L-BFGS-B", bounds=bounds).x
    return x[:3], float(x[3])
