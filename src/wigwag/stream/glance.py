"""What a body seems to show at this moment, whenever it may have begun: the second view of a stream."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

from wigwag.stream.network import Network
from wigwag.stream.ticks import Ticks
from wigwag.stream.track import Tail, Track

LASTS = 8
"""Rows over which the probabilities of single rows are averaged: a quarter of a second."""

WEIGHT = 0.2
"""What the logarithm of a mean probability counts for beside a score of similarities."""

_LEAST = 1e-4
"""No probability is believed to be lower."""

Glimpse = Float[np.ndarray, "2 classes"]
"""Probabilities of each gesture and, last, of nothing: of the newest row; and the mean of the last ``LASTS``
rows."""

GLANCE_SIGNS = ("odds now", "lead now", "usual of late", "nothing of late", "lead of both")
"""What a glimpse adds to the signs of a look; see :func:`signs_of`."""


@dataclass(frozen=True, slots=True)
class Glance:
    """A network that says of single rows which gesture goes on there.

    Similarities know how a stretch goes, if it began where a gesture did; this knows the last two seconds,
    and not what began. They err differently.
    """

    network: Network

    def of_track(self, track: Track) -> Float[np.ndarray, "rows 2 classes"]:
        """Return the glimpse at every row of a track."""
        rows = np.arange(len(track.joints))
        every = np.concatenate([
            self.network.probabilities(track.looks(part))
            for part in np.array_split(rows, max(len(rows) // 4096, 1))
        ])  # fmt: skip
        sums = np.cumsum(np.vstack([np.zeros_like(every[:1]), every]), axis=0, dtype=np.float64)
        begins = np.maximum(rows + 1 - LASTS, track.first)
        means = (sums[rows + 1] - sums[begins]) / (rows + 1 - begins)[:, None]
        return np.stack([every, means], axis=1)

    def arrays(self) -> dict[str, np.ndarray]:
        """Return everything."""
        return self.network.arrays("glance")

    @classmethod
    def restored(cls, arrays: dict[str, np.ndarray]) -> Self | None:
        """Take back what ``arrays`` gave; ``None``: there was none."""
        return cls(Network.restored(arrays, "glance")) if "glance_center" in arrays else None


class Glances:
    """Follows a stream as it comes.

    Args:
        glance: What was taught.
    """

    def __init__(self, glance: Glance) -> None:
        self.glance = glance
        self._tail = Tail()
        self._rows: deque[Float[np.ndarray, " classes"]] = deque(maxlen=LASTS)
        self._restarts = 0

    def reset(self) -> None:
        """Forget the stream."""
        self._tail.reset()
        self._rows.clear()
        self._restarts = 0

    def update(self, ticks: Ticks) -> Glimpse | None:
        """Take in the rows that are new; ``None``: there is none yet."""
        if ticks.restarts != self._restarts:
            self.reset()
            self._restarts = ticks.restarts
        for row in range(self._tail.count, ticks.count):
            self._tail.update(ticks.window(row, row)[0])
            if row >= ticks.count - LASTS:
                self._rows.append(self.glance.network.probabilities(self._tail.look())[0])
        if not self._rows:
            return None
        return np.stack([self._rows[-1], np.mean(self._rows, axis=0)])


def scores_of(glimpse: Glimpse) -> Float[np.ndarray, " classes"]:
    """Return what the last moments give to the score of each gesture."""
    return np.asarray(WEIGHT * _log(glimpse[1, :-1]))


def signs_of(glimpse: Glimpse, decided: int, together: Float[np.ndarray, " classes"]) -> list[float]:
    """Return what the last moments say of a decision.

    Its log odds against nothing in the newest row, and against the likeliest other gesture; the logarithm of
    its mean probability of late, and that of nothing; and its lead in the scores of both views together.
    """
    now, late = _log(glimpse)
    other = np.delete(now[:-1], decided).max(initial=float(np.log(_LEAST)))
    second = np.delete(together, decided).max(initial=together[decided] - 1.0)
    return [
        float(now[decided] - now[-1]),
        float(now[decided] - other),
        float(late[decided]),
        float(late[-1]),
        float(min(together[decided] - second, 3.0)),
    ]


def _log(probabilities: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    return np.asarray(np.log(np.maximum(probabilities, _LEAST)), dtype=np.float64)


__all__ = ["GLANCE_SIGNS", "LASTS", "Glance", "Glances", "Glimpse", "scores_of", "signs_of"]
