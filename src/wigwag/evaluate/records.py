"""Benchmark files: a JSON list of flat records, each with the command, seed and version that remake it."""

from __future__ import annotations

import dataclasses
import json
import math
import os
import shlex
from pathlib import Path
from typing import Any

from wigwag.errors import InputError


class Records:
    """Gathers the records of one benchmark and keeps its file up to date.

    The file is written whole after every record, so that a long run that is cut keeps its results.

    Args:
        path: Where the JSON list goes; ``None``: nowhere.
        command: What to type to run this benchmark again.
        seed: The first seed; every random choice follows from it.

    Raises:
        InputError: If the path is a folder or cannot be written.
    """

    def __init__(self, path: Path | None, command: str, seed: int) -> None:
        from wigwag import __version__

        self.rows: list[dict[str, Any]] = []
        self._path = path
        self._common = {"command": command, "seed": seed, "version": __version__}
        self._write()  # a place that cannot be written to is found out before the work, not after it

    def add(self, **fields: Any) -> dict[str, Any]:
        """Add one record and write the file."""
        row = {key: _plain(key, value) for key, value in fields.items()} | self._common
        self.rows.append(row)
        self._write()
        return row

    def _write(self) -> None:
        if self._path is None:
            return
        half_written = self._path.with_name(f".{self._path.name}.part")
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            half_written.write_text(json.dumps(self.rows, indent=2) + "\n", encoding="utf-8")
            os.replace(half_written, self._path)
        except OSError as error:
            half_written.unlink(missing_ok=True)
            raise InputError(f"{self._path}: cannot be written ({error.strerror}).") from error


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
