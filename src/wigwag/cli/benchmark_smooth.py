"""``wigwag benchmark smooth``: what smoothing costs in time and gains in steadiness."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class SmoothBenchmark:
    """Send UTD-MHAD's fast swings, and people at rest, through the pose filter.

    Example: wigwag benchmark smooth --data UTD-MHAD --json smooth.json
    """

    data: Path
    """Folder with Skeleton.zip (or Skeleton/*.mat)."""
    json: Path | None = None
    """File for the records, one a filter and rate."""
    rates_hz: tuple[float, ...] = (30.0,)
    """Frames a second to which the recordings are resampled."""
    distance_m: float = 5.0
    """How far off the people are put."""
    seed: int = 0
    """Chooses the noise."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.smooth import SmoothConfig, measure_smooth

        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark smooth", self), self.seed)
        config = SmoothConfig(rates_hz=self.rates_hz, distance_m=self.distance_m, seed=self.seed)
        table = Table(
            title="Smoothing: the fast wrist's lag and overshoot without noise, errors with it",
            caption=f"{', '.join(config.subjects)}; settings chosen on the others. Median / 95 % / greatest.",
        )
        table.add_column("filter")
        for column in (
            "Hz",
            "lag, ms",
            "overshoot, %",
            "speed over, %",
            "RMS",
            "at rest",
            "jitter",
            "heels, mm",
        ):
            table.add_column(column, justify="right")
        with console.status("filtering the recordings"):
            for row in measure_smooth(self.data, config):
                records.add(**row, distance_m=self.distance_m)
                table.add_row(
                    row["filter"],
                    f"{row['rate_hz']:g}",
                    *(
                        " / ".join(
                            f"{scale * row[f'{name}_{part}']:.1f}" for part in ("median", "p95", "max")
                        )
                        for name, scale in (("lag_ms", 1), ("overshoot", 100), ("speed_overshoot", 100))
                    ),
                    *(f"{row[n]:.1f}" for n in ("rms_mm", "rest_rms_mm", "rest_jitter_mm", "heel_rms_mm")),
                )
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


__all__ = ["SmoothBenchmark"]
