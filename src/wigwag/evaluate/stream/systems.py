"""What is judged: anything that takes poses and says commands, and how each is taught."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from wigwag.datasets import msrc12
from wigwag.datasets.recording import Mark
from wigwag.errors import InputError
from wigwag.evaluate.stream.lessons import Lesson
from wigwag.evaluate.stream.moves import cut_to_movement
from wigwag.gesture import Gesture
from wigwag.recognise import KernelRecognizer
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamConfig
from wigwag.stream.moments import MomentConfig
from wigwag.stream.segment import Segment
from wigwag.stream.spot import SpotConfig, Spotter, background
from wigwag.stream.teach import LabelledStream, Showing, teach_stream
from wigwag.stream.teach_moments import teach_moments

REFUSED_PER_STREAM = 150
"""The spotter's wrong proposals that are taught as background, a training stream, as the demo does."""


class Listener(Protocol):
    """Takes poses without end, says gestures."""

    def update(self, pose: Pose) -> Gesture | None:
        """Take in the newest pose; return a gesture when one has been decided."""
        ...

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        ...


class Only:
    """A listener whose gestures outside of a vocabulary are no commands.

    Args:
        make: Makes a listener; called again to forget a stream, whose clock the next one need not continue.
        vocabulary: What is wanted.
    """

    def __init__(self, make: Callable[[], Listener], vocabulary: tuple[str, ...]) -> None:
        self._make = make
        self._listener = make()
        self.vocabulary = frozenset(vocabulary)

    def update(self, pose: Pose) -> Gesture | None:
        """Take in the newest pose; a gesture outside of the vocabulary loses its label."""
        gesture = self._listener.update(pose)
        if gesture is not None and gesture.label is not None and gesture.label not in self.vocabulary:
            return replace(gesture, label=None, reason=f"{gesture.label} is no command")
        return gesture

    def reset(self) -> None:
        """Forget the stream."""
        self._listener = self._make()


def teach_spotter(lesson: Lesson) -> Listener:
    """Teach the first spotting as the demo with recorded people does.

    All gestures are taught by name, commands and others; everyday movements, and what the spotter wrongly
    proposes in training streams, are background.
    """
    config = SpotConfig()
    clips = [*lesson.gestures, *lesson.others, *lesson.background]
    rng = np.random.default_rng([0x5B07, lesson.seed])
    for recording in lesson.streams:
        truth = [Segment(mark.onset_ns, mark.end_ns) for mark in recording.marks]
        wrong = background(recording.stream, truth, config)
        clips += [wrong[int(i)] for i in rng.permutation(len(wrong))[:REFUSED_PER_STREAM]]
    recogniser = KernelRecognizer(preset="fast", origin="drift", copies=1, random_state=lesson.seed)
    recogniser.fit([_movable(clip) for clip in clips])
    return Only(lambda: Spotter(recogniser, config), lesson.vocabulary)


def teach_gesture_stream(lesson: Lesson, deliberate: Sequence[Clip] = ()) -> Listener:
    """Teach a :class:`~wigwag.stream.gesture_stream.GestureStream` with its defaults.

    Recordings are cut to their movement; further gestures are known by name and kept silent. Where action
    points are all that is known, a :class:`~wigwag.stream.moments.MomentStream` is taught.
    """
    if any(mark.point_ns is not None for recording in lesson.streams for mark in recording.marks):
        points = [LabelledStream(r.stream, tuple(_point(mark) for mark in r.marks)) for r in lesson.streams]
        either_side = tuple(label for label in lesson.vocabulary if label not in msrc12.SIDED)
        settings = MomentConfig(commands=lesson.vocabulary, either_side=either_side)
        return teach_moments(points, settings, random_state=lesson.seed).stream()
    clips = [cut_to_movement(clip) for clip in (*lesson.gestures, *lesson.others)]
    streams = [LabelledStream(r.stream, tuple(_showing(mark) for mark in r.marks)) for r in lesson.streams]
    streams += [LabelledStream(_movable(clip), deliberate=True) for clip in deliberate]
    background = [_movable(clip) for clip in lesson.background]
    config = StreamConfig(commands=lesson.vocabulary)
    return teach_stream(clips, background, streams, config, random_state=lesson.seed).stream()


def teach_beside_deliberate(lesson: Lesson) -> Listener:
    """Teach the same, and as no command also what other people gesture deliberately."""
    return teach_gesture_stream(lesson, lesson.deliberate)


def _showing(mark: Mark) -> Showing:
    return Showing(mark.label, mark.onset_ns, mark.end_ns)


def _point(mark: Mark) -> Showing:
    moment_ns = mark.end_ns if mark.point_ns is None else mark.point_ns
    return Showing(mark.label, moment_ns, moment_ns)


def _movable(clip: Clip) -> Clip:
    """Return a clip whose stamps start at 0."""
    return replace(clip, stamps_ns=clip.stamps_ns - clip.stamps_ns[0])


SYSTEMS: dict[str, Callable[[Lesson], Listener]] = {
    "stream": teach_gesture_stream,
    "spotter": teach_spotter,
    "stream+deliberate": teach_beside_deliberate,
}
"""Every system by its name: from a lesson to a listener."""


def system_of(name: str) -> Callable[[Lesson], Listener]:
    """Return what teaches a system.

    Raises:
        InputError: If there is none of that name.
    """
    if name not in SYSTEMS:
        raise InputError(f"There is no system {name!r}. Available systems: {', '.join(SYSTEMS)}.")
    return SYSTEMS[name]


__all__ = ["SYSTEMS", "Listener", "Only", "system_of", "teach_gesture_stream", "teach_spotter"]
