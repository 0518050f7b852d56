"""Many reference sequences side by side, so that one query meets all of them at machine speed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.distances.kernels import bound_all, lanes_of, nearest, warp_all, warp_strip
from wigwag.errors import InputError

Cost = Literal["euclidean", "squared"]
"""Distance between two frames: Euclidean, or its square."""

_DIRECT_FEATURES = 96
"""Up to so many features, local costs are computed from differences, and only those within the band;
beyond, a matrix product is faster (measured; the two are equal at about this many)."""

_STRIP = 16
"""Frames of the query whose local costs within a band come from one matrix product."""

_BOX_FRAMES, _BOX_FRAMES_IN_BAND = 8, 4
"""Frames of the query that share a box in the lower bound, without and with a band."""

_SLACK = 1e-4
"""Relative room for rounding whenever a bound decides that a reference need not be looked at."""


class PackedSequences:
    """Reference sequences, arranged for computing a query's DTW distance to all of them.

    Sequences of similar length form blocks of 32 (float64: 16). Within a block, a feature of a frame of
    all its sequences stands side by side, so that the recurrence of dynamic time warping, which cannot be
    vectorised along one pair, is vectorised across 32. Up to 96 features, local costs are sums over
    squared differences and nothing cancels. Beyond, they come from matrix products,
    ``|a - b|^2 = |a|^2 + |b|^2 - 2 a.b``, about the references' mean, which keeps the cancellation small.

    Args:
        sequences: One array (frames, features) a reference; lengths may differ.
        dtype: Floating point type of the computation; ``None``: that of the first sequence.

    Raises:
        InputError: If there is no sequence, or one is empty or has other features than the first.

    Example:
        >>> import numpy as np
        >>> rising, falling = np.arange(4.0)[:, None], np.arange(4.0)[::-1, None]
        >>> packed = PackedSequences([rising, falling])
        >>> packed.distances(rising + 1).tolist()
        [2.0, 9.0]
        >>> packed.nearest(rising + 1)[0].tolist()
        [0]
    """

    def __init__(
        self, sequences: Sequence[Float[np.ndarray, "frames features"]], dtype: str | None = None
    ) -> None:
        check_sequences(sequences)
        kind = np.dtype(dtype or sequences[0].dtype)
        self._dtype = kind if kind in (np.float32, np.float64) else np.dtype(np.float64)
        self._lengths = np.array([len(s) for s in sequences], dtype=np.int64)
        self._offsets = np.concatenate([[0], np.cumsum(self._lengths)])
        total = np.sum([s.sum(axis=0, dtype=np.float64) for s in sequences], axis=0)
        self._mean = (total / self._offsets[-1]).astype(self._dtype)
        self.n_features = len(self._mean)
        self._flat = np.empty((self._offsets[-1], self.n_features), dtype=self._dtype)
        for sequence, start, stop in zip(sequences, self._offsets, self._offsets[1:], strict=False):
            self._flat[start:stop] = sequence - self._mean
        self._largest = float(np.sqrt(np.einsum("tf,tf->t", self._flat, self._flat).max()))

    def __len__(self) -> int:
        return len(self._lengths)

    def distances(
        self,
        query: Float[np.ndarray, "frames features"],
        band: int | None = None,
        cost: Cost = "euclidean",
    ) -> Float[np.ndarray, " references"]:
        """Return the DTW distance of the query to each reference, in the order they were given.

        Args:
            query: One row a frame.
            band: Sakoe-Chiba band: frames ``i`` and ``j`` are aligned only if ``|i - j| <= band``. For
                each reference it is widened to the difference of the lengths. ``None``: no limit.
            cost: Distance between two frames.

        Raises:
            InputError: If the query has other features, no frame or a NaN, or the band is negative.
        """
        padded, width, squared = self._checked(query, band, cost)
        if self.n_features > _DIRECT_FEATURES:
            return self._by_product(padded[:-1], width, squared)
        order, lengths, starts, data = self._direct
        ends = np.empty(len(lengths), dtype=self._dtype)
        warp_all(padded, data, starts, lengths, width, squared, ends)
        result = np.empty(len(self), dtype=self._dtype)
        result[order] = ends[: len(order)]
        return result

    def bounds(
        self,
        query: Float[np.ndarray, "frames features"],
        band: int | None = None,
        cost: Cost = "euclidean",
    ) -> Float[np.ndarray, " references"]:
        """Return a lower bound of what :meth:`distances` returns, at a fraction of the time.

        Exact in real numbers, and rounding is taken off. The arguments are those of :meth:`distances`.
        """
        padded, width, squared = self._checked(query, band, cost)
        order, lengths, starts, data = self._narrow
        ends = np.empty(len(lengths), dtype=np.float32)
        box = _BOX_FRAMES if band is None else _BOX_FRAMES_IN_BAND
        bound_all(padded.astype(np.float32), box, data, starts, lengths, width, squared, ends)
        result = np.empty(len(self))
        result[order] = ends[: len(order)]
        # A difference of two float32 numbers is off by their size times 2^-24; there is one a cell.
        scale = self._largest + float(np.abs(padded).max()) * np.sqrt(self.n_features)
        steps = len(query) + self._lengths
        room = steps * 2.0**-22 * scale * (4 * scale if squared else 1.0)
        return np.maximum(result * (1 - _SLACK) - room, 0.0)

    def nearest(
        self,
        query: Float[np.ndarray, "frames features"],
        k: int = 1,
        band: int | None = None,
        cost: Cost = "euclidean",
        allowed: Bool[np.ndarray, " references"] | None = None,
    ) -> tuple[Int[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Return the k nearest references, nearest first, and their DTW distances, exactly.

        Lower bounds of all references come first, and distances only in their order, until the next
        bound lies beyond the k-th best distance. For thousands of features use
        :class:`wigwag.distances.NearestSequences`.

        Args:
            query: One row a frame.
            k: How many; fewer come back if fewer are allowed.
            band: As in :meth:`distances`.
            cost: As in :meth:`distances`.
            allowed: References that take part; ``None``: all.

        Raises:
            InputError: As :meth:`distances`, or if k is less than 1.
        """
        if k < 1:
            raise InputError(f"k must be 1 or more, but got {k}.")
        padded, width, squared = self._checked(query, band, cost)
        if self.n_features > _DIRECT_FEATURES:
            bounds = np.asarray(self.distances(query, band, cost), dtype=np.float64)
        else:
            bounds = self.bounds(query, band, cost)
        order = np.argsort(bounds, kind="stable")
        if allowed is not None:
            order = order[allowed[order]]
        k = min(k, len(order))
        if self.n_features > _DIRECT_FEATURES or k == 0:
            return order[:k], bounds[order[:k]]
        found, distances, _ = nearest(padded, self._flat, self._offsets, order, bounds, width, squared, k)
        return found, distances

    def _checked(
        self, query: np.ndarray, band: int | None, cost: str
    ) -> tuple[Float[np.ndarray, "frames+1 features"], int, bool]:
        """Check the arguments; return the query about the mean with one row more, the band, the cost."""
        if np.ndim(query) != 2 or query.shape[1] != self.n_features or len(query) == 0:
            raise InputError(
                f"The query must have shape (frames, {self.n_features}), but got {np.shape(query)}."
            )
        padded = np.zeros((len(query) + 1, self.n_features), dtype=self._dtype)
        np.subtract(query, self._mean, out=padded[:-1], casting="same_kind")
        if not np.isfinite(padded).all():
            raise InputError("The query holds NaN or infinity; fill or drop such frames.")
        return padded, width_of(band), is_squared(cost)

    @cached_property
    def _direct(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        return self._interleave(self._dtype)

    @cached_property
    def _narrow(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The same in float32, which is enough for a bound and half as much to read."""
        return self._direct if self._dtype == np.float32 else self._interleave(np.dtype(np.float32))

    def _interleave(self, dtype: np.dtype) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the references' order, lengths by lane, where blocks start, and data (frames, features, lanes).

        Shorter sequences of a block are padded by their last frame and read out before it, missing ones
        by the block's last.
        """
        lanes = lanes_of(dtype)
        order = np.argsort(self._lengths, kind="stable")
        members = np.append(order, np.repeat(order[-1:], -len(order) % lanes)).reshape(-1, lanes)
        starts = np.concatenate([[0], np.cumsum(self._lengths[members].max(axis=1))])
        data = np.empty((starts[-1], self.n_features, lanes), dtype=dtype)
        for block, first in zip(members, starts[:-1], strict=True):
            frames = np.arange(self._lengths[block].max())[:, None]
            rows = self._offsets[block] + np.minimum(frames, self._lengths[block] - 1)
            data[first : first + len(frames)] = self._flat[rows].transpose(0, 2, 1)
        return order, self._lengths[members].ravel(), starts, data

    @cached_property
    def _blocks(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Members, lengths by lane, and a matrix (features + 2, frames * lanes) of each block.

        Two more rows turn the product with (-2a, |a|^2, 1) into the squared distance.
        """
        lanes, blocks = lanes_of(self._dtype), []
        order = np.argsort(self._lengths, kind="stable")
        for at in range(0, len(order), lanes):
            members = order[at : at + lanes]
            lengths = np.append(self._lengths[members], [self._lengths[members[-1]]] * (lanes - len(members)))
            block = np.zeros((lengths.max(), lanes, self.n_features + 2), dtype=self._dtype)
            for lane, i in enumerate(members):
                block[: lengths[lane], lane, :-2] = self._flat[self._offsets[i] : self._offsets[i + 1]]
                block[lengths[lane] :, lane, :-2] = self._flat[self._offsets[i + 1] - 1]
            block[:, :, -2] = 1.0
            block[:, :, -1] = np.einsum("tlf,tlf->tl", block[:, :, :-2], block[:, :, :-2])
            blocks.append((members, lengths, np.ascontiguousarray(block.reshape(-1, self.n_features + 2).T)))
        return blocks

    def _by_product(
        self, centered: Float[np.ndarray, "frames features"], width: int, squared: bool
    ) -> Float[np.ndarray, " references"]:
        """Compute distances with local costs from matrix products, strip by strip along the band."""
        n, lanes = len(centered), lanes_of(self._dtype)
        left = np.empty((n, self.n_features + 2), dtype=self._dtype)
        np.multiply(centered, -2, out=left[:, :-2])
        left[:, -2] = np.einsum("tf,tf->t", centered, centered)
        left[:, -1] = 1.0
        result, ends = np.empty(len(self), dtype=self._dtype), np.empty(lanes, dtype=self._dtype)
        for members, lengths, block in self._blocks:
            longest = block.shape[1] // lanes
            widest = max(width, int(np.abs(lengths - n).max()))
            rows = _STRIP if 2 * widest + _STRIP < longest else n
            lines = np.empty((2, longest + 1, lanes), dtype=self._dtype)
            for row in range(0, n, rows):
                some = left[row : row + rows]
                start, stop = max(0, row - widest), min(longest, row + len(some) + widest)
                squares = (some @ block[:, start * lanes : stop * lanes]).reshape(len(some), -1, lanes)
                warp_strip(squares, row, start, n, lengths, width, squared, lines, ends)
            result[members] = ends[: len(members)]
        return result


def width_of(band: int | None) -> int:
    """Return the band as a number of frames; none is wider than any sequence.

    Raises:
        InputError: If it is negative.
    """
    if band is None:
        return np.iinfo(np.int32).max
    if band < 0:
        raise InputError(f"band must be 0 or more frames, or None, but got {band}.")
    return int(band)


def is_squared(cost: str) -> bool:
    """Tell the two costs apart.

    Raises:
        InputError: If it is neither.
    """
    if cost not in ("euclidean", "squared"):
        raise InputError(f"cost must be 'euclidean' or 'squared', but got {cost!r}.")
    return cost == "squared"


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
