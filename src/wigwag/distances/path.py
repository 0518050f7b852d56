"""Which frame of one sequence dynamic time warping lays on which of another."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from wigwag.distances.packed import width_of
from wigwag.errors import InputError


def dtw_path(
    a: Float[np.ndarray, "frames_a features"],
    b: Float[np.ndarray, "frames_b features"],
    band: int | None = None,
) -> tuple[float, Int[np.ndarray, "steps 2"]]:
    """Return the DTW distance of two sequences, and the path that has it; to be looked at, so not fast.

    Args:
        a: One sequence, one row a frame.
        b: The other.
        band: As in :func:`~wigwag.distances.dtw.dtw`.

    Returns:
        The distance, and a row of two frame numbers a step, from the first frames to the last.

    Raises:
        InputError: If an array is not 2-D, is empty, or the features do not match.

    Example:
        >>> import numpy as np
        >>> dtw_path(np.array([[0.0], [1.0], [2.0]]), np.array([[0.0], [2.0]]))[1].tolist()
        [[0, 0], [1, 0], [2, 1]]
    """
    if np.ndim(a) != 2 or np.ndim(b) != 2 or not len(a) or not len(b) or a.shape[1] != b.shape[1]:
        raise InputError(
            "dtw_path needs two arrays of shape (frames, features) with the same features, but got "
            f"{np.shape(a)} and {np.shape(b)}."
        )
    cost = np.linalg.norm(np.asarray(a, float)[:, None] - np.asarray(b, float)[None], axis=2)
    width = max(width_of(band), abs(len(a) - len(b)))
    total = np.full((len(a) + 1, len(b) + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(len(a)):
        for j in range(max(i - width, 0), min(i + width + 1, len(b))):
            total[i + 1, j + 1] = cost[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    at, steps = (len(a), len(b)), [(len(a) - 1, len(b) - 1)]
    while at != (1, 1):
        i, j = at
        at = min(((i - 1, j - 1), (i - 1, j), (i, j - 1)), key=lambda before: float(total[before]))
        steps.append((at[0] - 1, at[1] - 1))
    return float(total[-1, -1]), np.array(steps[::-1])


__all__ = ["dtw_path"]
