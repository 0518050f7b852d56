"""``wigwag benchmark teach``: gestures taught by one person, shown by another, through rendered pixels."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal


@dataclass(frozen=True)
class TeachBenchmark:
    """Teach two new gestures by three showings each, and have somebody else show them to a drone in flight.

    Both through rendered pixels and the pose network. Exit code 1: fewer than 95 % are recognised, a command
    is false, or the commands known before are recognised less often than before.

    Example: wigwag benchmark teach --json teach.json
    """

    gestures: tuple[str, ...] = ("goalpost", "crane")
    """What is new."""
    pairs: tuple[str, ...] = ("11:12", "13:14")
    """Who teaches and who shows, TEACHER:PERFORMER."""
    performances: int = 20
    """Of each new gesture, a pair."""
    commands_each: int = 2
    """Showings of each command that is known already."""
    others: int = 6
    """Movements that are no command."""
    recognizer: Literal["kernel", "stream"] = "kernel"
    """Kind of model."""
    model: Path | None = None
    """A model that knows the ten commands, instead of teaching one first."""
    seed: int = 1
    """Of worlds and orders."""
    json: Path | None = None
    """File for the records, one a pair."""

    def run(self) -> int:
        """Teach, show, count; return the exit code."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table
        from threadpoolctl import threadpool_limits

        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.evaluate.enrolled import measure
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.taught import teach_base
        from wigwag.teach.open import open_student

        people = self._people()
        records, console = (
            Records(self.json, command_line("wigwag benchmark teach", self), self.seed),
            wide_console(),
        )
        table = Table(title="Taught by one, shown by another", box=SIMPLE_HEAD)
        for column in (
            "teacher, performer",
            "recognised",
            "95 % interval",
            "wrong",
            "false",
            "ten commands",
            "before",
        ):
            table.add_column(column, justify="right")
        fine = True
        with threadpool_limits(1), tempfile.TemporaryDirectory() as folder, bar_of_steps(console) as bar:
            base = self.model or Path(folder) / "base.wigwag"
            if self.model is None:
                bar("teaching the ten commands")
                teach_base(base, self.recognizer)
            for teacher, performer in people:
                row = records.add(
                    **measure(
                        open_student(base), self.gestures, teacher, performer, performances=self.performances,
                        commands_each=self.commands_each, others=self.others, seed=self.seed,
                        progress=bar(f"{teacher} teaches, {performer} shows"),
                    )
                )  # fmt: skip
                fine &= row["recall"] >= 0.95 and not row["false_commands"] and not row["wrong"]
                fine &= row["commands_right"] >= row["commands_right_before"]
                table.add_row(
                    f"{teacher}, {performer}", f"{row['right']} of {row['shown']}",
                    f"{100 * row['recall_low']:.0f} to {100 * row['recall_high']:.0f} %", str(row["wrong"]),
                    str(row["false_commands"]), f"{row['commands_right']} of {row['commands_shown']}",
                    str(row["commands_right_before"]),
                )  # fmt: skip
        console.print(table)
        return 0 if fine else 1

    def _people(self) -> list[tuple[int, int]]:
        from wigwag.errors import InputError
        from wigwag.sim.gestures import COMMANDS, PERFORMABLE

        new = [name for name in PERFORMABLE if name not in COMMANDS]
        unknown = [name for name in self.gestures if name not in new]
        if unknown or not self.gestures:
            wrong = ", ".join(unknown) or "nothing"
            raise InputError(f"--gestures: {wrong} cannot be taught anew. There are: {', '.join(new)}.")
        found = []
        for pair in self.pairs:
            teacher, colon, performer = pair.partition(":")
            if not (colon and teacher.isdigit() and performer.isdigit()) or teacher == performer:
                raise InputError(f"--pairs takes TEACHER:PERFORMER, two numbers of people, but got {pair!r}.")
            found.append((int(teacher), int(performer)))
        if min(self.performances, len(found)) < 1 or min(self.commands_each, self.others) < 0:
            raise InputError("--performances and --pairs need one or more, --commands-each and --others 0.")
        return found


__all__ = ["TeachBenchmark"]
