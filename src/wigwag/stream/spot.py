"""Which stretches of movement make up a gesture: the first spotting."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Landmark, Pose
from wigwag.stream.segment import Segment, SegmentConfig, Segmenter


class Recogniser(Protocol):
    """Anything that names the gesture in a clip, or says that it is none."""

    def recognise(self, clip: Clip) -> Gesture:
        """Name the gesture; ``label=None`` when unsure."""
        ...


@dataclass(frozen=True, slots=True)
class SpotConfig:
    """How stretches of movement are joined into candidates."""

    segment: SegmentConfig = field(default_factory=SegmentConfig)
    min_s: float = 0.45
    """Anything shorter is a twitch."""
    max_s: float = 5.0
    """Anything longer is no gesture."""
    max_joined: int = 4
    join_gap_s: float = 1.3
    """Pauses within a gesture (a held arm) are shorter than this."""
    patience_s: float = 0.7
    """How long to wait for the gesture to go on when the arms are not back at rest."""
    margin_s: float = 0.15
    """How much of the rest before and after goes into the clip."""


class Spotter:
    """Cuts gestures out of a stream of poses and names each once.

    A gesture may pause (an arm held up), so every run of neighbouring stretches of movement that ends
    with the newest one is a candidate; the surest speaks, when the arms are back at rest or nothing has
    followed for ``patience_s``.

    Args:
        recogniser: Names clips.
        config: Joining and thresholds.
    """

    def __init__(self, recogniser: Recogniser, config: SpotConfig | None = None) -> None:
        self.recogniser = recogniser
        self.config = config or SpotConfig()
        self.segmenter = Segmenter(self.config.segment)
        self._segments: list[Segment] = []
        self._best: tuple[Gesture, int] | None = None
        self._tried = Gesture(None, 0.0, reason="nothing tried")

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose and return a gesture when one has been decided.

        Returns:
            A gesture with a label, or one with ``label=None`` and a reason when a movement ended that is
            no known gesture; ``None`` as long as there is nothing to say.
        """
        if pose is None:
            return None
        ended = self.segmenter.update(pose)
        if ended is not None:
            self._add(ended)
        if not self._segments or self.segmenter.moving:
            return None
        quiet_s = (pose.stamp_ns - self._segments[-1].end_ns) * 1e-9
        if quiet_s < self.config.patience_s and not arms_hang(pose):
            return None
        return self._speak(pose.stamp_ns)

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self.segmenter.reset()
        self._segments, self._best = [], None

    def _add(self, ended: Segment) -> None:
        config = self.config
        if self._segments:
            pause_s = (ended.onset_ns - self._segments[-1].end_ns) * 1e-9
            if pause_s > config.join_gap_s:
                self._segments, self._best = [], None
        self._segments = [*self._segments, ended][-config.max_joined :]
        for first in range(len(self._segments)):
            onset = self._segments[first].onset_ns
            length_s = (ended.end_ns - onset) * 1e-9
            if not config.min_s <= length_s <= config.max_s:
                continue
            gesture = self._name(onset, ended.end_ns)
            if gesture is None:
                continue
            self._tried = gesture
            if gesture.label is not None and (
                self._best is None or gesture.confidence >= self._best[0].confidence
            ):
                self._best = (gesture, len(self._segments) - first)

    def _name(self, onset_ns: int, end_ns: int) -> Gesture | None:
        margin_ns = int(self.config.margin_s * 1e9)
        clip = self.segmenter.clip(onset_ns - margin_ns, end_ns + margin_ns)
        if clip is None:
            return None
        return replace(self.recogniser.recognise(clip), onset_ns=onset_ns, end_ns=end_ns)

    def _speak(self, now_ns: int) -> Gesture | None:
        best, self._best = self._best, None
        segments, self._segments = self._segments, []
        if best is not None:
            return replace(best[0], decided_ns=now_ns)
        if self._tried.end_ns == segments[-1].end_ns:
            return replace(self._tried, label=None, decided_ns=now_ns)
        return None


def arms_hang(pose: Pose, reach: float = 0.45) -> bool:
    """Say whether both wrists hang below the elbows, near the hips.

    Args:
        pose: Camera optical frame, y down.
        reach: How far a wrist may be from its hip, as a share of the torso's length times two.
    """
    joints = pose.joints
    torso = float(np.linalg.norm(
        (joints[Landmark.LEFT_SHOULDER] + joints[Landmark.RIGHT_SHOULDER]) / 2 - pose.hip_center
    ))  # fmt: skip
    for shoulder, elbow, wrist, hip in (
        (Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST, Landmark.LEFT_HIP),
        (Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST, Landmark.RIGHT_HIP),
    ):
        below = joints[wrist, 1] > joints[elbow, 1] > joints[shoulder, 1]
        near = np.linalg.norm(joints[wrist] - joints[hip]) < 2 * reach * torso
        if not (below and near):
            return False
    return True
