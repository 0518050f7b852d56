"""Poses as they come become rows at a steady rate: late, missing, crossed and foreign ones are dealt with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.skeleton import MIRROR, Clip, Landmark, Pose

RATE_HZ = 30.0
"""Rows a second, whatever the camera's rate."""


@dataclass(frozen=True, slots=True)
class TickConfig:
    """What is believed of a stream of poses.

    A pose that is nowhere near the one before is somebody else's, or a blunder: it is left out. One whose
    left and right landmarks fit the last pose better when they change places has them changed.
    """

    memory_s: float = 7.0
    """Seconds of rows that are kept."""
    gap_s: float = 0.6
    """A hole longer than this ends what was going on, and whoever is seen then is believed; a shorter one is
    bridged by straight lines."""
    jump_m: float = 0.15
    """All landmarks may differ from the pose before by so much on average ..."""
    speed_m_s: float = 3.0
    """... and by so much more a second."""
    reach_s: float = 0.15
    """But never by more than in this time."""
    crossed_s: float = 1.5
    """Left and right that stay changed for this long are believed."""
    unseen_s: float = 0.5
    """A landmark that is not seen keeps its place relative to the hips for this long."""


class Ticks:
    """The last seconds of one person's movement, at a steady rate.

    Rows are numbered from 0 since the stream began; a row has the interpolated landmarks of its moment.

    Args:
        config: What is believed.
    """

    def __init__(self, config: TickConfig | None = None) -> None:
        self.config = config or TickConfig()
        self._kept = round(self.config.memory_s * RATE_HZ)
        # Twice as long as needed: a window is always one piece, and moving back is rare.
        self._rows = np.empty((2 * self._kept, 13, 3))
        self.reset()

    def reset(self) -> None:
        """Forget the stream."""
        self.count = 0
        """Rows so far."""
        self.began_ns = 0
        """Stamp of row 0."""
        self.restarts = 0
        """How often the stream began anew."""
        self._first = 0  # number of the row that stands first in the array
        self._last: Float[np.ndarray, "13 3"] | None = None
        self._last_ns = 0
        self._newest_ns: int | None = None
        self._crossed_ns: int | None = None
        self._unseen_s = np.zeros(13)

    def update(self, pose: Pose) -> int:
        """Take in a pose; return how many rows that completes.

        Poses that are not newer than the newest, or hold NaN, are ignored. After a hole, or when somebody
        else is believed, ``restarts`` grows and rows are counted from 0 again.
        """
        if self._newest_ns is not None and pose.stamp_ns <= self._newest_ns:
            return 0
        joints = np.asarray(pose.joints, dtype=np.float64)
        if not np.isfinite(joints).all():
            return 0
        self._newest_ns = pose.stamp_ns
        if self._last is None or (pose.stamp_ns - self._last_ns) * 1e-9 > self.config.gap_s:
            return self._restart(joints, pose.stamp_ns)
        step_s = (pose.stamp_ns - self._last_ns) * 1e-9
        joints = self._uncrossed(joints, pose.stamp_ns)
        joints = self._seen(joints, np.asarray(pose.visibility), step_s)
        away = float(np.linalg.norm(joints - self._last, axis=1).mean())
        if away > self.config.jump_m + self.config.speed_m_s * min(step_s, self.config.reach_s):
            return 0
        return self._advance(joints, pose.stamp_ns)

    def window(self, first: int, last: int) -> Float[np.ndarray, "rows 13 3"]:
        """Return rows ``first`` to ``last``, both included, as far as they are remembered."""
        low = max(first - self._first, 0, self.count - self._kept - self._first)
        return self._rows[low : last + 1 - self._first]

    def clip(self, first: int, last: int) -> Clip:
        """Return the same as a clip."""
        return Clip.at_rate(self.window(first, last).copy(), RATE_HZ, name="stream")

    def stamp_ns(self, row: int) -> int:
        """Return the moment of a row."""
        return self.began_ns + round(row * 1e9 / RATE_HZ)

    def _restart(self, joints: np.ndarray, stamp_ns: int) -> int:
        restarts = self.restarts + (self._last is not None)
        self.reset()
        self.restarts, self.began_ns, self._newest_ns = restarts, stamp_ns, stamp_ns
        self._last, self._last_ns = joints, stamp_ns
        self._push(joints)
        return 1

    def _advance(self, joints: np.ndarray, stamp_ns: int) -> int:
        before = self.count
        assert self._last is not None
        while (due_ns := self.stamp_ns(self.count)) <= stamp_ns:
            share = (due_ns - self._last_ns) / (stamp_ns - self._last_ns)
            self._push(self._last + share * (joints - self._last))
        self._last, self._last_ns = joints, stamp_ns
        return self.count - before

    def _push(self, row: np.ndarray) -> None:
        place = self.count - self._first
        if place == len(self._rows):
            self._rows[: self._kept] = self._rows[-self._kept :]
            self._first = self.count - self._kept
            place = self._kept
        self._rows[place] = row
        self.count += 1

    def _uncrossed(self, joints: np.ndarray, stamp_ns: int) -> np.ndarray:
        """Change left and right if that fits the last pose much better, unless it has been so for long."""
        other = joints[list(MIRROR)]
        same = float(np.linalg.norm(joints - self._last, axis=1).mean())
        crossed = float(np.linalg.norm(other - self._last, axis=1).mean())
        if crossed > 0.5 * same or same < 0.05:
            self._crossed_ns = None
            return joints
        if self._crossed_ns is None:
            self._crossed_ns = stamp_ns
        return other if (stamp_ns - self._crossed_ns) * 1e-9 < self.config.crossed_s else joints

    def _seen(self, joints: np.ndarray, visibility: np.ndarray, step_s: float) -> np.ndarray:
        """Let landmarks that are not seen stay where they were, relative to the hips."""
        seen = visibility > 0
        if seen.all():
            self._unseen_s[:] = 0
            return joints
        self._unseen_s = np.where(seen, 0.0, self._unseen_s + step_s)
        stay = ~seen & (self._unseen_s <= self.config.unseen_s)
        hips = [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]
        if not seen[hips].all():
            return joints
        assert self._last is not None
        moved = joints[hips].mean(axis=0) - self._last[hips].mean(axis=0)
        return np.asarray(np.where(stay[:, None], self._last + moved, joints))
