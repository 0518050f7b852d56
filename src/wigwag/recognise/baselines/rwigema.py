"""Rwigema et al. 2019: dynamic time warping whose weights differential evolution finds.

Rwigema, Choi, Kim, "A Differential Evolution Approach to Optimize Weights of Dynamic Time Warping for
Multi-Sensor Based Gesture Recognition", Sensors 19(5), 2019. Written anew from its description, for a
skeleton alone: the original adds inertial sensors, and weighs sensors as well as joints.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from wigwag.features import Normalisation
from wigwag.recognise.baselines.nearest import NearestBaseline, others_than
from wigwag.recognise.baselines.warp import dtw_each
from wigwag.skeleton import Clip


class RwigemaRecognizer(NearestBaseline):
    """One nearest neighbour; the distance is a weighted sum of the 13 joints' own DTW distances.

    The weights (0 to 1) are those with which most training clips are nearest to a clip of their own class
    among *other* people's clips, found by differential evolution.

    Args:
        normalisation: What is done to a clip in space; ``None``: the paper's.
        generations: Of the evolution, at most.
        population: Individuals, as a multiple of the 13 weights.
        random_state: Seed of the evolution.

    Attributes:
        weights_: One a landmark, 0 to 1.
        inner_accuracy_: Share of training clips that are right with them, people left out.
    """

    def __init__(
        self,
        *,
        normalisation: Normalisation | None = None,
        generations: int = 40,
        population: int = 10,
        random_state: int = 0,
    ) -> None:
        self.normalisation = normalisation
        self.generations = generations
        self.population = population
        self.random_state = random_state

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames 3 13"]:
        joints = (self.normalisation or Normalisation.paper()).apply(clip).joints
        return np.ascontiguousarray(joints.transpose(0, 2, 1), dtype=np.float32)

    def _tune(self) -> None:
        from scipy.optimize import differential_evolution

        each = self._between()
        judged = np.flatnonzero(self._gesture)
        others = np.array([others_than(self.subjects_, i) for i in judged])
        costs = np.where(others[:, :, None], each[judged], np.float32(1e6))
        right = self.labels_[judged][:, None] == self.labels_[None, :]

        def error(weights: Float[np.ndarray, " 13"]) -> float:
            return 1 - _share_right(costs @ weights.astype(np.float32), right)

        found = differential_evolution(
            error,
            [(0.0, 1.0)] * costs.shape[2],
            maxiter=self.generations,
            popsize=self.population,
            rng=self.random_state,
            x0=np.full(costs.shape[2], 0.5),
            polish=False,  # the error is a staircase: there is no slope to follow
            tol=0.0,
        )
        self.weights_ = np.asarray(found.x)
        self.inner_accuracy_ = 1 - float(found.fun)
        self._each = each

    def _between(self) -> Float[np.ndarray, "clips clips 13"]:
        """Return each joint's DTW distance between all training clips."""
        n, joints = len(self.references_), self.references_[0].shape[2]
        each = np.zeros((n, n, joints), dtype=np.float32)
        for i in range(n):
            for j in range(i):
                each[i, j] = each[j, i] = dtw_each(self.references_[i], self.references_[j])
        return each

    def _distances(self, sequence: np.ndarray) -> Float[np.ndarray, " references"]:
        each = np.array([dtw_each(sequence, reference) for reference in self.references_])
        return np.asarray(each @ self.weights_)

    def _left_out(self) -> list[tuple[np.ndarray, Bool[np.ndarray, " references"]]]:
        between = self._each @ self.weights_
        return [(row, others_than(self.subjects_, i)) for i, row in enumerate(between)]


def _share_right(
    distances: Float[np.ndarray, "clips references"], right: Bool[np.ndarray, "clips references"]
) -> float:
    return float(np.mean(right[np.arange(len(right)), distances.argmin(axis=1)]))


__all__ = ["RwigemaRecognizer"]
