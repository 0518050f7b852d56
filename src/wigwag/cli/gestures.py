"""``wigwag gestures``: what a model knows; other names; away with one."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.teach.student import Student

NEAREST = 3
"""How many of the gestures nearest to one are shown."""


@dataclass(frozen=True)
class ListGestures:
    """List the gestures that a model knows, and by how many examples.

    Example: wigwag gestures list mine.wigwag
    """

    model: tyro.conf.Positional[Path]
    """File of the model."""
    json: Path | None = None
    """File for the list, one record a gesture."""

    def run(self) -> int:
        """List them; return 0."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.evaluate.records import Records

        records = Records(self.json, shlex.join(["wigwag", "gestures", "list", str(self.model)]), 0)
        console = wide_console()
        student = _open(console, self.model)
        spoken = set(student.spoken)
        table = Table(box=SIMPLE_HEAD)
        for column in ("gesture", "examples", ""):
            table.add_column(column, justify="right" if column == "examples" else "left")
        for label, count in sorted(student.counts().items()):
            table.add_row(label, str(count), "" if label in spoken else "known, never answered")
            records.add(gesture=label, examples=count, answered=label in spoken)
        console.print(table)
        return 0


@dataclass(frozen=True)
class ShowGesture:
    """Show one gesture: its examples, and which others are nearest to it.

    Example: wigwag gestures show mine.wigwag salute
    """

    model: tyro.conf.Positional[Path]
    """File of the model."""
    gesture: tyro.conf.Positional[str]
    """Its name."""
    json: Path | None = None
    """File for one record."""

    def run(self) -> int:
        """Show it; return 0."""
        from wigwag.cli.benchmark_text import wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.records import Records

        command = shlex.join(["wigwag", "gestures", "show", str(self.model), self.gesture])
        records, console = Records(self.json, command, 0), wide_console()
        student = _open(console, self.model)
        if self.gesture not in student.known:
            raise InputError(
                f"There is no gesture {self.gesture!r}. Known gestures: {', '.join(sorted(student.known))}."
            )
        names = [name for label, name in student.examples() if label == self.gesture]
        nearest = student.neighbours(self.gesture)[:NEAREST]
        console.print(f"{self.gesture}: {len(names)} examples", highlight=False, soft_wrap=True)
        for name in names:
            console.print(f"  {name}", highlight=False, soft_wrap=True, markup=False)
        for near in nearest:
            console.print(
                f"nearest: {near.label}, {near.times:.2f} times the usual distance ({near.example})",
                highlight=False,
                soft_wrap=True,
            )
        records.add(
            gesture=self.gesture,
            examples=names,
            nearest=[near.label for near in nearest],
            nearest_times=[near.times for near in nearest],
        )
        return 0


@dataclass(frozen=True)
class RenameGesture:
    """Give a gesture another name in a model. Clips keep theirs.

    Example: wigwag gestures rename mine.wigwag salute hello
    """

    model: tyro.conf.Positional[Path]
    """File of the model; it is replaced in one step."""
    gesture: tyro.conf.Positional[str]
    """Its name."""
    name: tyro.conf.Positional[str]
    """Its new name."""

    def run(self) -> int:
        """Rename it; return 0."""
        from rich.console import Console

        console = Console()
        student = _open(console, self.model).rename(self.gesture, self.name)
        student.save(self.model)
        console.print(f"{self.model}: {self.gesture} is {self.name} now.", highlight=False, soft_wrap=True)
        return 0


@dataclass(frozen=True)
class RemoveGesture:
    """Take a gesture out of a model, with all its examples. Clips stay in their folder.

    Example: wigwag gestures remove mine.wigwag salute
    """

    model: tyro.conf.Positional[Path]
    """File of the model; it is replaced in one step."""
    gesture: tyro.conf.Positional[str]
    """Its name."""

    def run(self) -> int:
        """Remove it; return 0."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        console = Console()
        student = _open(console, self.model)
        with threadpool_limits(1), console.status("forgetting"):
            student.forget(self.gesture).save(self.model)
        console.print(
            f"{self.model}: {self.gesture} is gone; {len(student.known)} gestures are left.",
            highlight=False,
            soft_wrap=True,
        )
        return 0


@dataclass(frozen=True)
class Gestures:
    """Look into a model: list its gestures, show one, give it another name, take it away."""

    gestures: tyro.conf.OmitArgPrefixes[
        tyro.conf.OmitSubcommandPrefixes[
            Annotated[ListGestures, tyro.conf.subcommand("list")]
            | Annotated[ShowGesture, tyro.conf.subcommand("show")]
            | Annotated[RenameGesture, tyro.conf.subcommand("rename")]
            | Annotated[RemoveGesture, tyro.conf.subcommand("remove")]
        ]
    ]

    def run(self) -> int:
        """Run what was chosen and return its exit code."""
        return self.gestures.run()


def _open(console: Console, model: Path) -> Student:
    from wigwag.teach.open import open_student

    with console.status(f"reading {model}"):
        return open_student(model)


__all__ = ["Gestures", "ListGestures", "RemoveGesture", "RenameGesture", "ShowGesture"]
