"""Which stretches of movement are a gesture: the first spotting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Pose
from wigwag.stream.segment import Segment, SegmentConfig, Segmenter


class Recogniser(Protocol):
    """Anything that names the gesture in a clip, or says that it is none."""

    def recognise(self, clip: Clip) -> Gesture:
        """Name the gesture; ``label=None`` when unsure."""
        ...


@dataclass(frozen=True, slots=True)
class SpotConfig:
    """How stretches of movement become gestures."""

    segment: SegmentConfig = field(default_factory=lambda: SegmentConfig(off_m_s=0.45, hang_s=0.1))
    """Rest is believed sooner than where gestures are taught: the drone waits for the decision, and a
    recogniser that was taught halves of gestures as no gesture refuses what was cut too early. On simulated
    people who took no part in teaching the median decision comes 0.14 s after the end instead of 0.38 s, as
    many being right and as few false."""
    patience_s: float = 0.5
    """How long a named stretch waits for a surer one that overlaps it, unless the body is at rest."""
    margin_s: float = 0.10
    """How much before and after a stretch goes into the clip."""
    overlap_s: float = 0.3
    """How far a gesture may reach back into the one before."""


class Spotter:
    """Finds gestures in a stream of poses and names each once.

    Every stretch that the segmenter proposes is named; the surest name speaks as soon as the body is at
    rest, or nothing surer has come for ``patience_s``.

    Args:
        recogniser: Names clips.
        config: Patience and thresholds.
    """

    def __init__(self, recogniser: Recogniser, config: SpotConfig | None = None) -> None:
        self.recogniser = recogniser
        self.config = config or SpotConfig()
        self.segmenter = Segmenter(self.config.segment)
        self._best: Gesture | None = None
        self._refused: Gesture | None = None
        self._spoken_ns = 0

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose and return a gesture when one has been decided.

        Returns:
            A gesture with a label, or one with ``label=None`` and a reason when a movement ended that is
            no known gesture; ``None`` as long as there is nothing to say.
        """
        if pose is None:
            return None
        for segment in self.segmenter.update(pose):
            self._name(segment)
        if self._best is not None:
            waited_s = (pose.stamp_ns - self._best.end_ns) * 1e-9
            if self.segmenter.resting or waited_s > self.config.patience_s:
                return self._speak(self._best, pose.stamp_ns)
            return None
        if self._refused is not None and self.segmenter.resting:
            return self._speak(self._refused, pose.stamp_ns)
        return None

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self.segmenter.reset()
        self._best = self._refused = None
        self._spoken_ns = 0

    def _name(self, segment: Segment) -> None:
        if segment.onset_ns < self._spoken_ns - int(self.config.overlap_s * 1e9):
            return
        clip = cut_out(self.segmenter, segment, self.config.margin_s)
        if clip is None:
            return
        gesture = self.recogniser.recognise(clip)
        gesture = replace(gesture, onset_ns=segment.onset_ns, end_ns=segment.end_ns)
        if gesture.label is None:
            if self._refused is None or gesture.confidence >= self._refused.confidence:
                self._refused = gesture
        elif self._best is None or gesture.confidence > self._best.confidence:
            self._best = gesture

    def _speak(self, gesture: Gesture, now_ns: int) -> Gesture:
        self._best = self._refused = None
        if gesture.label is not None:
            self._spoken_ns = gesture.end_ns
        return replace(gesture, decided_ns=now_ns)


def cut_out(segmenter: Segmenter, segment: Segment, margin_s: float) -> Clip | None:
    """Return a proposed stretch as a clip, with ``margin_s`` of what is around it."""
    margin_ns = int(margin_s * 1e9)
    return segmenter.clip(segment.onset_ns - margin_ns, segment.end_ns + margin_ns)


def background(
    stream: Clip,
    gestures: Sequence[Segment],
    config: SpotConfig | None = None,
    max_iou: float = 0.5,
) -> list[Clip]:
    """Return what the spotter would propose in a stream though it is no whole gesture.

    Halves of gestures, gestures run together with walking, walking itself: a recogniser that has such
    clips among its training clips, without label, refuses them in flight.

    Args:
        stream: A training person's stream of poses.
        gestures: Where the gestures truly are.
        config: The spotter's.
        max_iou: A proposal that overlaps a gesture by more than this is no background.
    """
    config = config or SpotConfig()
    segmenter = Segmenter(config.segment)
    visibility = np.ones(13)
    clips = []
    for joints, stamp_ns in zip(stream.joints, stream.stamps_ns, strict=True):
        for segment in segmenter.update(Pose(joints, visibility, int(stamp_ns))):
            if max((segment.iou(gesture) for gesture in gestures), default=0.0) > max_iou:
                continue
            clip = cut_out(segmenter, segment, config.margin_s)
            if clip is not None:
                name = f"no gesture of {stream.subject} at {segment.onset_ns * 1e-9:.2f} s"
                clips.append(replace(clip, subject=stream.subject, name=name))
    return clips
