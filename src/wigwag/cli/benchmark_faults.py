"""``wigwag benchmark faults``: what goes wrong in flight, and whether it ends as docs/safety.md says."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class FaultsBenchmark:
    """Let everything go wrong many times, and see whether each fault ends in its documented state and time.

    Poses are synthesised from where the person is; links are real MAVLink bytes to fake autopilots. Exit code
    1 if any run ended otherwise.

    Example: wigwag benchmark faults --only link --json faults.json
    """

    runs: int = 50
    """Seeds a fault."""
    seed: int = 0
    """The first one."""
    only: str = ""
    """Only faults whose names contain this."""
    json: Path | None = None
    """File for the records, one a fault."""

    def run(self) -> int:
        """Fly fault by fault, print the table, write the records."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.faults import FAULTS, summary
        from wigwag.evaluate.records import Records, command_line

        chosen = [fault for fault in FAULTS if self.only in fault.name]
        if not 1 <= self.runs <= 10_000 or not chosen:
            names = ", ".join(fault.name for fault in FAULTS)
            raise InputError(
                f"--runs must be 1 to 10000 and --only part of a fault's name, but got {self.runs} and "
                f"{self.only!r}. There are: {names}."
            )
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark faults", self), self.seed)
        table = Table(title=f"Faults in flight, {self.runs} seeded runs each", box=SIMPLE_HEAD)
        for column in ("fault", "as documented", "ends", "at most, s", "documented, s", "nearest, m"):
            table.add_column(column, justify="right", no_wrap=True)
        fine = True
        for fault in chosen:
            with console.status(f"flying: {fault.name}"):
                row = records.add(**summary(fault, self.runs, self.seed))
            fine &= row["ended_as_documented"] == self.runs
            table.add_row(
                fault.name, f"[bold]{row['ended_as_documented']} of {self.runs}[/]", row["end_state"],
                f"{row['time_s_max']:.1f}", f"{fault.within_s:g}", f"{row['nearest_m']:.2f}",
            )  # fmt: skip
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0 if fine else 1


__all__ = ["FaultsBenchmark"]
