"""Which stretches of a stream are looked at: overlapping hypotheses, one at a time, at a bounded cost."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from wigwag.skeleton import Clip, Pose
from wigwag.stream.motion import Motion, MotionConfig
from wigwag.stream.ticks import RATE_HZ, TickConfig, Ticks

_MARGIN = 3
_SHORTEST = 10
_AGAIN = 4
_JUST = 6


@dataclass(frozen=True, slots=True)
class WatchConfig:
    """How a stream is watched."""

    ticks: TickConfig = field(default_factory=TickConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    hold_s: float = 0.6
    """A posture is looked at for this long after the movement into it."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A stretch from a possible beginning until now: a whole gesture, the first part of one, or none."""

    onset_ns: int
    now_ns: int
    length_s: float
    activity_m_s: float
    """Now."""
    peak_m_s: float
    """The greatest since the beginning."""
    still_m_s: float
    """How slow the body was at the beginning."""
    resting: bool
    """The body is still now."""
    lull: bool
    """A lull ended just now, or the body came to rest."""
    rows: tuple[int, int]
    """First and last of the watcher's rows, with a tenth of a second before the beginning."""


class Watcher:
    """Turns poses into hypotheses, at most one a pose.

    While the body moves, the stretch whose turn it is longest ago is looked at; when it comes to rest, all
    are once more; while a posture is held, they are on. At rest for long, nothing is.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: WatchConfig | None = None) -> None:
        self.config = config or WatchConfig()
        self.ticks = Ticks(self.config.ticks)
        self.motion = Motion(self.config.motion)
        self._begin()

    def _begin(self) -> None:
        self._looked: dict[int, int] = {}
        self._waiting: deque[int] = deque()
        self._not_before = -1
        self._rest_row = 0
        self._restarts = 0

    def reset(self) -> None:
        """Forget stream and person."""
        self.ticks.reset()
        self.motion.forget()
        self._begin()

    def update(self, pose: Pose) -> Hypothesis | None:
        """Take in a pose; return what is to be looked at now, if anything."""
        rows = self.ticks.update(pose)
        if rows == 0:
            return None
        if self.ticks.restarts != self._restarts:
            self.motion.reset()
            self._begin()
            self._restarts = self.ticks.restarts
        for row in self.ticks.window(self.ticks.count - rows, self.ticks.count - 1):
            self._move(row)
        return self._choose()

    def clip(self, hypothesis: Hypothesis) -> Clip:
        """Return the stretch that the newest hypothesis is about."""
        return self.ticks.clip(*hypothesis.rows)

    def block(self, until_ns: int) -> None:
        """From now on, look at nothing that began before this moment."""
        self._not_before = round((until_ns - self.ticks.began_ns) * 1e-9 * RATE_HZ)

    def _move(self, row: object) -> None:
        rested = self.motion.resting
        self.motion.update(row)  # type: ignore[arg-type]  # iterating an array loses its shape
        if self.motion.resting and not rested:
            self._rest_row = self.motion.row
            self._waiting = deque(onset.row for onset in reversed(self.motion.onsets))

    def _choose(self) -> Hypothesis | None:
        now = self.motion.row
        while self._waiting:
            row = self._waiting.popleft()
            if row >= self._not_before and _SHORTEST <= now - row <= self.config.motion.longest_s * RATE_HZ:
                return self._hypothesis(row, now)
        if self.motion.resting and now - self._rest_row > self.config.hold_s * RATE_HZ:
            return None
        fitting = [
            o.row
            for o in self.motion.onsets
            if now - o.row >= _SHORTEST
            and o.row >= self._not_before
            and now - self._looked.get(o.row, -_AGAIN) >= _AGAIN
        ]
        if not fitting:
            return None
        return self._hypothesis(min(fitting, key=lambda row: self._looked.get(row, -1)), now)

    def _hypothesis(self, row: int, now: int) -> Hypothesis:
        self._looked[row] = now
        if len(self._looked) > 4 * self.config.motion.most:
            alive = {onset.row for onset in self.motion.onsets}
            self._looked = {r: n for r, n in self._looked.items() if r in alive}
        since = self.motion.moving_since(row)
        return Hypothesis(
            self.ticks.stamp_ns(since),
            self.ticks.stamp_ns(now),
            (now - since) / RATE_HZ,
            self.motion.activity_m_s,
            self.motion.peak_m_s(row),
            min((o.still_m_s for o in self.motion.onsets if o.row == row), default=0.0),
            self.motion.resting,
            now - self.motion.lull_row <= _JUST,
            (row - _MARGIN, now),
        )
