"""A folder of clips brought to the current version of its format, each file whole at every moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from wigwag.datasets.folder import load_clip, read_content, text_of
from wigwag.datasets.staged import staged_file
from wigwag.datasets.versions import MIGRATIONS, VERSION, Step, upgraded
from wigwag.errors import DataError, InputError


@dataclass(frozen=True, slots=True)
class Migration:
    """What became of a folder's files; every path is relative to the folder."""

    current: list[str] = field(default_factory=list)
    """Files that are current, and checked to be whole."""
    migrated: list[str] = field(default_factory=list)
    """Files that were older and are current now."""
    refused: list[tuple[str, str]] = field(default_factory=list)
    """``(file, reason)``: newer, damaged, or no clips; left as they were."""


def migrate_folder(
    root: str | Path, steps: Mapping[int, Step] = MIGRATIONS, current: int = VERSION
) -> Migration:
    """Bring every clip below a folder to the current version and check every one.

    A file is replaced in one step, and only by a file that has been read back; what cannot be brought
    forward stays as it is.

    Args:
        root: The folder.
        steps: What turns each version into the next.
        current: The version wanted.

    Raises:
        DataError: If there is no such folder, or no ``*.json`` in it.
    """
    root = Path(root)
    if not root.is_dir():
        raise DataError(f"{root}: no such folder. Expected <label>/<name>.json in it, one file a clip.")
    done = Migration()
    paths = sorted(root.rglob("*.json"))
    if not paths:
        raise DataError(f"{root}: holds no *.json. Expected <label>/<name>.json, one file a clip.")
    for path in paths:
        name = str(path.relative_to(root))
        try:
            content = read_content(path)
            newer = upgraded(content, steps, current)
            if newer is content:
                load_clip(path)
                done.current.append(name)
                continue
            with staged_file(path, overwrite=True) as beside:
                beside.write_text(text_of(newer), encoding="utf-8")
                load_clip(beside)
            done.migrated.append(name)
        except InputError as error:
            done.refused.append((name, str(error).removeprefix(f"{path}: ")))
    return done


__all__ = ["Migration", "migrate_folder"]
