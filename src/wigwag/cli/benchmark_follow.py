"""``wigwag benchmark follow``: how well a person is followed, and commands are flown, by late vehicles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class FollowBenchmark:
    """Follow a person along an arc at 0.75 m/s, and fly every command, with vehicles that answer late.

    Poses come 50 to 100 ms late, with noise, and one in fifty not at all; gusts of 2 m/s blow.

    Example: wigwag benchmark follow --json follow.json
    """

    runs: int = 5
    """Seeds a vehicle."""
    seconds: float = 60.0
    """Of walking."""
    seed: int = 0
    """The first one."""
    json: Path | None = None
    """File for the records, one a vehicle."""

    def run(self) -> int:
        """Fly vehicle by vehicle, print the table, write the records."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.following import VEHICLES, summary
        from wigwag.evaluate.records import Records, command_line

        if not 1 <= self.runs <= 1000 or not 3 <= self.seconds <= 3600:
            raise InputError(
                f"--runs must be 1 to 1000 and --seconds 3 to 3600, but got {self.runs} and {self.seconds:g}."
            )
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark follow", self), self.seed)
        table = Table(
            title=f"A person on an arc at 0.75 m/s, {self.seconds:g} s, and every command; {self.runs} runs",
            caption="command error: share of its way by which a command missed its end",
            box=SIMPLE_HEAD,
        )
        columns = (
            "vehicle",
            "bearing mean",
            "worst run",
            "distance mean",
            "worst run",
            "command error",
            "within 15 %",
        )
        for column in columns:
            table.add_column(column, justify="right", no_wrap=True)
        for vehicle in VEHICLES:
            with console.status(f"flying: {vehicle}"):
                row = records.add(**summary(vehicle, self.runs, self.seconds, self.seed))
            table.add_row(
                vehicle, f"[bold]{row['bearing_deg_mean']:.2f}°[/]", f"{row['bearing_deg_worst_run']:.2f}°",
                f"[bold]{row['distance_m_mean']:.2f} m[/]", f"{row['distance_m_worst_run']:.2f} m",
                f"{100 * row['command_error_mean']:.1f} %", f"{100 * row['commands_within_15']:.0f} %",
            )  # fmt: skip
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


__all__ = ["FollowBenchmark"]
