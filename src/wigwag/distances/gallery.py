"""The nearest among a million sequences: an index of vectors names a shortlist, DTW decides on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import gaussian_filter1d

from wigwag.distances.kernels import lanes_of, warp_chosen
from wigwag.distances.packed import Cost, check_sequences, is_squared, width_of
from wigwag.errors import InputError, MissingExtraError, NotFittedError

_LEARN_FROM = 5000
"""Sequences that the directions of the vectors are learned from; more change nothing."""

_CONNECTIVITY, _EXPANSION_ADD = 16, 128
"""Neighbours a node of the index keeps, and candidates looked at when one is added."""

_CHUNK = 1 << 14
"""Sequences that the exact search goes through at a time."""

_DTYPE = np.dtype(np.float32)


class Gallery:
    """Enrolled sequences of one length, of which the nearest is found in a time that hardly grows.

    The paper's second recogniser compares what is short first and dear last; so does this, at scale. Each
    sequence is also a vector: smoothed over time, so that a little warping moves it little, and projected
    on the principal directions. An index of such vectors (a navigable small world graph, Malkov and
    Yashunin 2018, by usearch) names a shortlist, and dynamic time warping finds the nearest on it. What
    DTW would have preferred may be missing on the shortlist: a longer one makes that rarer and costs time.

    Args:
        shortlist: Sequences that DTW compares. A gallery with fewer is searched whole, exactly.
        band: Sakoe-Chiba band, frames, as in :func:`wigwag.distances.dtw`; ``None``: no limit.
        cost: Distance between two frames, as there.
        directions: Length of the vectors.
        smooth: Standard deviation of the smoothing, as a share of the sequences' length.

    Raises:
        InputError: If a setting is out of range.

    Example:
        >>> import numpy as np
        >>> walks = np.random.default_rng(0).normal(size=(300, 24, 3)).cumsum(axis=1)
        >>> gallery = Gallery(shortlist=50).fit(walks)
        >>> keys = gallery.add(walks)
        >>> gallery.nearest(walks[7])[0].tolist()
        [7]
        >>> gallery.remove([7])
        >>> len(gallery), gallery.nearest(walks[7])[0].tolist() == [7]
        (299, False)
    """

    def __init__(
        self,
        shortlist: int = 1500,
        band: int | None = 3,
        cost: Cost = "euclidean",
        directions: int = 32,
        smooth: float = 0.125,
    ) -> None:
        if shortlist < 1 or directions < 1:
            raise InputError(
                f"Gallery.shortlist and directions must be 1 or more, but got {shortlist} and {directions}."
            )
        if not smooth >= 0:
            raise InputError(f"Gallery.smooth must be 0 or more, but got {smooth}.")
        self._squared, self._width = is_squared(cost), width_of(band)
        self.shortlist, self.band, self.cost = shortlist, band, cost
        self.directions, self.smooth = directions, smooth
        self._index: Any = None
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def fit(self, sequences: Sequence[Float[np.ndarray, "frames features"]] | np.ndarray) -> Self:
        """Learn the vectors' directions from sequences like those to be enrolled, and empty the gallery.

        Args:
            sequences: All of one length; a few thousand suffice, of more a part is looked at.

        Raises:
            InputError: If there are none, or their lengths or features differ.
            MissingExtraError: If usearch is not installed.
        """
        some = sequences[:: max(1, len(sequences) // _LEARN_FROM)]
        values = self._stacked(some, None)
        smoothed = self._smoothed(values)
        self._mean = smoothed.mean(axis=0)
        _, _, rows = np.linalg.svd(smoothed - self._mean, full_matrices=False)
        self._basis = np.ascontiguousarray(rows[: self.directions].T)
        self._index = self._empty_index(self._basis.shape[1])
        self._store = np.empty((0, *values.shape[1:]), dtype=_DTYPE)
        self._here = np.empty(0, dtype=bool)
        self._next = self._count = 0
        return self

    def add(self, sequences: Sequence[Float[np.ndarray, "frames features"]] | np.ndarray) -> np.ndarray:
        """Enrol sequences and return their keys: whole numbers that count up and are never given twice.

        Raises:
            NotFittedError: Before ``fit``.
            InputError: If a sequence has another length or other features than those of ``fit``, or a NaN.
        """
        self._check_fitted()
        values = self._stacked(sequences, self._store.shape[1:])
        keys = np.arange(self._next, self._next + len(values))
        self._grow(self._next + len(values))
        self._store[keys] = values
        self._index.add(keys.astype(np.uint64), self._vectors(values), threads=1)
        self._here[keys] = True
        self._next += len(values)
        self._count += len(values)
        return keys

    def remove(self, keys: Sequence[int] | Int[np.ndarray, " keys"]) -> None:
        """Take sequences out. Their memory is not given back before the next ``fit``.

        Raises:
            NotFittedError: Before ``fit``.
            InputError: If one is not there; then none is taken out.
        """
        self._check_fitted()
        unique = np.unique(np.asarray(keys, dtype=np.int64))
        known = (unique >= 0) & (unique < self._next)
        known[known] = self._here[unique[known]]
        if not known.all():
            raise InputError(f"The gallery holds no sequence of key {int(unique[np.argmin(known)])}.")
        for key in unique:
            self._index.remove(int(key))
        self._here[unique] = False
        self._count -= len(unique)

    def nearest(
        self, query: Float[np.ndarray, "frames features"], k: int = 1
    ) -> tuple[Int[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Return the keys of the k nearest on the shortlist, nearest first, and their DTW distances.

        Args:
            query: One row a frame; it may have another length than the gallery's.
            k: How many; fewer come back from a shorter list.

        Raises:
            NotFittedError: Before ``fit``.
            InputError: If the query has other features, no frame or a NaN, or k is less than 1.
        """
        if len(self) <= self.shortlist:
            return self.exact(query, k)
        padded = self._padded(query, k)
        vector = self._vectors(_even(padded[:-1], self._store.shape[1])[None])[0]
        keys = self._index.search(vector, self.shortlist, threads=1).keys.astype(np.int64)
        return self._best(padded, keys[self._here[keys]], k)

    def exact(
        self, query: Float[np.ndarray, "frames features"], k: int = 1
    ) -> tuple[Int[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Return what :meth:`nearest` would with all on the shortlist, in a time that grows with them."""
        self._check_fitted()
        padded = self._padded(query, k)
        keys, distances = np.empty(0, dtype=np.int64), np.empty(0)
        for start in range(0, self._next, _CHUNK):
            here = start + np.flatnonzero(self._here[start : min(start + _CHUNK, self._next)])
            some, theirs = self._best(padded, here, k)
            keys, distances = np.append(keys, some), np.append(distances, theirs)
        first = np.argsort(distances, kind="stable")[:k]
        return keys[first], distances[first]

    def _best(
        self, padded: np.ndarray, keys: Int[np.ndarray, " keys"], k: int
    ) -> tuple[Int[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Compare by DTW."""
        if len(keys) == 0:
            return keys, np.empty(0)
        chosen = np.append(keys, np.repeat(keys[-1:], -len(keys) % lanes_of(_DTYPE)))
        ends = np.empty(len(chosen), dtype=_DTYPE)
        warp_chosen(padded, self._store, chosen, self._width, self._squared, ends)
        first = np.argsort(ends[: len(keys)], kind="stable")[:k]
        return keys[first], ends[first].astype(np.float64)

    def _padded(self, query: np.ndarray, k: int) -> Float[np.ndarray, "frames+1 features"]:
        self._check_fitted()
        if k < 1:
            raise InputError(f"k must be 1 or more, but got {k}.")
        features = self._store.shape[2]
        if np.ndim(query) != 2 or query.shape[1] != features or len(query) == 0:
            raise InputError(f"The query must have shape (frames, {features}), but got {np.shape(query)}.")
        padded = np.zeros((len(query) + 1, features), dtype=_DTYPE)
        padded[:-1] = query
        if not np.isfinite(padded).all():
            raise InputError("The query holds NaN or infinity; fill or drop such frames.")
        return padded

    def _vectors(
        self, values: Float[np.ndarray, "sequences frames features"]
    ) -> Float[np.ndarray, "sequences directions"]:
        return np.asarray((self._smoothed(values) - self._mean) @ self._basis, dtype=_DTYPE)

    def _smoothed(
        self, values: Float[np.ndarray, "sequences frames features"]
    ) -> Float[np.ndarray, "sequences numbers"]:
        sigma = self.smooth * values.shape[1]
        smoothed = gaussian_filter1d(values, sigma, axis=1, mode="nearest") if sigma > 0 else values
        return np.asarray(smoothed).reshape(len(values), -1)

    def _stacked(
        self, sequences: Sequence[np.ndarray] | np.ndarray, shape: tuple[int, ...] | None
    ) -> Float[np.ndarray, "sequences frames features"]:
        """Check sequences and join them."""
        if isinstance(sequences, np.ndarray) and sequences.ndim == 3 and len(sequences):
            lengths = [sequences.shape[1]]
            if not np.isfinite(sequences).all():
                check_sequences(list(sequences))  # names the one
        else:
            check_sequences(list(sequences))
            lengths = sorted({len(s) for s in sequences})
        shape = shape or (lengths[0], np.shape(sequences[0])[1])
        if lengths != [shape[0]] or np.shape(sequences[0])[1] != shape[1]:
            raise InputError(
                f"A gallery's sequences must all have shape {tuple(shape)}, but got lengths "
                f"{lengths[0]} to {lengths[-1]} and {np.shape(sequences[0])[1]} features. Resample the clips."
            )
        return np.asarray(sequences, dtype=_DTYPE)

    def _grow(self, count: int) -> None:
        """Make room; half as much again, so that adding one by one stays cheap."""
        if count > len(self._store):
            room = max(count, len(self._store) * 3 // 2)
            store = np.empty((room, *self._store.shape[1:]), dtype=_DTYPE)
            store[: self._next] = self._store[: self._next]
            here = np.zeros(room, dtype=bool)
            here[: self._next] = self._here[: self._next]
            self._store, self._here = store, here

    def _empty_index(self, directions: int) -> Any:
        try:
            from usearch.index import Index
        except ImportError as error:
            raise MissingExtraError(
                "A Gallery needs usearch, which is not installed. Install it with: "
                "pip install 'wigwag[benchmark]'"
            ) from error
        return Index(
            ndim=directions,
            metric="l2sq",
            dtype="f16",
            connectivity=_CONNECTIVITY,
            expansion_add=_EXPANSION_ADD,
            expansion_search=self.shortlist,
        )

    def _check_fitted(self) -> None:
        if self._index is None:
            raise NotFittedError("This Gallery has not been fitted. Call fit with sequences first.")


def _even(
    sequence: Float[np.ndarray, "frames features"], frames: int
) -> Float[np.ndarray, "frames features"]:
    """Resample linearly to so many frames."""
    if len(sequence) == frames:
        return sequence
    at = np.linspace(0, len(sequence) - 1, frames)
    before = np.minimum(at.astype(np.int64), max(len(sequence) - 2, 0))
    after = np.minimum(before + 1, len(sequence) - 1)
    weight = (at - before)[:, None].astype(sequence.dtype)
    return np.asarray(sequence[before] + weight * (sequence[after] - sequence[before]))
