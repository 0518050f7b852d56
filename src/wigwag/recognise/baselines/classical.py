"""Classical dynamic time warping: one nearest neighbour over normalised coordinates."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from wigwag.distances import PackedSequences
from wigwag.features import Normalisation
from wigwag.recognise.baselines.nearest import NearestBaseline
from wigwag.skeleton import Clip


class ClassicalRecognizer(NearestBaseline):
    """One nearest neighbour under unconstrained DTW over the 39 normalised coordinates of each frame.

    The paper's own baseline: its section 2 normalisation, no features.

    Args:
        normalisation: What is done to a clip in space; ``None``: the paper's.
    """

    def __init__(self, *, normalisation: Normalisation | None = None) -> None:
        self.normalisation = normalisation

    def _tune(self) -> None:
        self._packed = PackedSequences(self.references_)

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames 39"]:
        normalisation = self.normalisation or Normalisation.paper()
        return np.ascontiguousarray(normalisation.apply(clip).joints.reshape(len(clip), -1))

    def _distances(self, sequence: np.ndarray) -> Float[np.ndarray, " references"]:
        return self._packed.distances(sequence)


__all__ = ["ClassicalRecognizer"]
