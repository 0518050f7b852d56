"""A stream of poses becomes gestures: ``GestureStream``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

from wigwag.gesture import Gesture
from wigwag.recognise import store
from wigwag.skeleton import Clip, Pose
from wigwag.stream.config import StreamConfig
from wigwag.stream.glance import Glance, Glances, Glimpse
from wigwag.stream.prefix import Memory, PrefixModel
from wigwag.stream.speaker import Look, Speaker, Thresholds
from wigwag.stream.sureness import Sureness
from wigwag.stream.watcher import Hypothesis, WatchConfig, Watcher

TAUGHT = "taught_"
"""Arrays whose names begin so are what a model was taught from; deciding does not need them."""


@dataclass(frozen=True, slots=True)
class StreamModel:
    """What :func:`~wigwag.stream.teach.teach_stream` has learned; any number of streams are heard with it."""

    prefixes: PrefixModel
    sureness: Sureness
    thresholds: Thresholds
    config: StreamConfig
    glance: Glance | None = None
    """The second view; ``None``: none was taught."""

    def stream(self) -> GestureStream:
        """Begin a stream."""
        return GestureStream(self)

    def look(
        self, hypothesis: Hypothesis, clip: Clip, memory: Memory, glimpse: Glimpse | None = None
    ) -> Look:
        """Say what a stretch is most like, and how sure that is; ``glimpse``: what the second view sees."""
        decided, signs, nearest = self.prefixes.read(hypothesis, clip, memory, glimpse)
        label, nearness = self.prefixes.labels[decided], float(signs[4])
        times = math.exp(-nearness)
        return Look(
            label,
            float(self.sureness.probability(signs)),
            float(signs[3]),
            hypothesis.onset_ns,
            hypothesis.now_ns,
            hypothesis.resting,
            times > self.prefixes.limits[decided],
            f"nearest example {self.prefixes.names[nearest]} at {times:.2f} times the usual distance",
            self.prefixes.usual_s(decided),
        )

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to one file of arrays and JSON."""
        facts: dict[str, Any] = {
            "prefixes": self.prefixes.facts(),
            "thresholds": [self.thresholds.going_on, self.thresholds.at_rest],
            "commands": self.config.commands,
            "earliness": self.config.earliness,
            "false_per_hour": self.config.false_per_hour,
            "postures": self.config.watch.motion.postures,
        }
        arrays = self.prefixes.arrays() | self.sureness.arrays()
        store.write(path, "StreamModel", facts, arrays | (self.glance.arrays() if self.glance else {}))

    @classmethod
    def load(cls, path: str | PathLike[str]) -> StreamModel:
        """Read a model that ``save`` wrote.

        Raises:
            ModelError: If the file is missing, damaged, of another version, or holds something else.
        """
        facts, arrays = store.read(path, cls.__name__, leave=TAUGHT)
        with store.explained(path):
            commands = facts["commands"]
            watch = WatchConfig()
            watch = replace(watch, motion=replace(watch.motion, postures=bool(facts["postures"])))
            config = StreamConfig(
                None if commands is None else tuple(commands),
                float(facts["earliness"]),
                float(facts["false_per_hour"]),
                watch,
            )
            return cls(
                PrefixModel.restored(facts["prefixes"], arrays),
                Sureness.restored(arrays),
                Thresholds(*map(float, facts["thresholds"])),
                config,
                Glance.restored(arrays),
            )


class GestureStream:
    """Finds gestures in a stream of poses, names each once, as early as it can be sure.

    Args:
        model: What was taught.
        config: What may be spoken and how early; ``None``: as it was taught.

    Example: see :func:`~wigwag.stream.teach.teach_stream`.
    """

    def __init__(self, model: StreamModel, config: StreamConfig | None = None) -> None:
        self.model = model
        self.config = config or model.config
        self._watcher = Watcher(self.config.watch)
        self._glances = None if model.glance is None else Glances(model.glance)
        self._begin()

    def _begin(self) -> None:
        self._speaker = Speaker(self.config, self.model.thresholds)
        self._memory = Memory.empty()
        self._best: Look | None = None

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self._watcher.reset()
        if self._glances is not None:
            self._glances.reset()
        self._begin()

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose and return a gesture when one has been decided.

        Returns:
            A gesture with a label, once a gesture; or one with ``label=None`` and a reason when a movement
            ended that is no command; ``None`` as long as there is nothing to say.
        """
        if pose is None:
            return None
        hypothesis = self._watcher.update(pose)
        glimpse = None if self._glances is None else self._glances.update(self._watcher.ticks)
        if hypothesis is None:
            return self._refuse(pose.stamp_ns)
        look = self.model.look(hypothesis, self._watcher.clip(hypothesis), self._memory, glimpse)
        said = self._speaker.hear(look)
        if said is not None:
            self._watcher.block(self._speaker.blocked_ns)
            self._best = None
            return Gesture(said.label, said.probability, *said.span_ns, pose.stamp_ns, said.account)
        if self._best is None or look.probability >= self._best.probability:
            self._best = look
        return None

    def _refuse(self, now_ns: int) -> Gesture | None:
        """Say that a movement is over which was no command."""
        best = self._best
        if best is None or not self._watcher.motion.resting:
            return None
        self._best = None
        if best.onset_ns < self._speaker.blocked_ns:
            return None
        return Gesture(None, best.probability, best.onset_ns, best.now_ns, now_ns, self._reason(best))

    def _reason(self, best: Look) -> str:
        least = self.model.thresholds.at_rest
        if not self._speaker.may(best.label):
            return f"most like {best.label}, which is no command; {best.account}"
        if best.far:
            return f"unlike every enrolled example of {best.label}; {best.account}"
        return f"not sure of {best.label}: {best.probability:.3f} < {least:.3f}; {best.account}"


__all__ = ["GestureStream", "StreamConfig", "StreamModel"]
