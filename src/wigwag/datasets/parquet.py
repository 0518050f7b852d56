"""Clips as one Parquet table, as pandas and Polars users expect it: one row a frame, one column a number.

Columns: ``clip`` (number of the clip in the file), ``name``, ``label``, ``subject`` (text or null),
``frame`` (0, 1, ...), ``stamp_ns`` (int64), and ``nose_x`` to ``right_heel_z`` (float64, metres, camera
optical frame). The table's metadata holds under ``wigwag`` a JSON header with format, version, frame and
units. Numbers are kept exactly. Needs the extra ``parquet``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int

from wigwag.datasets.folder import FRAME, UNITS
from wigwag.datasets.notes import Notes
from wigwag.datasets.staged import staged_file
from wigwag.errors import DataError, InputError
from wigwag.extras import load
from wigwag.skeleton import LANDMARKS, N_LANDMARKS, Clip

FORMAT = "wigwag-clips"
VERSION = 1
COLUMNS: tuple[str, ...] = tuple(f"{landmark}_{axis}" for landmark in LANDMARKS for axis in "xyz")
"""The columns of coordinates, in order."""

_KEYS = ("clip", "name", "label", "subject")
_ROWS_A_GROUP = 100_000
"""About 32 MB of coordinates: what is held in memory while a file is written."""


@contextmanager
def write_parquet(path: str | Path, overwrite: bool = False) -> Iterator[Callable[[Clip], None]]:
    """Open a file to add clips to; it appears whole at the end, or not at all.

    Args:
        path: The file to write.
        overwrite: Whether a file of that name may be replaced.

    Yields:
        A function that adds one clip.

    Raises:
        InputError: If the file is there and ``overwrite`` is false, or it cannot be written.
        MissingExtraError: If pyarrow is not installed.
    """
    arrow, parquet = _arrow()
    schema = _schema(arrow)
    with staged_file(Path(path), overwrite) as beside, parquet.ParquetWriter(str(beside), schema) as writer:
        waiting: list[Any] = []
        count = rows = 0

        def flush() -> None:
            nonlocal rows
            if waiting:
                writer.write_table(arrow.Table.from_batches(waiting, schema))
            waiting.clear()
            rows = 0

        def add(clip: Clip) -> None:
            nonlocal count, rows
            waiting.append(_batch(arrow, schema, clip, count))
            count += 1
            rows += len(clip)
            if rows >= _ROWS_A_GROUP:
                flush()

        yield add
        flush()


def read_parquet(path: str | Path, notes: Notes | None = None) -> Iterator[Clip]:
    """Yield the clips of a file, in the order in which they begin.

    Rows may stand in any order; a clip's rows are sorted by ``frame``. A file that another program wrote
    anew, and that lost its header thereby, is read if it has all columns.

    Args:
        path: The file.
        notes: Takes what is left out and why; ``None``: the first fault is raised.

    Raises:
        DataError: If the file is missing, damaged, no table of clips, or of a newer version.
        MissingExtraError: If pyarrow is not installed.
    """
    path = Path(path)
    table = _table(path)
    if not _has_header(path, table) and notes is not None:
        notes.repaired.append((path.name, f"has no header of wigwag's; read as version {VERSION}"))
    columns = {name: _numbers(path, table, name) for name in ("frame", "stamp_ns")}
    joints = np.stack([_numbers(path, table, name) for name in COLUMNS], axis=1, dtype=np.float64)
    names = {key: table.column(key).to_pylist() for key in _KEYS}
    for rows in _groups(list(zip(*names.values(), strict=True)), columns["frame"]):
        label, subject = (names[key][rows[0]] for key in ("label", "subject"))
        name = str(names["name"][rows[0]] or "clip")
        try:
            for field, value in (("label", label), ("subject", subject)):
                if not isinstance(value, str | None):
                    raise InputError(f"{field} must be text or null, but got {value!r}.")
            frames = joints[rows].reshape(-1, N_LANDMARKS, 3)
            yield Clip(frames, columns["stamp_ns"][rows], label, subject, name)
        except InputError as error:
            reason = str(error).removeprefix(f"{name}: ")
            if notes is None:
                raise DataError(f"{path}: clip {name}: {reason}") from error
            notes.left_out.append((f"{path.name}: clip {name}", reason))


def _arrow() -> tuple[Any, Any]:
    what = "Reading and writing Parquet"
    return load("pyarrow", "parquet", what), load("pyarrow.parquet", "parquet", what)


def _schema(arrow: Any) -> Any:
    header = {
        "format": FORMAT,
        "version": VERSION,
        "frame": FRAME,
        "units": UNITS,
        "landmarks": list(LANDMARKS),
    }
    fields = [("clip", arrow.int64(), False), ("name", arrow.string(), False)]
    fields += [("label", arrow.string(), True), ("subject", arrow.string(), True)]
    fields += [("frame", arrow.int64(), False), ("stamp_ns", arrow.int64(), False)]
    fields += [(name, arrow.float64(), False) for name in COLUMNS]
    return arrow.schema(
        [arrow.field(name, kind, nullable=nullable) for name, kind, nullable in fields],
        metadata={"wigwag": json.dumps(header)},
    )


def _batch(arrow: Any, schema: Any, clip: Clip, number: int) -> Any:
    rows = len(clip)
    flat = np.ascontiguousarray(np.asarray(clip.joints, np.float64).reshape(rows, -1).T)
    arrays = [
        arrow.array(np.full(rows, number, np.int64)),
        arrow.array([clip.name] * rows, arrow.string()),
        arrow.array([clip.label] * rows, arrow.string()),
        arrow.array([clip.subject] * rows, arrow.string()),
        arrow.array(np.arange(rows, dtype=np.int64)),
        arrow.array(np.asarray(clip.stamps_ns, np.int64)),
        *(arrow.array(column) for column in flat),
    ]
    return arrow.RecordBatch.from_arrays(arrays, schema=schema)


def _table(path: Path) -> Any:
    arrow, parquet = _arrow()
    try:
        table = parquet.read_table(str(path), partitioning=None)
    except FileNotFoundError as error:
        raise DataError(f"{path}: no such file.") from error
    except (OSError, arrow.ArrowException) as error:
        raise DataError(f"{path}: is no readable Parquet file ({error}). Write or fetch it again.") from error
    if absent := [name for name in (*_KEYS, "frame", "stamp_ns", *COLUMNS) if name not in table.column_names]:
        raise DataError(
            f"{path}: lacks the column {absent[0]!r} and {len(absent) - 1} more; it holds "
            f"{', '.join(table.column_names[:8])}. Expected a table as wigwag clips convert writes it."
        )
    return table


def _has_header(path: Path, table: Any) -> bool:
    """Check the header; without one (pandas drops what it does not know) the columns speak for themselves."""
    raw = (table.schema.metadata or {}).get(b"wigwag")
    if raw is None:
        return False
    try:
        header = json.loads(raw)
        found, version = header["format"], header["version"]
    except (ValueError, KeyError, TypeError) as error:
        raise DataError(
            f"{path}: the metadata 'wigwag' is no header of a table of clips ({error!r})."
        ) from error
    if found != FORMAT:
        raise DataError(f"{path}: format must be {FORMAT!r}, but got {found!r}.")
    if not isinstance(version, int) or not 1 <= version <= VERSION:
        raise DataError(
            f"{path}: version is {version!r}, but this wigwag reads versions up to {VERSION}. Update wigwag."
        )
    for field, expected in (("frame", FRAME), ("units", UNITS)):
        if header.get(field) != expected:
            raise DataError(f"{path}: {field} must be {expected!r}, but got {header.get(field)!r}.")
    return True


def _numbers(path: Path, table: Any, name: str) -> np.ndarray[Any, Any]:
    values = table.column(name).to_numpy()
    wanted = "iu" if name in {"frame", "stamp_ns"} else "fiu"
    if values.dtype.kind not in wanted:
        kind = "whole numbers without gaps" if wanted == "iu" else "numbers"
        raise DataError(
            f"{path}: column {name} must hold {kind}, but its type is {table.schema.field(name).type}."
        )
    return np.asarray(values)


def _groups(
    keys: list[tuple[Any, ...]], frame: Int[np.ndarray, " rows"]
) -> Iterator[Int[np.ndarray, " some"]]:
    """Yield the rows of each clip, sorted by frame. All four keys tell clips apart: tables get joined."""
    numbers: dict[tuple[Any, ...], int] = {}
    clip = np.array([numbers.setdefault(key, len(numbers)) for key in keys], np.int64)
    order = np.lexsort((frame, clip))
    yield from np.split(order, np.flatnonzero(np.diff(clip[order])) + 1) if len(order) else []


__all__ = ["COLUMNS", "FORMAT", "VERSION", "read_parquet", "write_parquet"]
