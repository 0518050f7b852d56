"""A model's file becomes the student that can learn on, whichever kind of model it holds."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from wigwag.errors import ModelError
from wigwag.recognise import KernelRecognizer
from wigwag.recognise.store import kind_of
from wigwag.stream.gesture_stream import StreamModel
from wigwag.teach.stream_student import StreamStudent
from wigwag.teach.student import KernelStudent, Student


def open_student(path: str | PathLike[str]) -> Student:
    """Read a model that can learn on.

    Raises:
        ModelError: If the file is missing, damaged, or holds a model that cannot learn on.
    """
    kind = kind_of(path)
    if kind == KernelRecognizer.__name__:
        return KernelStudent(KernelRecognizer.load(path))
    if kind == StreamModel.__name__:
        return StreamStudent.load(path)
    raise ModelError(
        f"{Path(path)}: holds a {kind}, which cannot learn on. Teach a KernelRecognizer or a StreamModel: "
        "wigwag train CLIPS -o MODEL."
    )


__all__ = ["open_student"]
