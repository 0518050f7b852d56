"""Which stretches of a stream of poses may be a gesture: between one lull of movement and another."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.skeleton import Clip, Landmark, Pose

_ACROSS = np.array([1.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class SegmentConfig:
    """When a body counts as moving, and which stretches are proposed."""

    on_m_s: float = 0.5
    """A movement begins when the fastest joints are faster than this."""
    off_m_s: float = 0.35
    """Slower than this is a lull."""
    hang_s: float = 0.25
    """A lull this long is rest: the movement is over."""
    dip: float = 0.8
    """A moment at which the joints are slower than this share of their speed just before and after is a
    lull too, however fast they are: so walking is told from the gesture that follows it."""
    fastest: int = 4
    """How many joints speak: the mean speed of this many, the fastest of the moment."""
    smoothing_s: float = 0.12
    """Time constant of the low-pass filter on joint positions before they are differentiated."""
    min_s: float = 1.0
    """Nothing shorter is proposed."""
    max_s: float = 5.0
    """Nothing longer is proposed."""
    max_proposals: int = 10
    """At most so many stretches are proposed at a lull."""
    gap_s: float = 0.5
    """A hole in the stream longer than this ends what was going on."""


@dataclass(frozen=True, slots=True)
class Segment:
    """One stretch of a stream."""

    onset_ns: int
    end_ns: int

    @property
    def duration_s(self) -> float:
        """Seconds."""
        return (self.end_ns - self.onset_ns) * 1e-9

    def iou(self, other: Segment) -> float:
        """Return intersection over union.

        Example:
            >>> Segment(0, 10).iou(Segment(5, 15))
            0.3333333333333333
        """
        inside = min(self.end_ns, other.end_ns) - max(self.onset_ns, other.onset_ns)
        union = max(self.end_ns, other.end_ns) - min(self.onset_ns, other.onset_ns)
        return max(inside, 0) / union if union else 0.0


class Segmenter:
    """Proposes stretches of a stream that may be a gesture, by the speed of joints relative to the hips.

    A gesture lies between two lulls with lowered arms; how many lulls lie within it (an arm held up, the
    turning points of a wave) is not known, so each lull is joined with several before it.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: SegmentConfig | None = None) -> None:
        self.config = config or SegmentConfig()
        self.resting = True
        """Whether the body has been still for ``hang_s``."""
        self._poses: deque[Pose] = deque()
        self._activity: deque[tuple[int, float]] = deque()
        self._lulls: deque[int] = deque()
        self._smooth: Float[np.ndarray, "13 3"] | None = None
        self._quiet_since_ns: int | None = None

    @property
    def activity_m_s(self) -> float:
        """Mean speed of the fastest joints relative to the hips, just now."""
        return self._activity[-1][1] if self._activity else 0.0

    def update(self, pose: Pose) -> list[Segment]:
        """Take in a pose; return the stretches that end at a lull which it completes, longest last.

        Poses that are not newer than the last one are ignored.
        """
        if self._poses:
            gap_s = (pose.stamp_ns - self._poses[-1].stamp_ns) * 1e-9
            if gap_s <= 0:
                return []
            if gap_s > self.config.gap_s:
                self.reset()
        self._measure(pose)
        self._poses.append(pose)
        oldest = pose.stamp_ns - int((self.config.max_s + 1.5) * 1e9)
        for memory in (self._poses, self._activity, self._lulls):
            while memory and _stamp(memory[0]) < oldest:
                memory.popleft()
        lull_ns = self._lull(pose.stamp_ns)
        return [] if lull_ns is None else self._propose(lull_ns)

    def clip(self, onset_ns: int, end_ns: int, name: str = "stream") -> Clip | None:
        """Return the remembered poses between two stamps; ``None`` if fewer than four are left."""
        poses = [p for p in self._poses if onset_ns <= p.stamp_ns <= end_ns]
        return Clip.from_poses(poses, name=name) if len(poses) >= 4 else None

    def reset(self) -> None:
        """Forget everything, as after a gap."""
        self._poses.clear()
        self._activity.clear()
        self._lulls.clear()
        self._smooth = self._quiet_since_ns = None
        self.resting = True

    def _measure(self, pose: Pose) -> None:
        # Sideways and in depth the hips are the origin; in height they move too when a person sits or squats.
        relative = pose.joints - pose.hip_center * _ACROSS
        if self._smooth is None:
            self._smooth = relative
            self._activity.append((pose.stamp_ns, 0.0))
            return
        step_s = (pose.stamp_ns - self._poses[-1].stamp_ns) * 1e-9
        share = 1.0 - np.exp(-step_s / self.config.smoothing_s)
        smooth = self._smooth + share * (relative - self._smooth)
        speeds = np.linalg.norm(smooth - self._smooth, axis=1) / step_s
        self._smooth = smooth
        fastest = float(np.sort(speeds)[-self.config.fastest :].mean())
        self._activity.append((pose.stamp_ns, fastest))

    def _lull(self, now_ns: int) -> int | None:
        """Return the stamp of a lull that has just become known, if one has."""
        config, activity = self.config, self.activity_m_s
        if self.resting:
            if activity > config.on_m_s:
                self.resting = False
                # The climb from rest to ``on`` and the filter's delay lie before this moment.
                self._lulls.append(now_ns - int((0.1 + config.smoothing_s) * 1e9))
                self._quiet_since_ns = None
            return None
        if activity < config.off_m_s:
            if self._quiet_since_ns is None:
                self._quiet_since_ns = now_ns
            if (now_ns - self._quiet_since_ns) * 1e-9 >= config.hang_s:
                self.resting = True
                return self._quiet_since_ns
            return None
        self._quiet_since_ns = None
        return self._dip(now_ns)

    def _dip(self, now_ns: int) -> int | None:
        """Find a local minimum of activity 0.2 s ago that lies well below what is around it."""
        around = [(s, a) for s, a in self._activity if (now_ns - s) * 1e-9 <= 0.7]
        center = [(s, a) for s, a in around if 0.1 <= (now_ns - s) * 1e-9 <= 0.3]
        if not center:
            return None
        stamp, least = min(center, key=lambda pair: pair[1])
        before = max((a for s, a in around if s < stamp), default=0.0)
        after = max((a for s, a in around if s > stamp), default=0.0)
        recent = self._lulls and (stamp - self._lulls[-1]) * 1e-9 < 0.25
        if recent or least > self.config.dip * min(before, after):
            return None
        return stamp

    def _propose(self, lull_ns: int) -> list[Segment]:
        onsets = list(self._lulls)
        self._lulls.append(lull_ns)
        if self.resting:
            # What follows begins at the end of this rest, which is not known yet.
            self._lulls.pop()
        if not self._arms_down(lull_ns):
            return []
        segments = [Segment(onset, lull_ns) for onset in reversed(onsets)]
        config = self.config
        fitting = [s for s in segments if config.min_s <= s.duration_s <= config.max_s]
        return fitting[: config.max_proposals]

    def _arms_down(self, stamp_ns: int) -> bool:
        pose = min(self._poses, key=lambda p: abs(p.stamp_ns - stamp_ns))
        return arms_down(pose)


def _stamp(item: Pose | tuple[int, float] | int) -> int:
    if isinstance(item, Pose):
        return item.stamp_ns
    return item[0] if isinstance(item, tuple) else item


def arms_down(pose: Pose) -> bool:
    """Say whether both wrists are below the middle of the trunk.

    Args:
        pose: Any optical frame, y down.
    """
    joints = pose.joints
    chest = (joints[Landmark.LEFT_SHOULDER, 1] + joints[Landmark.RIGHT_SHOULDER, 1]) / 2
    middle = (chest + pose.hip_center[1]) / 2
    return bool(min(joints[Landmark.LEFT_WRIST, 1], joints[Landmark.RIGHT_WRIST, 1]) > middle)
