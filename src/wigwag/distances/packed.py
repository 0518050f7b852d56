"""Many reference sequences side by side, so that one query meets all of them at machine speed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.distances.kernels import bound_all, lanes_of, nearest, warp_all
from wigwag.distances.pair import warp_pair
from wigwag.errors import InputError

Cost = Literal["euclidean", "squared"]
"""Distance between two frames: Euclidean, or its square."""

_BOX_FRAMES = 8
"""Frames of the query that share a box in the lower bound."""

_BOUND_VARIANCE = 0.9
"""Share of the references' variance that the directions hold which the lower bound looks at."""

_SLACK = 1e-4
"""Relative room for rounding whenever a bound decides that a reference need not be looked at."""


class _Lanes(NamedTuple):
    """References side by side, as the kernels take them."""

    order: Int[np.ndarray, " references"]
    """Which reference stands in which lane."""
    lengths: Int[np.ndarray, " lanes"]
    """Frames of each lane's reference."""
    starts: Int[np.ndarray, " blocks+1"]
    """Where each block begins in ``data``."""
    data: Float[np.ndarray, "frames features lanes"]


class PackedSequences:
    """Reference sequences, arranged for computing a query's DTW distance to all of them.

    Sequences of similar length form blocks of 32 (float64: 16). Within a block, a feature of a frame of
    all its sequences stands side by side, so that the recurrence of dynamic time warping, which cannot be
    vectorised along one pair, is vectorised across 32. Local costs are sums over squared differences, so
    that nothing cancels, and with a band only those within it are computed.

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
        [2.0, 8.0]
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
        return self._bounds(*self._checked(query, band, cost))

    def _bounds(
        self, padded: Float[np.ndarray, "frames+1 features"], width: int, squared: bool
    ) -> Float[np.ndarray, " references"]:
        basis, (order, lengths, starts, data) = self._narrow
        ends = np.empty(len(lengths), dtype=np.float32)
        projected = (padded @ basis).astype(np.float32)
        bound_all(projected, _BOX_FRAMES, data, starts, lengths, width, squared, ends)
        result = np.empty(len(self))
        result[order] = ends[: len(order)]
        return np.asarray(np.maximum(result * (1 - _SLACK) - self._room(padded, squared), 0.0))

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
        bounds = self._bounds(padded, width, squared)
        order = np.argsort(bounds, kind="stable")
        if allowed is not None:
            order = order[allowed[order]]
        k = min(k, len(order))
        if k == 0:
            return order, np.empty(0)
        narrow = padded.astype(np.float32, copy=False)
        found = nearest(narrow, self._flat32, self._offsets, order, bounds, width, squared, k)
        if self._dtype == np.float32:
            first = np.argsort(found, kind="stable")[:k]
            return order[first], found[first].astype(np.float64)
        # Float32 has found who may be among the nearest; few are measured again.
        limit = np.partition(found, k - 1)[k - 1] * (1 + _SLACK) + self._room(padded, squared).max()
        pairs = sorted(
            (self._exact(padded, i, width, squared), i) for i in order[: len(found)][found <= limit]
        )
        return np.array([i for _, i in pairs[:k]]), np.array([d for d, _ in pairs[:k]])

    def _exact(self, padded: np.ndarray, reference: int, width: int, squared: bool) -> float:
        frames = self._flat[self._offsets[reference] : self._offsets[reference + 1]]
        return float(warp_pair(padded[:-1], frames, width, squared))

    def _room(self, padded: np.ndarray, squared: bool) -> Float[np.ndarray, " references"]:
        """Return how far float32 may be off in a DTW distance.

        A difference of two numbers is off by their size times 2^-24, and there is one a cell of the path.
        """
        scale = self._largest + float(np.abs(padded).max()) * self.n_features**0.5
        steps = len(padded) + self._lengths
        return np.asarray(steps * (2.0**-22 * scale * (4 * scale if squared else 1.0)))

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
    def _direct(self) -> _Lanes:
        return self._interleave(self._flat)

    @cached_property
    def _flat32(self) -> Float[np.ndarray, "all_frames features"]:
        return self._flat.astype(np.float32, copy=False)

    @cached_property
    def _narrow(self) -> tuple[Float[np.ndarray, "features directions"], _Lanes]:
        """Few directions that hold most of the variance, and the references along them in float32.

        An orthonormal projection never lengthens a difference, so that a bound of the projected is one of
        the whole; and along principal directions the boxes are small.
        """
        flat = self._flat.astype(np.float64)
        variances, directions = np.linalg.eigh(flat.T @ flat)
        shares = np.cumsum(variances[::-1]) / max(float(variances.sum()), 1e-300)
        keep = min(int(np.searchsorted(shares, _BOUND_VARIANCE)) + 1, self.n_features)
        basis = np.ascontiguousarray(directions[:, ::-1][:, :keep])
        return basis.astype(self._dtype), self._interleave((flat @ basis).astype(np.float32))

    def _interleave(self, flat: Float[np.ndarray, "all_frames features"]) -> _Lanes:
        """Lay blocks of references side by side."""
        order, members = self._grouped(lanes_of(flat.dtype))
        starts = np.concatenate([[0], np.cumsum(self._lengths[members].max(axis=1))])
        data = np.empty((starts[-1], flat.shape[1], members.shape[1]), dtype=flat.dtype)
        for block, start, stop in zip(members, starts, starts[1:], strict=False):
            data[start:stop] = flat[self._rows(block)].transpose(0, 2, 1)
        return _Lanes(order, self._lengths[members].ravel(), starts, data)

    def _grouped(self, lanes: int) -> tuple[Int[np.ndarray, " references"], Int[np.ndarray, "blocks lanes"]]:
        """Order references by length and put them into blocks; the last is filled up with the longest."""
        order = np.argsort(self._lengths, kind="stable")
        return order, np.append(order, np.repeat(order[-1:], -len(order) % lanes)).reshape(-1, lanes)

    def _rows(self, members: Int[np.ndarray, " lanes"]) -> Int[np.ndarray, "frames lanes"]:
        """Find the members' frames in ``_flat``; shorter ones are padded by their last frame."""
        frames = np.arange(self._lengths[members].max())[:, None]
        return np.asarray(self._offsets[members] + np.minimum(frames, self._lengths[members] - 1))


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
        InputError: Unless all are (frames, features) with the same features, a frame at least, and
            finite numbers only.
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
        if not (finite := np.isfinite(sequence).all(axis=1)).all():
            raise InputError(
                f"Sequence {i} holds NaN or infinity, first in frame {int(np.argmin(finite))}. "
                "Fill or drop such frames."
            )
        frames += len(sequence)
    return frames
