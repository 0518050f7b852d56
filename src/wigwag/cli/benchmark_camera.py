"""``wigwag benchmark camera``: from a camera's frame to the operator's 3-D pose."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class CameraBenchmark:
    """Measure rate, latency, age of what is handed on and memory, 640x480 with depth, on one core.

    Example: wigwag benchmark camera --json camera.json
    """

    engine: Literal["litert", "mediapipe"] = "litert"
    """What runs the networks; 'mediapipe' needs the extra of that name."""
    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    seconds: float = 10.0
    """Of stream for each figure. Latency is measured in real time."""
    seed: int = 3
    """Of the rendered people and surroundings."""
    json: Path | None = None
    """File for the records, one a measure."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.chain import EngineChoice, measure_chain
        from wigwag.evaluate.records import Records, command_line

        if not 0.2 <= self.seconds <= 600:
            raise InputError(f"--seconds must be from 0.2 to 600, but got {self.seconds}.")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark camera", self), self.seed)
        with bar_of_steps(console) as begin:
            for measured in measure_chain(
                EngineChoice(self.engine, self.model, self.models_dir),
                self.seconds,
                self.seed,
                begin("camera to pose"),
            ):
                records.add(**measured.row(), engine=self.engine, model=self.model)
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=f"From a frame with depth, 640x480, to the operator's 3-D pose: {rows[0]['engine']}, "
        f"{rows[0]['model']}",
        caption="frames/s: of one core, by processor time. From stamp to pose: in real time, one core.",
        box=SIMPLE_HEAD,
    )
    table.add_column("measure", no_wrap=True)
    for column in ("frames/s", "ms", "p95", "at most", "frames", "skipped", "MB"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("expected")
    for row in rows:
        memory = "-" if row["rss_mb"] is None else f"{row['rss_mb']:.0f} ({row['grown_mb']:+.0f})"
        table.add_row(
            row["measure"],
            *(_number(row[name], 1) for name in ("frames_per_s", "ms_median", "ms_p95", "ms_max")),
            str(row["frames"] or "-"),
            _number(row["skipped"], 0),
            memory,
            row["expected"],
        )
    return table


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


__all__ = ["CameraBenchmark"]
