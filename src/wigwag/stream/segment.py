"""Where a movement begins and ends in a stream of poses."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.skeleton import Clip, Pose


@dataclass(frozen=True, slots=True)
class SegmentConfig:
    """When a body counts as moving."""

    on_m_s: float = 0.50
    """A movement begins when the fastest joints are faster than this."""
    off_m_s: float = 0.28
    """It ends when they have been slower than this for ``hang_s``."""
    hang_s: float = 0.30
    fastest: int = 4
    """How many joints speak: the mean speed of this many, the fastest of the moment."""
    smoothing_s: float = 0.10
    """Time constant of the low-pass filter on joint positions before they are differentiated."""
    keep_s: float = 8.0
    """How much of the stream is remembered."""
    gap_s: float = 0.5
    """A hole in the stream longer than this ends what was going on."""


@dataclass(frozen=True, slots=True)
class Segment:
    """One stretch of movement."""

    onset_ns: int
    end_ns: int

    @property
    def duration_s(self) -> float:
        """Seconds."""
        return (self.end_ns - self.onset_ns) * 1e-9


class Segmenter:
    """Cuts a stream of poses into stretches of movement, by the speed of joints relative to the hips.

    Walking as a whole does not move joints relative to the hips, swinging arms and legs do; a clip that
    is mere walking is left for the recogniser to refuse.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: SegmentConfig | None = None) -> None:
        self.config = config or SegmentConfig()
        self.activity_m_s = 0.0
        self.onset_ns: int | None = None
        self._poses: deque[Pose] = deque()
        self._smooth: Float[np.ndarray, "13 3"] | None = None
        self._quiet_since_ns: int | None = None

    @property
    def moving(self) -> bool:
        """Whether a movement is going on."""
        return self.onset_ns is not None

    def update(self, pose: Pose) -> Segment | None:
        """Take in a pose; return the stretch of movement that it ends, if it ends one.

        Poses that are not newer than the last one are ignored.
        """
        config = self.config
        if self._poses:
            gap_s = (pose.stamp_ns - self._poses[-1].stamp_ns) * 1e-9
            if gap_s <= 0:
                return None
            if gap_s > config.gap_s:
                self.reset()
        self._measure(pose)
        self._poses.append(pose)
        while (pose.stamp_ns - self._poses[0].stamp_ns) * 1e-9 > config.keep_s:
            self._poses.popleft()
        return self._decide(pose.stamp_ns)

    def clip(self, onset_ns: int, end_ns: int, name: str = "stream") -> Clip | None:
        """Return the remembered poses between two stamps; ``None`` if fewer than four are left."""
        poses = [p for p in self._poses if onset_ns <= p.stamp_ns <= end_ns]
        return Clip.from_poses(poses, name=name) if len(poses) >= 4 else None

    def reset(self) -> None:
        """Forget everything, as after a gap."""
        self._poses.clear()
        self._smooth = self.onset_ns = self._quiet_since_ns = None
        self.activity_m_s = 0.0

    def _measure(self, pose: Pose) -> None:
        relative = pose.joints - pose.hip_center
        if self._smooth is None:
            self._smooth = relative
            return
        step_s = (pose.stamp_ns - self._poses[-1].stamp_ns) * 1e-9
        share = 1.0 - np.exp(-step_s / self.config.smoothing_s)
        smooth = self._smooth + share * (relative - self._smooth)
        speeds = np.linalg.norm(smooth - self._smooth, axis=1) / step_s
        self._smooth = smooth
        self.activity_m_s = float(np.sort(speeds)[-self.config.fastest :].mean())

    def _decide(self, now_ns: int) -> Segment | None:
        config = self.config
        if self.activity_m_s < config.off_m_s:
            if self._quiet_since_ns is None:
                self._quiet_since_ns = now_ns
        elif self.activity_m_s > config.on_m_s or self.moving:
            if not self.moving:
                # The filter's delay and the climb from rest to ``on`` lie before this moment.
                self.onset_ns = now_ns - int(2 * config.smoothing_s * 1e9)
            self._quiet_since_ns = None
        if self.onset_ns is None or self._quiet_since_ns is None:
            return None
        if (now_ns - self._quiet_since_ns) * 1e-9 < config.hang_s:
            return None
        segment = Segment(self.onset_ns, self._quiet_since_ns)
        self.onset_ns = None
        return segment
