"""Gusts: wind that wanders about a mean, handed to RotorPy through its wind interface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True)
class WindConfig:
    """How the wind blows."""

    gust_m_s: float = 2.0
    """Root mean square of the gusts' horizontal speed; a tenth of it blows up and down."""
    mean_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Steady wind, world frame ENU."""
    gust_time_s: float = 1.5
    """How long a gust lasts: the time in which it forgets all but 1/e of itself."""


class Gusts:
    """An Ornstein-Uhlenbeck process, exact for any step, with RotorPy's ``update(t, position)``.

    RotorPy's own Dryden model needs PyTorch at import.
    """

    def __init__(self, config: WindConfig, seed: int) -> None:
        self._config = config
        self._rng = np.random.default_rng([seed, 0x417D])
        self._deviation = config.gust_m_s * np.array([np.sqrt(0.5), np.sqrt(0.5), 0.1])
        self._gust = self._deviation * self._rng.standard_normal(3)
        self._time_s = 0.0

    def update(self, t: float, position: Float[np.ndarray, 3]) -> Float[np.ndarray, 3]:
        """Wind at time ``t`` seconds, m/s, world frame; time runs forward, place does not matter."""
        kept = np.exp(-(t - self._time_s) / self._config.gust_time_s)
        fresh = np.sqrt(1.0 - kept * kept)
        self._gust = kept * self._gust + fresh * self._deviation * self._rng.standard_normal(3)
        self._time_s = t
        return np.asarray(self._gust + self._config.mean_m_s)
