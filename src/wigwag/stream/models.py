"""Every model that hears a stream, by its file alone."""

from __future__ import annotations

from os import PathLike

from wigwag.errors import ModelError
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer, KernelRecognizer
from wigwag.recognise.store import kind_of
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


__all__ = ["Taught", "load_model"]
