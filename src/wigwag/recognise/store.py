"""Fitted recognisers on disk: one zip file of arrays and JSON, versioned and checked, never a pickle."""

from __future__ import annotations

import hashlib
import io
import json
import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, is_dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.errors import InputError, ModelError
from wigwag.features import Normalisation, Preparation

FORMAT = "wigwag recogniser"
VERSION = 1
_VALUES = {"Preparation": Preparation, "Normalisation": Normalisation}


def plain(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Turn constructor parameters into what JSON knows."""
    return {
        key: {"type": type(value).__name__, **asdict(value)}
        if is_dataclass(value) and not isinstance(value, type)
        else value
        for key, value in parameters.items()
    }


def revived(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Turn what ``plain`` gave back into constructor parameters."""
    result: dict[str, Any] = {}
    for key, value in parameters.items():
        if isinstance(value, dict):
            fields = dict(value)
            result[key] = _VALUES[fields.pop("type")](**fields)
        else:
            result[key] = tuple(value) if isinstance(value, list) else value
    return result


def write(
    path: str | PathLike[str], kind: str, facts: Mapping[str, Any], arrays: Mapping[str, np.ndarray]
) -> None:
    """Write a model beside its place and move it there in one step, so that no half file is ever seen."""
    target = Path(path)
    members = {"facts.json": json.dumps(facts, indent=1, sort_keys=True).encode()}
    for name, array in arrays.items():
        buffer = io.BytesIO()
        np.save(buffer, np.ascontiguousarray(array), allow_pickle=False)
        members[f"{name}.npy"] = buffer.getvalue()
    header = {"format": FORMAT, "version": VERSION, "recogniser": kind, "sha256": _digest(members)}
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(handle, "wb") as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("header.json", json.dumps(header, indent=1))
            for name, content in members.items():
                archive.writestr(name, content)
        os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def read(
    path: str | PathLike[str], kind: str, leave: str | None = None
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Read what ``write`` wrote, and check that it is what it says.

    Args:
        path: The file.
        kind: Name of the recogniser that it should hold.
        leave: Arrays whose names begin so are checked, but not kept.

    Raises:
        ModelError: If the file is missing, damaged, of another version, or holds another recogniser.
    """
    with _opened(path) as archive:
        with explained(path):
            header = json.loads(archive.read("header.json"))
            found, version, recogniser = header["format"], header["version"], header["recogniser"]
            digest = header["sha256"]
        if found != FORMAT:
            raise ModelError(f"{path}: expected a '{FORMAT}', but the file says {found!r}.")
        if version != VERSION:
            raise ModelError(
                f"{path}: format version {version}, but this wigwag reads version {VERSION}. "
                "Fit the recogniser and save it again."
            )
        computed, arrays, facts = hashlib.sha256(), {}, b""
        for name in sorted(set(archive.namelist()) - {"header.json"}):
            # One by one, so that no more than one array is in memory twice.
            content = archive.read(name)
            _add(computed, name, content)
            if name == "facts.json":
                facts = content
            elif leave is None or not name.startswith(leave):
                arrays[name] = content
        del content
        if digest != computed.hexdigest():
            raise ModelError(f"{path}: damaged, its SHA-256 does not match. Save the recogniser again.")
        if recogniser != kind:
            raise ModelError(f"{path}: holds a {recogniser}, but {kind}.load was asked for a {kind}.")
        with explained(path):
            return json.loads(facts), {
                name.removesuffix(".npy"): np.load(io.BytesIO(arrays.pop(name)), allow_pickle=False)
                for name in list(arrays)
            }


def kind_of(path: str | PathLike[str]) -> str:
    """Return the name of the recogniser that a file holds.

    Raises:
        ModelError: If the file is missing, damaged, or none that ``write`` wrote.
    """
    with _opened(path) as archive, explained(path):
        return str(json.loads(archive.read("header.json"))["recogniser"])


@contextmanager
def _opened(path: str | PathLike[str]) -> Iterator[zipfile.ZipFile]:
    """Open a model file; say of anything that goes wrong in reading it that it is damaged."""
    try:
        with zipfile.ZipFile(path) as archive:
            yield archive
    except ModelError:
        raise
    except FileNotFoundError as error:
        raise ModelError(
            f"{path}: there is no such model file. Fit a recogniser and save it there."
        ) from error
    except (zipfile.BadZipFile, OSError, EOFError, ValueError) as error:
        raise ModelError(
            f"{path}: not a model file, or damaged ({error}). Save the recogniser again."
        ) from error
    except Exception as error:  # zlib.error and others of the decompressors share no base
        raise ModelError(f"{path}: damaged ({error}). Save the recogniser again.") from error


@contextmanager
def explained(path: str | PathLike[str]) -> Iterator[None]:
    """Say of anything that goes wrong inside that the model file does not hold what it should."""
    try:
        yield
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, InputError) as error:
        raise ModelError(
            f"{path}: does not hold what a '{FORMAT}' of version {VERSION} should "
            f"({type(error).__name__}: {error}). Save the recogniser again."
        ) from error


def _digest(members: Mapping[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name in sorted(members):
        _add(digest, name, members[name])
    return digest.hexdigest()


def _add(digest: Any, name: str, content: bytes) -> None:
    digest.update(f"{name} {len(content)}\n".encode())
    digest.update(content)
