"""The compiled recurrence of dynamic time warping for one pair of sequences."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, fastmath=True)
def warp_pair(a, b, band, squared):  # type: ignore[no-untyped-def]
    """Return the DTW distance of one pair, in float64."""
    n, m = len(a), len(b)
    width = max(band, abs(n - m))
    before = np.full(m + 1, 1e300)
    row = np.empty(m + 1)
    before[0] = 0.0
    for i in range(n):
        row[:] = 1e300
        for j in range(max(0, i - width), min(m, i + width + 1)):
            square = 0.0
            for f in range(a.shape[1]):
                step = a[i, f] - b[j, f]
                square += step * step
            cost = square if squared else np.sqrt(square)
            row[j + 1] = cost + min(before[j], before[j + 1], row[j])  # eq. DTW
        before, row = row, before
    return before[m]


@njit(cache=True, fastmath=True)
def warp_squares(squares, band, squared):  # type: ignore[no-untyped-def]
    """Return the DTW distance of one pair whose squared local costs are known."""
    n, m = squares.shape
    width = max(band, abs(n - m))
    before = np.full(m + 1, 1e300)
    row = np.empty(m + 1)
    before[0] = 0.0
    for i in range(n):
        row[:] = 1e300
        for j in range(max(0, i - width), min(m, i + width + 1)):
            square = max(squares[i, j], 0.0)
            cost = square if squared else np.sqrt(square)
            row[j + 1] = cost + min(before[j], before[j + 1], row[j])
        before, row = row, before
    return before[m]
