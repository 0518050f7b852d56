"""A body as it looks from its own side, row by row: hips as origin, torso as unit, turned to the front."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from wigwag.stream.ticks import RATE_HZ

LANDMARKS = 13
_TURNS_ROWS = 30
_GROWS_ROWS = 90
"""Over how many rows the direction a person faces, and their size, are averaged."""
_SMOOTH = 3
_HIP_STEP = 3
_LEAST_M = 0.1
"""No torso is shorter: one that seems to be is not seen."""


class Postures:
    """Follows one person: each row is said in their own frame.

    Directions: x to the person's left, y down, z from the camera into the person. Size and direction are
    running means, so that nothing jumps, and nothing that comes later is needed.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the person."""
        self._count = 0
        self._size_m = 1.0
        self._side = np.array([1.0, 0.0])
        self._raw: list[Float[np.ndarray, "13 3"]] = []
        self._hips: list[Float[np.ndarray, " 3"]] = []

    def update(
        self, joints: Float[np.ndarray, "13 3"]
    ) -> tuple[Float[np.ndarray, "13 3"], Float[np.ndarray, " 3"]]:
        """Take in a row.

        Args:
            joints: Metres, camera optical frame.

        Returns:
            The landmarks in torso lengths from the hips, the mean of the last three rows; and how fast the
            hips move, torso lengths a second.
        """
        hips, shoulders = (joints[7] + joints[8]) / 2, (joints[1] + joints[2]) / 2
        side = (joints[1] - joints[2]) + (joints[7] - joints[8])
        torso_m = max(float(np.linalg.norm(hips - shoulders)), _LEAST_M)
        self._count += 1
        if self._count == 1:
            self._size_m, self._side = torso_m, side[[0, 2]]
        self._size_m += (torso_m - self._size_m) * max(1 / _GROWS_ROWS, 1 / self._count)
        self._side = self._side + (side[[0, 2]] - self._side) * max(1 / _TURNS_ROWS, 1 / self._count)
        across, away = self._side / max(float(np.hypot(*self._side)), 1e-6)
        turn = np.array([[across, 0.0, -away], [0.0, 1.0, 0.0], [away, 0.0, across]])
        self._raw = [*self._raw[1 - _SMOOTH :], (joints - hips) / self._size_m @ turn]
        self._hips = [*self._hips[-_HIP_STEP:], hips]
        step = (hips - self._hips[0]) * (RATE_HZ / _HIP_STEP if len(self._hips) > _HIP_STEP else 0.0)
        return np.mean(self._raw, axis=0), step / self._size_m @ turn
