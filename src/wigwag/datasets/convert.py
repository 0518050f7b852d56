"""Recordings of one form written in another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from wigwag.datasets.formats import READERS, WRITERS, Options, reader_for, writer_for
from wigwag.datasets.notes import Notes
from wigwag.errors import DataError, InputError


@dataclass(frozen=True, slots=True)
class Conversion:
    """What was converted."""

    source_format: str
    """As in :data:`wigwag.datasets.formats.READERS`."""
    target_format: str
    """As in :data:`wigwag.datasets.formats.WRITERS`."""
    clips: int
    """How many were written."""
    frames: int
    """How many poses they hold."""
    notes: Notes = field(default_factory=Notes)
    """What was left out and what is not as it was, and why."""


def convert(
    source: str | Path,
    target: str | Path,
    *,
    source_format: str | None = None,
    target_format: str | None = None,
    overwrite: bool = False,
    options: Options | None = None,
    progress: Callable[[int], None] | None = None,
) -> Conversion:
    """Read recordings and write them in another form. The target appears whole or not at all.

    Args:
        source: File or folder.
        target: File or folder. A folder that is there keeps the files that are not written anew.
        source_format: A key of ``READERS``; ``None``: told by the files.
        target_format: A key of ``WRITERS``; ``None``: told by the target's ending; without one, a folder.
        overwrite: Whether files that are there may be replaced.
        options: What some readers have to be told.
        progress: Called with the number of clips written so far.

    Raises:
        InputError: If a form is unknown, or the target is there or cannot be written.
        DataError: If nothing of the source can be read.
        MissingExtraError: If Parquet is wanted and pyarrow is not installed.

    Example:
        >>> convert("clips", "clips.parquet", target_format="csv")
        Traceback (most recent call last):
        ...
        wigwag.errors.InputError: target format must be one of folder, parquet, bvh, but got 'csv'.
    """
    source, target = Path(source), Path(target)
    to = writer_for(target, target_format)
    come_from = reader_for(source, source_format)
    if source.resolve() == target.resolve():
        raise InputError(f"{target}: is the source as well. Choose another target.")
    notes = Notes()
    clips = frames = 0
    with WRITERS[to].open(target, overwrite, notes) as add:
        for clip in READERS[come_from].read(source, notes, options or Options()):
            add(clip)
            clips += 1
            frames += len(clip)
            if progress is not None:
                progress(clips)
        if not clips:
            gone = notes.left_out
            why = f"; first of {len(gone)} left out: {': '.join(gone[0])}" if gone else ""
            raise DataError(f"{source}: holds no usable clip{why}.")
    return Conversion(come_from, to, clips, frames, notes)


__all__ = ["Conversion", "convert"]
