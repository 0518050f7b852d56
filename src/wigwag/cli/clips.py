"""``wigwag clips``: recordings in other forms, and older ones brought forward."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from rich.console import Console


@dataclass(frozen=True)
class Convert:
    """Convert recordings between a folder of clips, Parquet, BVH, and data sets.

    Reads: folder (wigwag's clips), parquet, bvh, ntu (NTU RGB+D .skeleton), utd-mhad. Writes: folder,
    parquet, bvh. The target appears whole or not at all. What cannot be read is named and left out; the exit
    code is then 1.

    Example: wigwag clips convert UTD-MHAD/Skeleton.zip clips.parquet
    """

    source: tyro.conf.Positional[Path]
    """File or folder to read."""
    target: tyro.conf.Positional[Path]
    """File or folder to write: NAME.parquet, NAME.bvh (one clip), or a folder."""
    source_format: str | None = None
    """What the source is, if its files do not tell."""
    target_format: str | None = None
    """What to write, if the target's ending does not tell: bvh for a folder of BVH files."""
    overwrite: bool = False
    """Replace files that are there."""
    unit_m: float | None = None
    """Unit of length of BVH files in metres, such as 0.01; by default told by the length of the legs."""
    json: Path | None = None
    """File for a record of what was read, written, repaired and left out."""

    def run(self) -> int:
        """Convert; return 0, or 1 if something was left out."""
        from rich.console import Console

        from wigwag.datasets.convert import convert
        from wigwag.datasets.formats import Options
        from wigwag.evaluate.records import Records

        records = Records(self.json, shlex.join(["wigwag", "clips", "convert", *self._arguments()]), 0)
        errors = Console(stderr=True)
        with errors.status("converting") as status:
            done = convert(
                self.source,
                self.target,
                source_format=self.source_format,
                target_format=self.target_format,
                overwrite=self.overwrite,
                options=Options(unit_m=self.unit_m),
                progress=lambda count: status.update(f"converting: {count} clips"),
            )
        records.add(
            source=str(self.source),
            source_format=done.source_format,
            target=str(self.target),
            target_format=done.target_format,
            clips=done.clips,
            frames=done.frames,
            left_out=[list(item) for item in done.notes.left_out],
            repaired=[list(item) for item in done.notes.repaired],
        )
        _list(errors, done.notes.repaired, "not as recorded")
        _list(errors, done.notes.left_out, "left out")
        _say(Console(), f"{self.target}: {done.clips} clips, {done.frames} frames ({done.target_format})")
        return 1 if done.notes.left_out else 0

    def _arguments(self) -> list[str]:
        """Return what to type to convert the same again."""
        named = {
            "--source-format": self.source_format,
            "--target-format": self.target_format,
            "--unit-m": self.unit_m,
        }
        options = [part for name, value in named.items() if value is not None for part in (name, str(value))]
        return [str(self.source), str(self.target), *options, *(["--overwrite"] if self.overwrite else [])]


@dataclass(frozen=True)
class Migrate:
    """Bring a folder of clips to the current version of the format, in place, and check every file.

    Each file is replaced in one step by one that has been read back. What is damaged, newer or no clip is
    named and left as it is; the exit code is then 1.

    Example: wigwag clips migrate clips
    """

    folder: tyro.conf.Positional[Path]
    """Folder of clips: <label>/<name>.json, one file a clip."""
    json: Path | None = None
    """File for a record of what was current, migrated and refused."""

    def run(self) -> int:
        """Migrate; return 0, or 1 if a file could not be brought forward."""
        from rich.console import Console

        from wigwag.datasets.migrate import migrate_folder
        from wigwag.datasets.versions import VERSION
        from wigwag.evaluate.records import Records

        records = Records(self.json, shlex.join(["wigwag", "clips", "migrate", str(self.folder)]), 0)
        errors = Console(stderr=True)
        with errors.status("looking through the clips"):
            done = migrate_folder(self.folder)
        records.add(
            folder=str(self.folder),
            format_version=VERSION,
            current=len(done.current),
            migrated=done.migrated,
            refused=[list(item) for item in done.refused],
        )
        _list(errors, done.refused, "left as it is")
        counts = f"{len(done.current)} current, {len(done.migrated)} migrated, {len(done.refused)} refused"
        _say(Console(), f"{self.folder}: {counts} (version {VERSION})")
        return 1 if done.refused else 0


@dataclass(frozen=True)
class Clips:
    """Work on recorded clips: convert them from and to other forms, bring older ones forward.

    Example: wigwag clips convert clips clips.parquet
    """

    clips: tyro.conf.OmitArgPrefixes[
        tyro.conf.OmitSubcommandPrefixes[
            Annotated[Convert, tyro.conf.subcommand("convert")]
            | Annotated[Migrate, tyro.conf.subcommand("migrate")]
        ]
    ]

    def run(self) -> int:
        """Run what was chosen and return its exit code."""
        return self.clips.run()


_SHOWN = 10
"""Lines of a long list that are printed; ``--json`` has all."""


def _list(console: Console, items: list[tuple[str, str]], what: str) -> None:
    for name, reason in items[:_SHOWN]:
        _say(console, f"{what}: {name}: {reason}")
    if len(items) > _SHOWN:
        _say(console, f"{what}: {len(items) - _SHOWN} more (all of them with --json)")


def _say(console: Console, text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)


__all__ = ["Clips", "Convert", "Migrate"]
