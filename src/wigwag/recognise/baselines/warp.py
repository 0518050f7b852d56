"""Dynamic time warping as the baselines define it: joint by joint, or all together with weights."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from numba import njit

from wigwag.errors import InputError

_LANES = 16
"""Groups warped together."""


def dtw_each(
    a: Float[np.ndarray, "frames_a coordinates groups"], b: Float[np.ndarray, "frames_b coordinates groups"]
) -> Float[np.ndarray, " groups"]:
    """Warp each group of coordinates by itself ('independent' DTW), Euclidean local cost.

    Args:
        a: One sequence; a group is a joint, or a single coordinate.
        b: The other, of the same coordinates and groups.

    Returns:
        One DTW distance a group.

    Raises:
        InputError: If an array is not 3-D, is empty, or coordinates or groups do not match.
    """
    _same(a, b)
    return np.asarray(_each(_padded(a), _padded(b))[: a.shape[2]])


def dtw_weighted(
    a: Float[np.ndarray, "frames_a coordinates groups"],
    b: Float[np.ndarray, "frames_b coordinates groups"],
    weights: Float[np.ndarray, " groups"],
) -> float:
    """Warp all groups together; the local cost is the weighted sum of the groups' Euclidean distances.

    Args:
        a: One sequence; a group is a joint.
        b: The other, of the same coordinates and groups.
        weights: One a group, 0 or more.

    Raises:
        InputError: If an array is not 3-D, is empty, or coordinates, groups or weights do not match.
    """
    _same(a, b)
    if np.shape(weights) != (a.shape[2],):
        raise InputError(f"dtw_weighted needs {a.shape[2]} weights, but got {np.shape(weights)}.")
    kind = np.result_type(a, b)
    return float(_weighted(np.ascontiguousarray(a), np.ascontiguousarray(b), np.asarray(weights, kind)))


def _same(a: np.ndarray, b: np.ndarray) -> None:
    if np.ndim(a) != 3 or np.ndim(b) != 3 or a.shape[1:] != b.shape[1:] or 0 in (*a.shape, *b.shape):
        raise InputError(
            "Sequences must have shape (frames, coordinates, groups), alike but for the frames, "
            f"but got {np.shape(a)} and {np.shape(b)}."
        )


def _padded(a: np.ndarray) -> np.ndarray:
    """Add groups of zeros up to a multiple of the lanes."""
    groups = a.shape[2]
    result = np.zeros((*a.shape[:2], groups + -groups % _LANES), a.dtype)
    result[:, :, :groups] = a
    return result


@njit(cache=True, fastmath=True)
def _each(a, b):  # type: ignore[no-untyped-def]  # compiled: numba infers the types
    """16 groups stand side by side, so that every step is taken for all of them at once.

    That number is a constant, not a parameter: only then do the loops become vector instructions.
    """
    n, coordinates, lanes = a.shape
    m = b.shape[0]
    far, zero = a.dtype.type(1e30), a.dtype.type(0)
    result = np.empty(lanes, a.dtype)
    before = np.empty((m + 1, _LANES), a.dtype)
    row = np.empty((m + 1, _LANES), a.dtype)
    squares = np.empty(_LANES, a.dtype)
    for first in range(0, lanes, _LANES):
        before[:] = far
        before[0] = zero
        for i in range(n):
            row[0] = far
            for j in range(m):
                for g in range(_LANES):
                    squares[g] = zero
                for c in range(coordinates):
                    for g in range(_LANES):
                        step = a[i, c, first + g] - b[j, c, first + g]
                        squares[g] += step * step
                for g in range(_LANES):
                    best = min(before[j, g], before[j + 1, g], row[j, g])
                    row[j + 1, g] = np.sqrt(squares[g]) + best  # eq. DTW
            before, row = row, before
        result[first : first + _LANES] = before[m]
    return result


@njit(cache=True, fastmath=True)
def _weighted(a, b, weights):  # type: ignore[no-untyped-def]  # compiled
    """Local costs of a row come first, side by side along ``b``; the recurrence follows."""
    n, coordinates, groups = a.shape
    m = b.shape[0]
    far, zero = a.dtype.type(1e30), a.dtype.type(0)
    before = np.full(m + 1, far, a.dtype)
    row = np.full(m + 1, far, a.dtype)
    turned = np.ascontiguousarray(b.transpose(2, 1, 0))
    squares = np.empty(m, a.dtype)
    costs = np.empty(m, a.dtype)
    before[0] = zero
    for i in range(n):
        costs[:] = zero
        for g in range(groups):
            squares[:] = zero
            for c in range(coordinates):
                at = a[i, c, g]
                other = turned[g, c]
                for j in range(m):
                    squares[j] += (at - other[j]) * (at - other[j])
            for j in range(m):
                costs[j] += weights[g] * np.sqrt(squares[j])  # eq. weighted distance
        for j in range(m):
            row[j + 1] = costs[j] + min(before[j], before[j + 1], row[j])  # eq. DTW
        before, row = row, before
        row[0] = far
        before[0] = far
    return before[m]


__all__ = ["dtw_each", "dtw_weighted"]
