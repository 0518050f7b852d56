"""Many reference sequences side by side, so that one query meets all of them at machine speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from wigwag.errors import InputError

_LANES = 32
"""References warped together: their cells stand side by side and fill whole SIMD registers."""


class PackedSequences:
    """Reference sequences, arranged for computing a query's DTW distance to all of them.

    Sequences of similar length form blocks of 32. Within a block, frame ``t`` of all its sequences stands
    side by side, so that the recurrence of dynamic time warping, which cannot be vectorised along one
    pair, is vectorised across 32. Local costs come from one matrix product a block,
    ``|a - b|^2 = |a|^2 + |b|^2 - 2 a.b``, about the references' mean, which keeps the cancellation small.

    Args:
        sequences: One array (frames, features) a reference; lengths may differ.
        dtype: Floating point type of the computation; ``None``: that of the first sequence.

    Raises:
        InputError: If there is no sequence, or one is empty or has other features than the first.
    """

    def __init__(
        self, sequences: Sequence[Float[np.ndarray, "frames features"]], dtype: str | None = None
    ) -> None:
        check_sequences(sequences)
        kind = np.dtype(dtype or sequences[0].dtype)
        self._dtype = kind if kind in (np.float32, np.float64) else np.dtype(np.float64)
        self._lengths = np.array([len(s) for s in sequences], dtype=np.int64)
        total = np.sum([s.sum(axis=0, dtype=np.float64) for s in sequences], axis=0)
        self._mean = (total / self._lengths.sum()).astype(self._dtype)
        self.n_features = len(self._mean)
        order = np.argsort(self._lengths, kind="stable")
        self._blocks = [
            self._pack([sequences[i] for i in order[at : at + _LANES]], order[at : at + _LANES])
            for at in range(0, len(order), _LANES)
        ]

    def __len__(self) -> int:
        return len(self._lengths)

    def _pack(
        self, sequences: list[np.ndarray], members: Int[np.ndarray, " members"]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Interleave one block; shorter sequences are padded by their last frame and read out before it."""
        longest = max(map(len, sequences))
        block = np.zeros((longest, _LANES, self.n_features + 2), dtype=self._dtype)
        for lane, sequence in enumerate(sequences):
            centered = sequence.astype(self._dtype) - self._mean
            block[: len(sequence), lane, :-2] = centered
            block[len(sequence) :, lane, :-2] = centered[-1]
        # Two more columns turn the product with (-2a, |a|^2, 1) into the squared distance.
        block[:, :, -2] = 1.0
        block[:, :, -1] = np.einsum("tlf,tlf->tl", block[:, :, :-2], block[:, :, :-2])
        return members, np.ascontiguousarray(block.reshape(-1, self.n_features + 2).T)

    def distances(
        self, query: Float[np.ndarray, "frames features"], band: int | None = None
    ) -> Float[np.ndarray, " references"]:
        """Return the DTW distance of the query to each reference, in the order they were given."""
        if query.ndim != 2 or query.shape[1] != self.n_features or len(query) == 0:
            raise InputError(f"The query must have shape (frames, {self.n_features}), but got {query.shape}.")
        if band is not None and band < 0:
            raise InputError(f"band must be 0 or more frames, or None, but got {band}.")
        centered = query.astype(self._dtype) - self._mean
        left = np.empty((len(query), self.n_features + 2), dtype=self._dtype)
        np.multiply(centered, -2, out=left[:, :-2])
        left[:, -2] = np.einsum("tf,tf->t", centered, centered)
        left[:, -1] = 1.0
        result = np.empty(len(self), dtype=self._dtype)
        width = np.iinfo(np.int32).max if band is None else int(band)
        ends = np.empty(_LANES, dtype=self._dtype)
        for members, block in self._blocks:
            squares = left @ block
            lengths = np.ones(_LANES, dtype=np.int64)
            lengths[: len(members)] = self._lengths[members]
            _warp(squares, lengths, _LANES, width, ends)
            result[members] = ends[: len(members)]
        return result


def check_sequences(sequences: Sequence[np.ndarray]) -> int:
    """Count all frames.

    Raises:
        InputError: Unless all are (frames, features) with the same features and a frame at least.
    """
    if len(sequences) == 0:
        raise InputError("DTW needs at least one sequence, but got an empty list.")
    features, frames = np.shape(sequences[0])[-1], 0
    for i, sequence in enumerate(sequences):
        if np.ndim(sequence) != 2 or len(sequence) == 0 or sequence.shape[1] != features:
            raise InputError(
                f"Sequence {i} must have shape (frames, {features}) with 1 frame or more, "
                f"but got {np.shape(sequence)}."
            )
        frames += len(sequence)
    return frames


@njit(cache=True, fastmath=True)
def _warp(squares, lengths, lanes, band, ends):  # type: ignore[no-untyped-def]  # compiled
    """Run the DTW recurrence for all lanes at once over squared local costs (query, time x lanes)."""
    n = squares.shape[0]
    longest = squares.shape[1] // lanes
    far, zero = squares.dtype.type(1e30), squares.dtype.type(0)
    # Row i of the recurrence is kept with one column of `lanes` before it that no path enters.
    before = np.full((longest + 1) * lanes, far, squares.dtype)
    row = np.full((longest + 1) * lanes, far, squares.dtype)
    before[:lanes] = 0.0
    limits = np.empty(lanes, squares.dtype)
    for lane in range(lanes):
        limits[lane] = max(band, abs(n - lengths[lane]))
    widest = limits.max()
    for i in range(n):
        for t in range(longest):
            at = t * lanes
            off = squares.dtype.type(abs(i - t))
            if off > widest:
                for lane in range(lanes):
                    row[at + lanes + lane] = far
                continue
            for lane in range(lanes):
                best = min(before[at + lane], before[at + lanes + lane], row[at + lane])
                cost = np.sqrt(max(squares[i, at + lane], zero)) + best
                row[at + lanes + lane] = cost if off <= limits[lane] else far
        before, row = row, before
        row[:lanes] = far
        before[:lanes] = far
    for lane in range(lanes):
        ends[lane] = before[lengths[lane] * lanes + lane]
