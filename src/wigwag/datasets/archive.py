"""One way to read recordings, whether they lie in a folder or in the zip file they came in."""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.errors import DataError


@dataclass(frozen=True, slots=True)
class Archive:
    """The files of a folder, or the members of a zip file, by their base name."""

    path: Path
    """The folder or the zip file; error messages name it."""
    files: dict[str, str]
    """Base name to the path within ``path``."""
    zipped: zipfile.ZipFile | None = None
    """The open zip file; ``None`` for a folder."""

    def read(self, name: str) -> bytes:
        """Return a file's bytes.

        Raises:
            DataError: If the file is not there or cannot be read; the message names it.
        """
        if name not in self.files:
            raise DataError(f"{name}: not found in {self.path}. Fetch the data set again, or leave it out.")
        try:
            if self.zipped is None:
                return (self.path / self.files[name]).read_bytes()
            return self.zipped.read(self.files[name])
        except (OSError, zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError) as error:
            raise DataError(
                f"{name}: cannot be read from {self.path} ({error}). Fetch the file again."
            ) from error


@contextmanager
def open_archive(
    path: str | Path, folder: str, zip_names: Sequence[str], pattern: re.Pattern[str], hint: str
) -> Iterator[Archive]:
    """Open a data set wherever its files lie.

    Args:
        path: The zip file itself, a folder that has ``folder`` or one of ``zip_names`` in it, or the
            folder of the files.
        folder: The official name of the folder of the files, such as ``"Skeleton"``.
        zip_names: Official names of the zip file, the preferred one first.
        pattern: What a base name must match for the file to count.
        hint: What to do when there is nothing, appended to the error message.

    Raises:
        DataError: If nothing is there, or the zip file is none.
    """
    path = Path(path)
    if path.is_file():
        zip_path: Path | None = path
    elif path.is_dir():
        zip_path = next((path / name for name in zip_names if (path / name).is_file()), None)
    else:
        raise DataError(f"{path}: no such file or folder. {hint}")
    root = path / folder if (path / folder).is_dir() else path
    if zip_path is None or (path.is_dir() and root != path):
        files = {p.name: p.name for p in root.iterdir() if pattern.fullmatch(p.name)}
        if not files:
            raise DataError(f"{path}: holds none of {folder}/, {', '.join(zip_names)}. {hint}")
        yield Archive(root, files)
        return
    try:
        zipped = zipfile.ZipFile(zip_path)
    except (OSError, zipfile.BadZipFile) as error:
        raise DataError(f"{zip_path}: is not a readable zip file ({error}). {hint}") from error
    with zipped:
        files = {Path(n).name: n for n in zipped.namelist() if pattern.fullmatch(Path(n).name)}
        if not files:
            raise DataError(f"{zip_path}: holds no file of the form {pattern.pattern}. {hint}")
        yield Archive(zip_path, files, zipped)


def read_mat(data: bytes, variable: str, name: str) -> np.ndarray[Any, Any]:
    """Read one numeric array out of the bytes of a MATLAB 5 file.

    Args:
        data: The file's content.
        variable: The name of the array.
        name: The file's name, for error messages.

    Raises:
        DataError: If the bytes are no MATLAB file, the variable is absent or it holds no numbers.
    """
    from scipy.io import loadmat

    try:
        content = loadmat(io.BytesIO(data), variable_names=[variable])
        found = sorted(k for k in content if not k.startswith("__"))
    except Exception as error:  # a damaged file makes scipy raise nearly anything
        raise DataError(f"{name}: is no readable MATLAB file ({error}). Fetch the file again.") from error
    if variable not in content:
        raise DataError(
            f"{name}: has no variable {variable!r}, which is expected there{_others(data, found)}. "
            "Fetch the file again."
        )
    array = np.asarray(content[variable])
    if array.dtype.kind not in "fiu":
        raise DataError(f"{name}: {variable} must hold real numbers, but its type is {array.dtype}.")
    return array


def _others(data: bytes, found: list[str]) -> str:
    """Name the variables that a file holds instead, for an error message."""
    from scipy.io import whosmat

    try:
        found = found or [entry[0] for entry in whosmat(io.BytesIO(data))]
    except Exception:  # the message is only longer by this
        return ""
    return f"; it holds {', '.join(found)}" if found else "; it is empty"


__all__ = ["Archive", "open_archive", "read_mat"]
