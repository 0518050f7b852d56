"""Celebi et al. 2013: dynamic time warping with joints weighted by how much they move in a gesture.

Celebi, Aydin, Temiz, Arici, "Gesture Recognition using Skeleton Data with Weighted Dynamic Time Warping",
VISAPP 2013. Written anew from its description.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from wigwag.recognise.baselines.nearest import NearestBaseline, by_shoulders
from wigwag.recognise.baselines.warp import dtw_weighted
from wigwag.skeleton import Clip

BETAS: tuple[float, ...] = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
"""Candidates for the parameter of the weights, in inverse shoulder widths travelled."""


class CelebiRecognizer(NearestBaseline):
    """One nearest neighbour under DTW; each reference is compared with the weights of its own class.

    Joints are measured from the middle of the shoulders in shoulder widths. With ``D`` the path that a joint
    travels in the examples of a class, on average, its weight in that class is

        w = (1 - exp(-beta D)) / (sum over joints of the same),

    and ``beta`` is the one that makes the mean distance between examples of different classes largest
    relative to that between examples of the same class. The original weighs the six joints of the arms;
    here all 13 take part, since some gestures are made with the legs. Movements that are no gesture share
    one set of weights.

    Args:
        beta: The parameter; ``None``: the best of ``BETAS`` on the training clips.
        examples: Clips a class that decide about beta; all would take minutes.
        random_state: Seed of their choice.

    Attributes:
        beta_: The parameter in use.
        weights_: One row a class (in the order of the sorted labels, none last), one column a landmark.
    """

    def __init__(self, *, beta: float | None = None, examples: int = 4, random_state: int = 0) -> None:
        self.beta = beta
        self.examples = examples
        self.random_state = random_state

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames 3 13"]:
        return np.ascontiguousarray(by_shoulders(clip).transpose(0, 2, 1), dtype=np.float32)

    def _tune(self) -> None:
        numbers = {label: i for i, label in enumerate(self.classes_)}
        self._numbers = np.array([numbers.get(label, len(numbers)) for label in self.labels_])
        paths = np.array(
            [np.linalg.norm(np.diff(s, axis=0), axis=1).sum(axis=0) for s in self.references_], np.float64
        )
        travelled = np.array([paths[self._numbers == c].mean(axis=0) for c in range(self._numbers.max() + 1)])
        self.beta_ = self._best_beta(travelled) if self.beta is None else float(self.beta)
        self.weights_ = _weights(travelled, self.beta_)

    def _best_beta(self, travelled: Float[np.ndarray, "classes 13"]) -> float:
        rng = np.random.default_rng(self.random_state)
        some = np.concatenate(
            [
                rng.permutation(np.flatnonzero(self._numbers == c))[: self.examples]
                for c in range(len(travelled))
            ]
        )
        same = self._numbers[some][:, None] == self._numbers[some][None, :]
        other = ~same
        np.fill_diagonal(same, False)
        if not same.any() or not other.any():
            return BETAS[len(BETAS) // 2]
        ratios = {}
        for beta in BETAS:
            weights = _weights(travelled, beta)[self._numbers]
            costs = np.array(
                [
                    [dtw_weighted(self.references_[i], self.references_[j], weights[j]) for j in some]
                    for i in some
                ]
            )
            ratios[beta] = costs[other].mean() / costs[same].mean()  # eq. discriminant ratio
        return max(ratios, key=lambda beta: ratios[beta])

    def _distances(self, sequence: np.ndarray) -> Float[np.ndarray, " references"]:
        weights = self.weights_[self._numbers]
        return np.array(
            [dtw_weighted(sequence, r, w) for r, w in zip(self.references_, weights, strict=True)]
        )


def _weights(travelled: Float[np.ndarray, "classes 13"], beta: float) -> Float[np.ndarray, "classes 13"]:
    activity = 1 - np.exp(-beta * np.maximum(travelled, 1e-9))  # eq. joint weight
    return np.asarray(activity / activity.sum(axis=1, keepdims=True))


__all__ = ["BETAS", "CelebiRecognizer"]
