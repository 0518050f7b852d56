"""Dynamic time warping between sequences of vectors, with Euclidean local cost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from wigwag.distances.packed import Cost, PackedSequences, is_squared, width_of
from wigwag.distances.pair import warp_pair, warp_squares
from wigwag.errors import InputError


def dtw(
    a: Float[np.ndarray, "frames_a features"],
    b: Float[np.ndarray, "frames_b features"],
    band: int | None = None,
    cost: Cost = "euclidean",
) -> float:
    """Dynamic time warping distance between two sequences (paper, section 4).

    The least sum of distances between aligned frames over all paths that start at both first
    frames, end at both last ones, and step forward in one sequence or in both. All features are warped
    together ('dependent' DTW).

    Args:
        a: One sequence, one row a frame.
        b: The other; it may have another length, but has the same features.
        band: Sakoe-Chiba band: frames ``i`` and ``j`` are aligned only if ``|i - j| <= band``. It is
            widened to the difference of the lengths where it must be. ``None``: no limit.
        cost: Distance between two frames: ``"euclidean"`` (paper), or ``"squared"``, its square, which
            many libraries take; some of them return the square root of the sum.

    Raises:
        InputError: If an array is not 2-D, is empty, or the features do not match.

    Example:
        >>> import numpy as np
        >>> dtw(np.array([[0.0], [1.0], [2.0]]), np.array([[0.0], [2.0]]))
        1.0
    """
    first, second = _sequence(a, "a"), _sequence(b, "b")
    if first.shape[1] != second.shape[1]:
        raise InputError(
            f"dtw needs sequences of the same features, but got {first.shape[1]} and {second.shape[1]}."
        )
    return float(warp_pair(first, second, width_of(band), is_squared(cost)))


def dtw_pairwise(
    a: Sequence[Float[np.ndarray, "frames_a features"]],
    b: Sequence[Float[np.ndarray, "frames_b features"]] | None = None,
    band: int | None = None,
    cost: Cost = "euclidean",
) -> Float[np.ndarray, "sequences_a sequences_b"]:
    """Dynamic time warping distances between each sequence of one list and each of another.

    Computed for many sequences at a time, in the floating point type of the second list (see
    :class:`wigwag.distances.PackedSequences`).

    Args:
        a: Sequences of any lengths.
        b: Others; ``None``: ``a`` against itself.
        band: As in :func:`dtw`.
        cost: As in :func:`dtw`.

    Raises:
        InputError: If a list is empty, or the features do not match.
    """
    packed = PackedSequences(a if b is None else b)
    return np.stack([packed.distances(sequence, band, cost) for sequence in a])


def _sequence(values: np.ndarray, name: str) -> np.ndarray:
    array = np.ascontiguousarray(values)
    if array.ndim != 2 or len(array) == 0:
        raise InputError(f"dtw: {name} must have shape (frames, features), but got {np.shape(values)}.")
    return array if array.dtype in (np.float32, np.float64) else array.astype(np.float64)


def dtw_by_product(
    a: Float[np.ndarray, "frames_a features"],
    b: Float[np.ndarray, "frames_b features"],
    band: int | None = None,
    cost: Cost = "euclidean",
) -> float:
    """DTW through one matrix product: the fast way for one pair of many features.

    The arrays should be about a common mean: squared distances come from |a|^2 + |b|^2 - 2 a.b, so their
    absolute error is the rounding of |a|^2 + |b|^2.
    """
    squares = a @ b.T
    squares *= -2
    squares += np.einsum("tf,tf->t", a, a)[:, None]
    squares += np.einsum("tf,tf->t", b, b)
    return float(warp_squares(squares, width_of(band), is_squared(cost)))
