"""``wigwag benchmark monocular``: people placed without depth, in the simulator."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class MonocularBenchmark:
    """Place simulated people without depth at 2 to 8 m, beside the same people by depth.

    Example: wigwag benchmark monocular --json monocular.json
    """

    json: Path | None = None
    """File for the records, one a distance and way of placing."""
    people: int = 4
    """How many people are seen at each distance."""
    seconds: float = 6.0
    """How long each is seen."""
    seed: int = 0
    """The first person."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        from rich.progress import Progress
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.evaluate.monocular import MonocularBenchmarkConfig, measure_monocular
        from wigwag.evaluate.records import Records, command_line

        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark monocular", self), self.seed)
        config = MonocularBenchmarkConfig(people=self.people, seconds=self.seconds, seed=self.seed)
        with Progress(console=console, transient=True) as progress:
            task = progress.add_task("Watching", total=config.people * len(config.distances_m))
            rows = measure_monocular(config, lambda done: progress.update(task, completed=done))
        table = Table(title="Placing without depth, in the simulator")
        names = {
            "found": "found, %", "distance_error_median": "distance off, %", "distance_error_p95": "95 %",
            "distance_bias": "bias, %", "within_1_sigma": "within 1 sd, %", "within_2_sigma": "2 sd, %",
        }  # fmt: skip
        for column in ("m", "way", *names.values(), "landmarks off, mm"):
            table.add_column(column, justify="left" if column == "way" else "right")
        for row in rows:
            records.add(**row)
            shares = ["-" if row[name] is None else f"{100 * row[name]:.1f}" for name in names]
            apart = row["landmark_mm_median"]
            table.add_row(
                f"{row['distance_m']:g}", row["way"], *shares, "-" if apart is None else f"{apart:.0f}"
            )
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


__all__ = ["MonocularBenchmark"]
