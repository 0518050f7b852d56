"""Every model that hears a stream, by its file alone."""

from __future__ import annotations

from os import PathLike

import numpy as np

from wigwag.errors import ModelError
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer, KernelRecognizer
from wigwag.recognise.store import kind_of
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamModel

Taught = StreamModel | KernelRecognizer | HeavyRecognizer | EncodedRecognizer

_KINDS: dict[
    str, type[StreamModel] | type[KernelRecognizer] | type[HeavyRecognizer] | type[EncodedRecognizer]
]
_KINDS = {kind.__name__: kind for kind in (StreamModel, KernelRecognizer, HeavyRecognizer, EncodedRecognizer)}


def load_model(path: str | PathLike[str]) -> tuple[Taught, tuple[str, ...]]:
    """Read a model, whatever it is.

    Returns:
        The model, and the labels that it may speak.

    Raises:
        ModelError: If the file is missing, damaged, or holds nothing that hears a stream.
    """
    name = kind_of(path)
    if name not in _KINDS:
        raise ModelError(f"{path}: holds a {name}, but expected one of {', '.join(_KINDS)}.")
    model = _KINDS[name].load(path)
    if not isinstance(model, StreamModel):
        return model, tuple(str(label) for label in model.classes_ if label is not None)
    spoken = model.config.commands if model.config.commands is not None else model.prefixes.labels
    return model, tuple(str(label) for label in spoken if label is not None)


def warm_up(model: Taught) -> None:
    """Let a model hear somebody who waves, once: so what it compiles at first use is there before a flight.

    The first gesture would otherwise be understood seconds late, and the loop that flies would wait for it.
    """
    stamps = np.arange(90, dtype=np.int64) * 33_333_333
    joints = np.zeros((len(stamps), 13, 3)) + _SOMEBODY
    joints[:, 4:7, 1] -= 0.4 * np.sin(stamps * 4e-9)[:, None]
    if not isinstance(model, StreamModel):
        model.recognise(Clip(joints, stamps))
        return
    stream = model.stream()
    for body, stamp_ns in zip(joints, stamps, strict=True):
        stream.update(Pose(body, np.ones(13), int(stamp_ns)))


_SOMEBODY = np.array([
    [0, -0.75, 4], [0.2, -0.5, 4], [-0.2, -0.5, 4], [0.25, -0.2, 4], [-0.25, -0.2, 4], [0.25, 0.05, 4],
    [-0.25, 0.05, 4], [0.12, 0, 4], [-0.12, 0, 4], [0.12, 0.45, 4], [-0.12, 0.45, 4], [0.12, 0.9, 4],
    [-0.12, 0.9, 4],
])  # fmt: skip
"""A standing person's 13 landmarks, camera optical frame, metres."""

__all__ = ["Taught", "load_model", "warm_up"]
