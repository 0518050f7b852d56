"""Is it one of the taught gestures at all? Learned from people, and from gestures, left out of training."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.special import expit

BACKGROUND = -1
"""Stands for 'a movement that is no gesture' where labels are numbers."""

N_SIGNS = 6

_LEAST_SPREAD = 0.1
"""Of a sign; a few trials that came out alike must not make a small difference a big one."""


@dataclass(slots=True)
class Trials:
    """What was seen of clips that took no part in teaching: one row each."""

    signs: list[Float[np.ndarray, "clips signs"]] = field(default_factory=list)
    right: list[Bool[np.ndarray, " clips"]] = field(default_factory=list)

    def add(self, signs: Float[np.ndarray, "clips signs"], right: Bool[np.ndarray, " clips"]) -> None:
        """Add clips: their signs, and whether to act on what was decided would have been right."""
        self.signs.append(signs)
        self.right.append(right)


def signs_of(
    scores: Float[np.ndarray, "clips classes"],
    background: Float[np.ndarray, " clips"],
    near: Float[np.ndarray, "clips classes"],
    typical: Float[np.ndarray, " classes"],
    apart: Float[np.ndarray, "clips classes"],
) -> tuple[Int[np.ndarray, " clips"], Float[np.ndarray, "clips signs"]]:
    """Return what each clip is most like, and the six signs that it truly is that.

    Args:
        scores: Of the gestures, about 1 for the one that is shown and -1 for the others.
        background: Score of 'no gesture'; -1 where none was taught.
        near: Distance to the nearest example of each gesture.
        typical: That distance as it is between people who show the same gesture.
        apart: Scores as ``scores``, but the mean of what each view says by itself.

    Returns:
        The decided class, and: its score, its lead over the second, its lead over 'no gesture', how
        near its nearest example is, as the negative logarithm of distance over typical distance, and its
        score and its lead among ``apart``.
    """
    clips = np.arange(len(scores))
    decided = scores.argmax(axis=1)
    top, lead = _lead(scores, decided)
    top_apart, lead_apart = _lead(apart, decided)
    nearness = -np.log(np.maximum(near[clips, decided], 1e-9) / typical[decided])
    near_enough = np.clip(nearness, -3, 3)
    return decided, np.column_stack([top, lead, top - background, near_enough, top_apart, lead_apart])


def _lead(
    scores: Float[np.ndarray, "clips classes"], decided: Int[np.ndarray, " clips"]
) -> tuple[Float[np.ndarray, " clips"], Float[np.ndarray, " clips"]]:
    """Return the decided classes' scores, and how far they are ahead of the best other; of -1 if alone."""
    clips = np.arange(len(scores))
    others = scores.copy()
    others[clips, decided] = -np.inf
    second = others.max(axis=1) if scores.shape[1] > 1 else np.full(len(scores), -1.0)
    return scores[clips, decided], scores[clips, decided] - second


def nearest_of_each(
    relative: Float[np.ndarray, "clips references"], numbers: Int[np.ndarray, " references"], classes: int
) -> Float[np.ndarray, "clips classes"]:
    """Return the distance to the nearest reference of each gesture; infinite where there is none."""
    near = np.full((classes, len(relative)), np.inf)
    known = numbers != BACKGROUND
    np.minimum.at(near, numbers[known], relative[:, known].T)
    return near.T


class Acceptance:
    """A logistic regression from signs to the probability that acting on the decision is right.

    No sign may speak against itself: a higher score, a wider lead or a nearer example never make it less
    sure.

    Args:
        false_reject: The threshold turns this share of right decisions away, as seen on training people
            who were left out.
    """

    def __init__(self, false_reject: float = 0.05) -> None:
        self.false_reject = false_reject

    def fit(self, trials: Trials) -> Self:
        """Learn weights and threshold."""
        signs, right = np.concatenate(trials.signs), np.concatenate(trials.right)
        self.center_, self.spread_ = signs.mean(axis=0), np.maximum(signs.std(axis=0), _LEAST_SPREAD)
        scaled = (signs - self.center_) / self.spread_
        if right.all():  # nothing to tell apart was ever seen: all signs count alike
            self.weights_, self.offset_ = np.ones(N_SIGNS), 2.0
        elif not right.any():  # act on what beats everything that was wrong
            self.weights_, self.offset_ = np.ones(N_SIGNS), -float(scaled.sum(axis=1).max())
        else:
            self.weights_, self.offset_ = _fit_logistic(scaled, right)
        kind = self.score(signs[right]) if right.any() else np.zeros(1)
        self.threshold_ = float(np.quantile(kind, self.false_reject))
        wrong = self.score(signs[~right])
        self.false_accept_ = float(np.mean(wrong >= self.threshold_)) if len(wrong) else 0.0
        return self

    def score(self, signs: Float[np.ndarray, "clips signs"]) -> Float[np.ndarray, " clips"]:
        """Return the log odds that the decision is right."""
        return np.asarray((signs - self.center_) / self.spread_ @ self.weights_ + self.offset_)

    def probability(self, score: Float[np.ndarray, " clips"]) -> Float[np.ndarray, " clips"]:
        """Turn log odds into probabilities."""
        return np.asarray(expit(score))

    def facts(self) -> dict[str, Any]:
        """Return what was learned, as plain numbers."""
        return {
            "center": self.center_.tolist(), "spread": self.spread_.tolist(),
            "weights": self.weights_.tolist(), "offset": self.offset_,
            "threshold": self.threshold_, "false_accept": self.false_accept_,
        }  # fmt: skip

    def restore(self, facts: dict[str, Any]) -> Self:
        """Take back what ``facts`` gave."""
        self.center_, self.spread_ = np.array(facts["center"]), np.array(facts["spread"])
        self.weights_, self.offset_ = np.array(facts["weights"]), float(facts["offset"])
        self.threshold_, self.false_accept_ = float(facts["threshold"]), float(facts["false_accept"])
        return self


def _fit_logistic(
    rows: Float[np.ndarray, "clips signs"], right: Bool[np.ndarray, " clips"]
) -> tuple[Float[np.ndarray, " signs"], float]:
    """Fit with weights of one sign, both outcomes counting alike, lightly held at 0."""
    from scipy.optimize import minimize  # 20 MB that only teaching needs

    sign = np.where(right, 1.0, -1.0)
    count = np.where(right, 0.5 / right.sum(), 0.5 / (~right).sum()) * len(right)

    def loss(x: np.ndarray) -> tuple[float, np.ndarray]:
        z = sign * (rows @ x[:-1] + x[-1])
        slope = -sign * count * expit(-z)
        value = float(count @ np.logaddexp(0, -z)) + 0.5 * float(x[:-1] @ x[:-1])
        return value, np.append(rows.T @ slope + x[:-1], slope.sum())

    width = rows.shape[1]
    bounds = [(0, None)] * width + [(None, None)]
    x = minimize(loss, np.zeros(width + 1), jac=True, method="L-BFGS-B", bounds=bounds).x
    return x[:-1], float(x[-1])
