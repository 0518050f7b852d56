"""A velocity that changes smoothly: limits on acceleration and jerk."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float


class Smoother:
    """Follows a wanted velocity with bounded acceleration and jerk, without overshooting it.

    Args:
        max_acceleration_m_s2: Bound on the size of the acceleration.
        max_jerk_m_s3: Bound on the size of its change.

    Example:
        >>> float(Smoother(1.0, 10.0)(np.array([5.0, 0.0, 0.0]), 0.1)[0])
        0.1
    """

    def __init__(self, max_acceleration_m_s2: float, max_jerk_m_s3: float) -> None:
        self.max_acceleration_m_s2, self.max_jerk_m_s3 = max_acceleration_m_s2, max_jerk_m_s3
        self.reset()

    def reset(self) -> None:
        """Begin anew, from standing."""
        self._velocity: Float[np.ndarray, " 3"] = np.zeros(3)
        self._acceleration: Float[np.ndarray, " 3"] = np.zeros(3)

    def __call__(self, wanted: Float[np.ndarray, " 3"], step_s: float) -> Float[np.ndarray, " 3"]:
        """Return the velocity ``step_s`` seconds after the last one."""
        if step_s <= 0:
            return self._velocity
        change = wanted - self._velocity
        size = math.sqrt(float(change @ change))
        if size < 1e-9:
            pull = np.zeros(3)
        else:
            # No faster than what can still be let go of in time: v = a^2 / 2 j.
            most = min(self.max_acceleration_m_s2, math.sqrt(2 * self.max_jerk_m_s3 * size), size / step_s)
            pull = change * (most / size)
        jerk = pull - self._acceleration
        size, allowed = math.sqrt(float(jerk @ jerk)), self.max_jerk_m_s3 * step_s
        if size > allowed:
            jerk = jerk * (allowed / size)
        self._acceleration = self._acceleration + jerk
        self._velocity = self._velocity + self._acceleration * step_s
        return self._velocity
