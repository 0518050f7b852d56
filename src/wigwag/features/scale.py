"""Features of different units are made comparable: min-max scaling learned from training clips."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Self

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError, NotFittedError
from wigwag.features.estimator import Transformer


class FrameScaler(Transformer):
    """Scale each feature linearly by what its values are in the training clips' frames.

    Frames of other clips may fall outside of the range; they are not clipped, so that the distance
    between an unknown movement and the known ones stays what it is. A feature that never changes in
    training becomes 0 there and is left in its own unit.

    Args:
        method: ``"minmax"``: minimum and maximum become -1 and 1 (paper, section 3). ``"quantile"``: the
            1st and 99th percentile do, so that one noisy frame does not decide how much an acceleration
            counts. ``"std"``: mean 0, standard deviation 1/3.
        weights: How many times each feature counts in a distance, after it is scaled; ``None``: once.

    Attributes:
        center_: What becomes 0, for each feature.
        half_range_: How far above it a feature becomes 1, for each feature.

    Raises:
        InputError: From ``fit``, if the method is not known or there is no frame.
        NotFittedError: From ``transform`` before ``fit``.
    """

    center_: Float[np.ndarray, " features"]
    half_range_: Float[np.ndarray, " features"]

    def __init__(
        self,
        method: Literal["minmax", "quantile", "std"] = "minmax",
        weights: Float[np.ndarray, " features"] | None = None,
    ) -> None:
        self.method = method
        self.weights = weights

    def fit(self, sequences: Sequence[Float[np.ndarray, "frames features"]], y: object = None) -> Self:
        """Learn the range of each feature from all frames of the training sequences.

        They are gone through one at a time, so that a sequence that computes its elements may be given.
        """
        if len(sequences) == 0:
            raise InputError("FrameScaler.fit needs at least one sequence, but got an empty list.")
        if self.method == "minmax":
            ends = np.array([(s.min(axis=0), s.max(axis=0)) for s in sequences], dtype=np.float64)
            low, high = ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)
        elif self.method == "quantile":
            # A few thousand frames settle a percentile; all of them would only cost time and memory.
            starts = np.cumsum([0, *map(len, sequences)])
            every = max(1, int(starts[-1]) // 6000)
            some = (s[-start % every :: every] for start, s in zip(starts[:-1], sequences, strict=True))
            frames = [part.copy() for part in some]  # a view would keep its whole sequence
            low, high = np.percentile(np.concatenate(frames), [1.0, 99.0], axis=0)
        elif self.method == "std":
            count = sum(map(len, sequences))
            mean = np.sum([s.sum(axis=0, dtype=np.float64) for s in sequences], axis=0) / count
            square = np.sum([((s - mean) ** 2).sum(axis=0) for s in sequences], axis=0) / count
            low, high = mean - 3 * np.sqrt(square), mean + 3 * np.sqrt(square)
        else:
            raise InputError(
                f"FrameScaler.method must be 'minmax', 'quantile' or 'std', but got {self.method!r}."
            )
        self.center_ = (low + high) / 2
        half = (high - low) / 2
        # What counts as constant is relative: rounding alone moves a large constant a little.
        constant = half <= 1e-6 * np.maximum(1.0, np.abs(self.center_))
        self.half_range_ = np.where(constant, 1.0, half)
        if self.weights is not None:
            self.half_range_ = self.half_range_ / self.weights
        return self

    def transform(
        self, sequences: Sequence[Float[np.ndarray, "frames features"]]
    ) -> list[Float[np.ndarray, "frames features"]]:
        """Scale each sequence; the floating point type stays."""
        if not hasattr(self, "center_"):
            raise NotFittedError("FrameScaler is not fitted yet; call fit with training sequences first.")
        return [self.scale(sequence) for sequence in sequences]

    def scale(self, sequence: Float[np.ndarray, "frames features"]) -> Float[np.ndarray, "frames features"]:
        """Scale one sequence."""
        center = self.center_.astype(sequence.dtype)
        factor = (1 / self.half_range_).astype(sequence.dtype)
        return np.asarray((sequence - center) * factor)  # eq. min-max scaling to [-1, 1]
