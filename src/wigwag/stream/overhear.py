"""Listen as always, and keep what was judged when something was said: for explanations."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

from wigwag.errors import InputError
from wigwag.gesture import Gesture
from wigwag.recognise.explain import Explanation, Taught, explain
from wigwag.recognise.kernel import KernelRecognizer
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.glance import Glimpse, scores_of
from wigwag.stream.listener import listening
from wigwag.stream.prefix import Memory
from wigwag.stream.speaker import Look
from wigwag.stream.spot import Recogniser, SpotConfig
from wigwag.stream.watcher import Hypothesis

_KEPT = 128
"""Judged stretches that are kept until one of them is spoken: some seconds' worth."""


@dataclass(frozen=True, slots=True)
class Heard:
    """A gesture, and the stretch of the stream that it was said of."""

    gesture: Gesture
    clip: Clip
    least: float
    """How sure it had to be."""
    glimpse: Glimpse | None = None
    """What the second view saw, if there is one."""


class Overhearing:
    """A listener that says what it would say anyway, and keeps in ``heard`` what the last word was about.

    Args:
        taught: As in :func:`~wigwag.stream.listener.listening`.
        config: The spotter's.
    """

    def __init__(self, taught: StreamModel | Recogniser, config: SpotConfig | None = None) -> None:
        self.taught = taught
        self.heard: Heard | None = None
        """What was said last; ``None``: nothing, or what it was about is not known."""
        self._judged: deque[Heard] = deque(maxlen=_KEPT)
        if isinstance(taught, StreamModel):
            tapped: StreamModel | Recogniser = _TappedModel(
                taught.prefixes,
                taught.sureness,
                taught.thresholds,
                taught.config,
                taught.glance,
                self._judged,
            )
        else:
            tapped = _TappedRecogniser(taught, self._judged)
        self._listener = listening(tapped, config)

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose; return a gesture when one has been decided."""
        gesture = self._listener.update(pose)
        if gesture is not None:
            self.heard = self._about(gesture)
        return gesture

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self._listener.reset()
        self._judged.clear()
        self.heard = None

    def explain(self) -> Explanation | None:
        """Say why what was said last was said; ``None``: that cannot be told.

        It can of a ``KernelRecognizer`` and of a ``StreamModel``.
        """
        if self.heard is None or not isinstance(self.taught, KernelRecognizer | StreamModel):
            return None
        heard = self.heard
        moments = None if heard.glimpse is None else scores_of(heard.glimpse)
        return explain(parts_of(self.taught), heard.clip, heard.gesture, heard.least, moments)

    def _about(self, gesture: Gesture) -> Heard | None:
        for judged in reversed(self._judged):
            said = judged.gesture
            if said.confidence == gesture.confidence and said.reason in gesture.reason:
                return replace(judged, gesture=gesture)
        return None


def parts_of(taught: StreamModel | Recogniser) -> Taught:
    """Return what a recogniser's decisions come from.

    Raises:
        InputError: If it is of a kind whose decisions are not explained.
    """
    if isinstance(taught, KernelRecognizer):
        return Taught.of(taught)
    if isinstance(taught, StreamModel):
        p = taught.prefixes
        return Taught(p.similar, p.weights, p.numbers, p.names, p.labels, p.typical)
    raise InputError(
        f"Decisions of a {type(taught).__name__} are not explained, only those of a KernelRecognizer or a "
        "StreamModel."
    )


class _TappedRecogniser:
    """A recogniser whose judgements are kept."""

    def __init__(self, taught: Recogniser, judged: deque[Heard]) -> None:
        self._taught, self._judged = taught, judged

    def recognise(self, clip: Clip) -> Gesture:
        gesture = self._taught.recognise(clip)
        least = 0.0
        if isinstance(self._taught, KernelRecognizer):
            least = self._taught.accept_probability
        self._judged.append(Heard(gesture, clip, least))
        return gesture


class _TappedModel(StreamModel):
    """A model of streams whose looks are kept."""

    def __init__(self, *parts: object) -> None:
        *model, judged = parts
        super().__init__(*model)  # type: ignore[arg-type]
        object.__setattr__(self, "_judged", judged)

    def look(
        self, hypothesis: Hypothesis, clip: Clip, memory: Memory, glimpse: Glimpse | None = None
    ) -> Look:
        look = super().look(hypothesis, clip, memory, glimpse)
        least = self.thresholds.at_rest if look.resting else self.thresholds.going_on
        gesture = Gesture(look.label, look.probability, reason=look.account)
        self._judged.append(Heard(gesture, clip, least, glimpse))  # type: ignore[attr-defined]
        return look


__all__ = ["Heard", "Overhearing", "parts_of"]
