"""Teaching a stream: from labelled clips, labelled streams, and movement that is no gesture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wigwag.recognise.kernel import KernelRecognizer
from wigwag.skeleton import Clip
from wigwag.stream.gesture_stream import GestureStream, StreamConfig
from wigwag.stream.segment import Segment
from wigwag.stream.spot import background as refused

_BACKGROUND_CLIPS = 400


@dataclass(frozen=True, slots=True)
class Showing:
    """One gesture in a stream: the truth."""

    label: str
    onset_ns: int
    end_ns: int
    """When it is over; where only an action point is marked, that."""


@dataclass(frozen=True, slots=True)
class LabelledStream:
    """A stream of one person's poses, and what is shown in it."""

    stream: Clip
    showings: tuple[Showing, ...] = ()


@dataclass(frozen=True, slots=True)
class StreamModel:
    """What was taught."""

    recogniser: KernelRecognizer
    config: StreamConfig

    def stream(self, config: StreamConfig | None = None) -> GestureStream:
        """Begin a stream."""
        return GestureStream(self.recogniser, config or self.config)


def teach_stream(
    clips: Sequence[Clip],
    background: Sequence[Clip] = (),
    streams: Sequence[LabelledStream] = (),
    config: StreamConfig | None = None,
    random_state: int = 0,
) -> StreamModel:
    """Teach gestures, and what is none.

    Args:
        clips: Examples cut to the movement, labelled, with ``subject`` set.
        background: Streams of everyday movement by other people, however long; no gesture is in them.
        streams: Streams in which gestures are marked.
        config: How a stream becomes gestures.
        random_state: Seed.
    """
    config = config or StreamConfig()
    rng = np.random.default_rng(random_state)
    examples, nothing = list(clips), []
    for labelled in streams:
        truth = [Segment(s.onset_ns, s.end_ns) for s in labelled.showings]
        nothing += refused(labelled.stream, truth, config.spot)
        for showing in labelled.showings:
            inside = (labelled.stream.stamps_ns >= showing.onset_ns) & (
                labelled.stream.stamps_ns <= showing.end_ns
            )
            if inside.sum() >= 4:
                examples.append(
                    replace(
                        labelled.stream,
                        joints=labelled.stream.joints[inside],
                        stamps_ns=labelled.stream.stamps_ns[inside],
                        label=showing.label,
                    )
                )
    for stream in background:
        nothing += refused(stream, [], config.spot)
    some = rng.permutation(len(nothing))[:_BACKGROUND_CLIPS]
    examples += [replace(nothing[int(i)], label=None) for i in some]
    recogniser = KernelRecognizer(preset="fast", copies=1, random_state=random_state).fit(examples)
    return StreamModel(recogniser, config)


__all__ = ["LabelledStream", "Showing", "StreamModel", "teach_stream"]
