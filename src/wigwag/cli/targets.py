"""Where a command writes: found out before its work, not after it."""

from __future__ import annotations

import os
from pathlib import Path

from wigwag.errors import InputError


def make_folder(path: Path, option: str) -> None:
    """Make a folder that files will be written into.

    Args:
        path: The folder; it may be there already.
        option: What names it on the command line, such as ``--out``.

    Raises:
        InputError: If it cannot be made, or nothing can be written into it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{option} {path}: cannot be made a folder ({error.strerror}). Name another."
        ) from error
    if not os.access(path, os.W_OK):
        raise InputError(f"{option} {path}: nothing can be written there. Name another folder.")


def check_file(path: Path, option: str) -> None:
    """Look whether a file can be written, and make the folder that it goes into. An old file stays.

    Args:
        path: The file.
        option: What names it on the command line, such as ``--output``.

    Raises:
        InputError: If it is a folder, or cannot be written.
    """
    if path.is_dir():
        raise InputError(f"{option} {path}: is a folder. Name a file.")
    make_folder(path.parent, option)


__all__ = ["check_file", "make_folder"]
