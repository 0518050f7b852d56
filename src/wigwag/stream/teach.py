"""Teaching a stream: from labelled clips, labelled streams, and movement that is no gesture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wigwag.errors import InputError
from wigwag.features.augment import Augmentation
from wigwag.skeleton import Clip
from wigwag.stream.assemble import assemble
from wigwag.stream.config import StreamConfig
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.lesson import Lesson, Origin
from wigwag.stream.truth import LabelledStream, Showing

_ROUNDS = 2
"""Streams that are assembled of a person's clips."""

_COPIES = 6
"""Streams of varied copies where one person alone teaches, who cannot be left out."""

_LONG_S = 10.0
"""Background longer than this is a stream by itself."""

_SAME_PERSON = Augmentation(bones=0.03, warp=0.2, tempo=0.15, crop=0.0)
"""How one person shows a gesture another time."""


def teach_stream(
    clips: Sequence[Clip],
    background: Sequence[Clip] = (),
    streams: Sequence[LabelledStream] = (),
    config: StreamConfig | None = None,
    random_state: int = 0,
    *,
    origin: Origin = "start",
) -> StreamModel:
    """Teach gestures, and what is none.

    Streams are watched as they will be when flown. From what is looked at in them (whole gestures, first
    parts, and everything that is none: halves, transitions, everyday movement) it is learned what gestures
    look like while they are shown. How sure to be is learned from people who are left out in turn.

    Args:
        clips: Labelled examples, with ``subject`` set. Where no stream shows a person's gesture, its
            examples are put into streams of their own, between rest and background.
        background: Movements that are no gesture, of anybody, however long.
        streams: Streams in which gestures are marked.
        config: How a stream becomes gestures.
        random_state: Seed.
        origin: ``"start"``, or ``"drift"`` for a camera that moves; see
            :class:`~wigwag.features.canonical.CanonicalForm`.

    Raises:
        InputError: If there is no labelled gesture, or a command that nobody shows; or if one person alone
            shows gestures, and in streams, not clips.

    Example:
        >>> import numpy as np
        >>> from wigwag.skeleton import Clip, Pose
        >>> rng, body = np.random.default_rng(0), np.random.default_rng(1).normal(0, 0.4, (13, 3))
        >>> def clip(label, person):
        ...     raised = np.zeros((60, 13, 3))
        ...     raised[:, 5 if label == "left" else 6, 1] = -np.sin(np.linspace(0, np.pi, 60))
        ...     return Clip.at_rate(body + raised + rng.normal(0, 0.003, (60, 13, 3)), 30, label, person)
        >>> clips = [clip(label, person) for label in ("left", "right") for person in "aabb"]
        >>> stream = teach_stream(clips).stream()
        >>> poses = [Pose(joints, np.ones(13), i * 33_333_333) for i, joints in enumerate(clips[0].joints)]
        >>> said = [gesture.label for pose in poses if (gesture := stream.update(pose)) is not None]
    """
    config = config or StreamConfig()
    watched = lesson_streams(clips, background, streams, random_state)
    _check({showing.label for one in watched for showing in one.showings}, config)
    return Lesson(watched, origin, random_state).learn(config)


def lesson_streams(
    clips: Sequence[Clip],
    background: Sequence[Clip] = (),
    streams: Sequence[LabelledStream] = (),
    random_state: int = 0,
) -> list[LabelledStream]:
    """Return the streams that :func:`teach_stream` learns from: those given, and those put together of clips.

    Args:
        clips: As there.
        background: As there.
        streams: As there.
        random_state: Seed.
    """
    rng = np.random.default_rng(random_state)
    labelled = [clip for clip in clips if clip.label is not None]
    others = [*background, *(clip for clip in clips if clip.label is None)]
    shown = {(s.stream.subject, showing.label) for s in streams for showing in s.showings}
    missing = [clip for clip in labelled if (clip.subject, clip.label) not in shown]
    people = {clip.subject for clip in missing} | {s.stream.subject for s in streams if s.showings}
    watched = [*streams, *_assembled(missing, others, rng, alone=len(people) == 1 and not shown)]
    watched += [LabelledStream(clip) for clip in others if clip.duration_s > _LONG_S]
    return watched + _strung([clip for clip in others if clip.duration_s <= _LONG_S], rng)


def _check(labels: set[str], config: StreamConfig) -> None:
    if not labels:
        raise InputError("teach_stream needs at least one labelled clip or one stream with a showing.")
    if config.commands is not None and (absent := set(config.commands) - labels):
        raise InputError(
            f"StreamConfig.commands holds {sorted(absent)}, which nobody shows; shown are {sorted(labels)}."
        )


def _assembled(
    clips: Sequence[Clip], background: Sequence[Clip], rng: np.random.Generator, *, alone: bool
) -> list[LabelledStream]:
    """Put each person's clips into streams; of one person alone, varied copies."""
    streams = []
    for person in sorted({str(clip.subject) for clip in clips}):
        mine = [clip for clip in clips if str(clip.subject) == person]
        for number in range(_COPIES if alone else _ROUNDS):
            shown = mine
            if alone:
                shown = [
                    replace(_SAME_PERSON.apply(c, rng), subject=f"{person} again {number}") for c in mine
                ]
            streams.append(assemble(shown, background, rng))
    return streams


def _strung(clips: Sequence[Clip], rng: np.random.Generator) -> list[LabelledStream]:
    """Put each person's short movements that are no gesture into one stream."""
    streams = []
    for person in sorted({str(clip.subject) for clip in clips}):
        mine = [replace(clip, label=None) for clip in clips if str(clip.subject) == person]
        streams.append(assemble(mine, (), rng))
    return streams


__all__ = ["LabelledStream", "Showing", "StreamModel", "lesson_streams", "teach_stream"]
