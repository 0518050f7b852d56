"""A model of streams that learns on: it keeps the streams that it was taught from, and is taught again."""

from __future__ import annotations

import copy
import zlib
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import Any, Self

import numpy as np

from wigwag.errors import InputError, ModelError
from wigwag.features.augment import Augmentation
from wigwag.recognise import store
from wigwag.recognise.similarity import Similarities
from wigwag.skeleton import Clip
from wigwag.stream.assemble import assemble
from wigwag.stream.config import StreamConfig
from wigwag.stream.gesture_stream import TAUGHT, StreamModel
from wigwag.stream.lesson import Lesson, Origin
from wigwag.stream.teach import lesson_streams
from wigwag.stream.truth import LabelledStream, Showing
from wigwag.teach.student import Student

_AGAIN = 6
"""As so many people, all of them varied copies, does one person teach: how sure to be is learned from people
who are left out, and somebody alone cannot be."""


class StreamStudent(Student):
    """A model of streams beside the streams that taught it; every change teaches it anew, in two minutes.

    Args:
        model: What was learned from ``streams``.
        streams: What it was taught from.
        seed: Of the teaching.
    """

    def __init__(self, model: StreamModel, streams: Sequence[LabelledStream], seed: int = 0) -> None:
        self._model, self._streams, self._seed = model, list(streams), seed

    @classmethod
    def taught(
        cls,
        clips: Sequence[Clip],
        streams: Sequence[LabelledStream] = (),
        config: StreamConfig | None = None,
        *,
        seed: int = 0,
        origin: Origin = "drift",
    ) -> Self:
        """Teach one from clips and streams; see :func:`~wigwag.stream.teach.teach_stream`."""
        everything = lesson_streams(clips, (), streams, seed)
        if not any(one.showings for one in everything):
            raise InputError("There is nothing to teach: no clip has a label.")
        return cls(Lesson(everything, origin, seed).learn(config or StreamConfig()), everything, seed)

    @property
    def model(self) -> StreamModel:
        """What decides."""
        return self._model

    @property
    def known(self) -> tuple[str, ...]:
        """Every gesture."""
        return self._model.prefixes.labels

    @property
    def spoken(self) -> tuple[str, ...]:
        """Those that it may answer with."""
        commands = self._model.config.commands
        return self.known if commands is None else commands

    def examples(self) -> list[tuple[str, str]]:
        """Return label and name of each reference."""
        prefixes = self._model.prefixes
        return [
            (self.known[number], name) for number, name in zip(prefixes.numbers, prefixes.names, strict=True)
        ]

    def enrol(self, label: str, clips: Sequence[Clip]) -> Self:
        """Add a gesture or examples; see :class:`Student`."""
        if not clips or not label:
            raise InputError(f"enrol needs a name and at least one clip, but got {label!r} and {len(clips)}.")
        rng = np.random.default_rng([self._seed, len(self._streams), zlib.crc32(label.encode())])
        vary, whole = Augmentation(crop=0.0), [replace(clip, label=label) for clip in clips]
        background = [one.stream for one in self._streams if not one.showings]
        added = []
        for number in range(_AGAIN):
            subject = f"{clips[0].subject or 'somebody'} again {number}"
            again = [replace(vary.apply(clip, rng), subject=subject) for clip in whole]
            added.append(assemble(again, background, rng))
        commands = self._model.config.commands
        if commands is not None and label not in commands:
            commands = (*commands, label)
        return self._learn([*self._streams, *added], commands)

    def forget(self, label: str) -> Self:
        """Take a gesture away: streams that show nothing else go, in others it is no gesture any more."""
        self._check_known(label)
        if len(self.known) == 1:
            raise InputError(f"{label!r} is the only gesture; a model without any is none.")
        kept = []
        for one in self._streams:
            rest = tuple(showing for showing in one.showings if showing.label != label)
            if rest or not one.showings:
                kept.append(replace(one, showings=rest))
        commands = self._model.config.commands
        if commands is not None:
            commands = tuple(command for command in commands if command != label)
        return self._learn(kept, commands)

    def rename(self, label: str, name: str) -> Self:
        """Give a gesture another name; nothing has to be learned for it."""
        self._check_name(label, name)
        named = {label: name}
        prefixes, config = copy.copy(self._model.prefixes), self._model.config
        prefixes.labels = tuple(named.get(known, known) for known in prefixes.labels)
        if config.commands is not None:
            commands = tuple(named.get(command, command) for command in config.commands)
            config = replace(config, commands=commands)
        self._model = replace(self._model, prefixes=prefixes, config=config)
        self._streams = [
            replace(
                one,
                showings=tuple(replace(s, label=named.get(s.label, s.label)) for s in one.showings),
            )
            for one in self._streams
        ]
        return self

    def save(self, path: str | PathLike[str]) -> None:
        """Write it, and what it was taught from, to one file."""
        self._model.save(path)
        facts, arrays = store.read(path, StreamModel.__name__)
        facts["taught"] = {"seed": self._seed, "streams": [_facts(one) for one in self._streams]}
        streams = [one.stream for one in self._streams]
        arrays[f"{TAUGHT}joints"] = np.concatenate([s.joints for s in streams]).astype(np.float32)
        arrays[f"{TAUGHT}stamps"] = np.concatenate([s.stamps_ns for s in streams])
        store.write(path, StreamModel.__name__, facts, arrays)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read what ``save`` wrote.

        Raises:
            ModelError: If the file is missing or damaged, or does not hold what the model was taught from.
        """
        model = StreamModel.load(path)
        facts, arrays = store.read(path, StreamModel.__name__)
        if "taught" not in facts:
            raise ModelError(
                f"{path}: holds a model of streams without what it was taught from, so that it cannot learn "
                "on. Teach it by wigwag train or wigwag teach."
            )
        with store.explained(path):
            joints, stamps = arrays[f"{TAUGHT}joints"], arrays[f"{TAUGHT}stamps"]
            streams, first = [], 0
            for one in facts["taught"]["streams"]:
                rows = slice(first, first + int(one["rows"]))
                first = rows.stop
                stream = Clip(
                    joints[rows].astype(np.float64), stamps[rows], None, one["subject"], str(one["name"])
                )
                streams.append(LabelledStream(stream, tuple(Showing(*shown[:3]) for shown in one["shown"])))
            return cls(model, streams, int(facts["taught"]["seed"]))

    def copy(self) -> Self:
        """Return one that learns on by itself."""
        return type(self)(self._model, self._streams, self._seed)

    def _learn(self, streams: Sequence[LabelledStream], commands: tuple[str, ...] | None) -> Self:
        origin: Origin = "drift" if self._model.prefixes.origin == "drift" else "start"
        config = replace(self._model.config, commands=commands)
        self._model = Lesson(streams, origin, self._seed).learn(config)
        self._streams = list(streams)
        return self

    def _parts(self) -> tuple[Similarities, np.ndarray, np.ndarray]:
        prefixes = self._model.prefixes
        return prefixes.similar, prefixes.numbers, prefixes.typical


def _facts(one: LabelledStream) -> dict[str, Any]:
    shown = [[s.label, s.onset_ns, s.end_ns] for s in one.showings]
    return {
        "rows": len(one.stream), "subject": one.stream.subject, "name": one.stream.name, "shown": shown
    }  # fmt: skip


__all__ = ["StreamStudent"]
