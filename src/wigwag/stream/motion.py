"""When a body moves, relative to how still this person keeps; and where movements may have begun."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.stream.ticks import RATE_HZ

_ACROSS = np.array([1.0, 0.0, 1.0])
_DIP = round(0.2 * RATE_HZ)
_AROUND = round(0.4 * RATE_HZ)
_CLIMB = 5
_SLIGHT = 0.2
"""What is slower than this share of the fastest that follows is no part of it; see
:class:`~wigwag.features.canonical.CanonicalForm`."""


@dataclass(frozen=True, slots=True)
class MotionConfig:
    """When a body counts as moving, and which moments may be the beginning of a gesture."""

    smoothing_s: float = 0.10
    """Time constant of the low-pass filter on landmarks before they are differentiated."""
    fastest: int = 4
    """How many landmarks speak: the mean speed of this many, the fastest of the moment."""
    on_m_s: tuple[float, float] = (0.28, 0.6)
    """A movement begins above this speed: least and greatest, in between by the person's rest level."""
    above_rest_m_s: float = 0.22
    """It is this much ..."""
    above_rest: float = 1.6
    """... above so many times the rest level."""
    off: float = 0.75
    """Slower than this share of that speed is a lull."""
    hang_s: float = 0.25
    """A lull this long is rest: a movement is over, or a posture is held."""
    dip: float = 0.8
    """A moment at which the landmarks are slower than this share of their speed just before and after may
    be a beginning too, however fast they are: so walking is told from the gesture that follows it."""
    fill_s: float = 0.8
    """While none is found for this long, one is assumed."""
    longest_s: float = 5.0
    """No gesture is longer."""
    most: int = 6
    """At most so many beginnings are kept in mind; the least still moment is forgotten first."""
    postures: bool = False
    """Whether a posture that is held may be a gesture by itself, whatever movement led into it."""
    lag_s: float = 0.2
    """How long before it is noticed a movement began."""
    falls_s: float = 0.5
    """Time constant with which the rest level follows a person who keeps stiller than thought ..."""
    rises_s: float = 60.0
    """... and one who never keeps as still."""
    level_m_s: float = 0.10
    """The rest level before anything is known."""


@dataclass(frozen=True, slots=True)
class Onset:
    """A moment at which a gesture may have begun."""

    row: int
    still_m_s: float
    """How slow the body was there."""


class Motion:
    """Follows one person's movement row by row.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: MotionConfig | None = None) -> None:
        self.config = config or MotionConfig()
        self.forget()

    def reset(self) -> None:
        """Forget everything but the person's rest level, as after a hole in the stream."""
        self.resting = True
        """Whether the body has been still for ``hang_s``."""
        self.lull_row = -1
        """The newest moment that may be the end of something: a beginning of rest, or a dip."""
        self.onsets: list[Onset] = []
        """Where what goes on now may have begun, oldest first."""
        self.activity_m_s = 0.0
        """Mean speed of the fastest landmarks relative to the hips, just now."""
        self.row = -1
        self._recent: deque[float] = deque(maxlen=_DIP + _AROUND + 1)
        self._history: deque[float] = deque(maxlen=round((self.config.longest_s + 1) * RATE_HZ))
        self._smooth: Float[np.ndarray, "13 3"] | None = None
        self._quiet_row: int | None = None

    def forget(self) -> None:
        """Forget the person too."""
        self._level = self.config.level_m_s
        self._known_s = 0.0
        self.reset()

    @property
    def on_m_s(self) -> float:
        """Above this speed this person moves."""
        low, high = self.config.on_m_s
        raised = self.config.above_rest_m_s + self.config.above_rest * self._level
        return min(max(raised, low), high)

    def peak_m_s(self, since: int) -> float:
        """Return the greatest activity since a row."""
        count = min(self.row - since + 1, len(self._history))
        return max(self._history[-i] for i in range(1, count + 1)) if count > 0 else 0.0

    def moving_since(self, row: int) -> int:
        """Return where movement begins at or after a row: a stretch may begin with rest, or with little."""
        history = list(self._history)[-(self.row - row + 1) :]
        first = self.row - len(history) + 1
        slow = max(self.config.off * self.on_m_s, _SLIGHT * max(history))
        fast = next((i for i, speed in enumerate(history) if speed >= slow), 0)
        return max(first + fast - _CLIMB, row)

    def update(self, joints: Float[np.ndarray, "13 3"]) -> None:
        """Take in the next row."""
        self.row += 1
        self._measure(joints)
        self._recent.append(self.activity_m_s)
        self._history.append(self.activity_m_s)
        if self.row > _DIP:  # the filter has settled
            slower = self.activity_m_s < self._level
            # In the first seconds it follows either way.
            rises_s = min(max(self._known_s, self.config.falls_s), self.config.rises_s)
            time_s = self.config.falls_s if slower else rises_s
            self._known_s += 1 / RATE_HZ
            self._level += (self.activity_m_s - self._level) / (time_s * RATE_HZ)
        if self.resting:
            self._begin()
        else:
            self._go_on()
        oldest = self.row - self.config.longest_s * RATE_HZ
        self.onsets = [onset for onset in self.onsets if onset.row >= oldest]

    def _measure(self, joints: np.ndarray) -> None:
        # Sideways and in depth the hips are the origin; in height they move too when a person sits or squats.
        relative = joints - (joints[7] + joints[8]) / 2 * _ACROSS
        if self._smooth is None:
            self._smooth = relative
            return
        step = (1.0 - np.exp(-1.0 / (RATE_HZ * self.config.smoothing_s))) * (relative - self._smooth)
        self._smooth = self._smooth + step
        speeds = np.sqrt(np.einsum("ij,ij->i", step, step)) * RATE_HZ
        self.activity_m_s = float(np.sort(speeds)[-self.config.fastest :].mean())

    def _begin(self) -> None:
        if self.activity_m_s > self.on_m_s:
            self.resting, self._quiet_row = False, None
            self._add(max(self.row - round(self.config.lag_s * RATE_HZ), 0))

    def _go_on(self) -> None:
        if self.activity_m_s < self.config.off * self.on_m_s:
            if self._quiet_row is None:
                self._quiet_row = self.row
            if self.row - self._quiet_row >= self.config.hang_s * RATE_HZ:
                self.resting, self.lull_row = True, self.row
                if self.config.postures:
                    self._add(self._quiet_row)
                return
        else:
            self._quiet_row = None
        dip = self._dip()
        newest = self.onsets[-1].row if self.onsets else -1
        if dip is not None and dip - newest >= 8:
            self._add(dip)
            self.lull_row = self.row
        elif self.row - newest > self.config.fill_s * RATE_HZ + _DIP:
            self._add(self.row - _DIP)

    def _dip(self) -> int | None:
        """Find a local minimum of activity 0.2 s ago that lies well below what is around it."""
        recent = list(self._recent)
        if len(recent) < _DIP + 7:
            return None
        at = len(recent) - 1 - _DIP
        least = min(range(at - 2, at + 4), key=recent.__getitem__)
        before, after = max(recent[:least]), max(recent[least + 1 :])
        if recent[least] > self.config.dip * min(before, after):
            return None
        return self.row - (len(recent) - 1 - least)

    def _add(self, row: int) -> None:
        back = self.row - row
        around = list(self._history)[-back - 4 : len(self._history) - max(back - 3, 0)]
        self.onsets.append(Onset(row, min(around)))
        if len(self.onsets) > self.config.most:
            # Never one of the two newest: of those it is not known yet.
            self.onsets.remove(max(self.onsets[:-2], key=lambda onset: onset.still_m_s))
