"""Benchmark files: a JSON list of flat records, each with the command, seed and version that remake it."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import shlex
from contextlib import suppress
from errno import EISDIR
from pathlib import Path
from typing import Any

from wigwag.errors import InputError


class Records:
    """Gathers the records of one benchmark and keeps its file up to date.

    The file is written whole after every record, so that a long run that is cut keeps its results.

    Args:
        path: Where the JSON list goes; ``None``: nowhere.
        command: What to type to run this benchmark again.
        seed: The first seed; every random choice follows from it. ``None``: nothing is chosen.

    Raises:
        InputError: If the path is a folder or cannot be written.
    """

    def __init__(self, path: Path | None, command: str, seed: int | None) -> None:
        from wigwag import __version__

        self.rows: list[dict[str, Any]] = []
        self._path = path
        self._common = {"command": command, "seed": seed, "version": __version__}
        if path is not None:
            self._replace("", keep=False)  # found out before the work, not after it; an old file stays

    def add(self, **fields: Any) -> dict[str, Any]:
        """Add one record and write the file."""
        row = {key: _plain(key, value) for key, value in fields.items()} | self._common
        self.rows.append(row)
        self._write()
        return row

    def _write(self) -> None:
        if self._path is not None:
            self._replace(json.dumps(self.rows, indent=2) + "\n")

    def _replace(self, text: str, keep: bool = True) -> None:
        """Write beside the file and move it there in one step; without ``keep``, only try to write."""
        assert self._path is not None
        half_written = self._path.with_name(f".{self._path.name}.part")
        try:
            if self._path.is_dir():
                raise IsADirectoryError(EISDIR, "is a folder")
            self._path.parent.mkdir(parents=True, exist_ok=True)
            half_written.write_text(text, encoding="utf-8")
            if keep:
                os.replace(half_written, self._path)
        except OSError as error:
            raise InputError(f"{self._path}: cannot be written ({error.strerror}).") from error
        finally:
            with suppress(OSError):
                half_written.unlink(missing_ok=True)


def command_line(name: str, options: Any) -> str:
    """Rebuild the command from a dataclass of options: what differs from the defaults.

    Example:
        >>> from dataclasses import dataclass
        >>> @dataclass
        ... class Options:
        ...     data: str
        ...     seeds: int = 10
        ...     fast: bool = False
        >>> command_line("wigwag benchmark x", Options("my data", fast=True))
        "wigwag benchmark x --data 'my data' --fast"
    """
    words = shlex.split(name)
    for field in dataclasses.fields(options):
        value = getattr(options, field.name)
        if value == field.default:
            continue
        option = f"--{field.name.replace('_', '-')}"
        if isinstance(value, bool):
            words.append(option if value else option.replace("--", "--no-", 1))
        else:
            words.extend([option, *([str(v) for v in value] if isinstance(value, tuple) else [str(value)])])
    return shlex.join(words)


def _plain(key: str, value: Any) -> Any:
    """Turn numpy numbers into Python's; what JSON cannot hold (NaN, infinity) becomes null."""
    if hasattr(value, "item") and not isinstance(value, str):
        value = value.item()
    if isinstance(value, list | tuple):
        return [_plain(key, v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | int | bool):
        return value
    raise TypeError(f"record field {key!r} holds a {type(value).__name__}; records are flat.")


__all__ = ["Records", "command_line"]
