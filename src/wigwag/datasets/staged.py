"""Output that appears whole or not at all: written beside its place, then moved there."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wigwag.errors import InputError


@contextmanager
def staged_file(path: Path, overwrite: bool = False) -> Iterator[Path]:
    """Give a place to write a file to; move it to ``path`` at the end, or remove it after a failure.

    Args:
        path: Where the file is to be.
        overwrite: Whether a file may be there already.

    Raises:
        InputError: If there is a file and ``overwrite`` is false, ``path`` is a folder, or it cannot be
            written.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder, but a file is to be written. Give a file name.")
    if path.exists() and not overwrite:
        raise InputError(f"{path}: is there already; choose another name or pass --overwrite.")
    with _folder_beside(path) as beside:
        yield beside / path.name
        _moved(beside / path.name, path)


@contextmanager
def staged_folder(path: Path, overwrite: bool = False) -> Iterator[Path]:
    """Give a folder to write files to; at the end it becomes ``path``, or its files join those there.

    Files that are in ``path`` already and not written anew stay as they are.

    Args:
        path: Where the folder is to be.
        overwrite: Whether files of the same names may be replaced.

    Raises:
        InputError: If a file of the same name is there and ``overwrite`` is false, ``path`` is a file, or it
            cannot be written. Then nothing in ``path`` has changed.
    """
    if path.exists() and not path.is_dir():
        raise InputError(f"{path}: is a file, but a folder is to be written. Give a folder's name.")
    with _folder_beside(path) as beside:
        made = beside / path.name
        made.mkdir()
        yield made
        if not path.exists():
            _moved(made, path)
            return
        files = sorted(p.relative_to(made) for p in made.rglob("*") if p.is_file())
        there = [file for file in files if (path / file).exists()]
        if there and not overwrite:
            raise InputError(
                f"{path}: holds {there[0]}{_more(len(there) - 1)} already; "
                "choose another folder or pass --overwrite."
            )
        for file in files:
            _moved(made / file, path / file)


@contextmanager
def _folder_beside(path: Path) -> Iterator[Path]:
    """Make a hidden folder next to ``path``, on the same disk, so that moving is one step."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent))
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}).") from error
    try:
        yield beside
    except OSError as error:  # the disk is full
        raise InputError(f"{path}: cannot be written ({error.strerror or error}).") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _moved(made: Path, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if made.is_file():
        with made.open("rb+") as file:  # on the disk before it has its name: a power cut leaves no empty file
            os.fsync(file.fileno())
    os.replace(made, path)


def _more(count: int) -> str:
    return f" and {count} more of the files" if count else ""


__all__ = ["staged_file", "staged_folder"]
