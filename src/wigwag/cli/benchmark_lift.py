"""``wigwag benchmark lift``: how well landmarks get their depth, on real depth recordings."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from rich.table import Table

    from wigwag.evaluate.lift import LiftMeasurement
    from wigwag.pose.lift import Statistic


@dataclass(frozen=True)
class LiftBenchmark:
    """Lift landmarks on UTD-MHAD's depth recordings and compare with its skeletons.

    Example: wigwag benchmark lift --data UTD-MHAD --json lift.json
    """

    data: Path
    """Folder with Skeleton.zip and Depth_56_clips.zip (or Skeleton/*.mat and Depth/*.mat)."""
    json: Path | None = None
    """File for the records, one a landmark."""
    statistic: Literal["surface", "quartile", "median", "pixel"] = "surface"
    """Whose records are written; the table on screen compares all."""
    knock_out: float = 0.0
    """Share of the depth pixels that are taken away at random, from 0 to below 1."""
    seed: int = 0
    """Chooses those pixels."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        from rich.progress import Progress

        from wigwag.cli.benchmark_text import say_left_out, wide_console
        from wigwag.evaluate.lift import measure_lift
        from wigwag.evaluate.records import Records, command_line

        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark lift", self), self.seed)
        with Progress(console=console, transient=True) as progress:
            task = progress.add_task("Lifting", total=None)
            measurement = measure_lift(
                self.data,
                progress=lambda done: progress.update(task, completed=done),
                knock_out=self.knock_out,
                seed=self.seed,
            )
        say_left_out(console, measurement.left_out)
        for row in measurement.rows(self.statistic):
            records.add(**row)
        console.print(_table(measurement, self.statistic))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _table(measurement: LiftMeasurement, statistic: Statistic) -> Table:
    """Compare the statistics on the people that nothing was fitted on, or on all if there are no others."""
    from rich.table import Table

    from wigwag.evaluate.lift import FITTED_ON, JOINTS

    rows = {s: measurement.rows(s) for s in measurement.errors}
    group, frames = rows[statistic][0]["subjects"], rows[statistic][0]["frames"]
    table = Table(
        title="Lifting: median |error| mm / beyond 150 mm % / missing %",
        caption=f"{frames} frames of {group}, {measurement.knock_out:.0%} of the pixels knocked out. Offset "
        f"from the surface to the joint for {statistic!r}, mm, in brackets as fitted anew on "
        f"{', '.join(FITTED_ON)}. Errors within 1 and 2 of the standard deviations stated for {statistic!r}, "
        f"%. 39 landmarks at 640x480 take {_number(measurement.ms_39_landmarks, 2)} ms.",
    )
    table.add_column("joint")
    for name in rows:
        table.add_column(name, justify="right")
    table.add_column("within 1 / 2 sd", justify="right")
    table.add_column("offset", justify="right", style="dim")
    for joint in JOINTS:
        of_joint = {
            s: next(r for r in records if r["landmark"] == joint and r["subjects"] == group)
            for s, records in rows.items()
        }
        mine = of_joint[statistic]
        offset = f"{mine['offset_mm']:.0f} ({_number(mine['refit_offset_mm'], 0)})"
        within = " / ".join(_percent(mine[f"within_{n}_sigma"]) for n in (1, 2))
        table.add_row(joint, *[_cell(row) for row in of_joint.values()], within, offset)
    return table


def _cell(row: dict[str, float | None]) -> str:
    beyond, missing = row["beyond_150_mm"], row["missing"]
    return " / ".join(
        [
            _number(row["median_abs_mm"], 1),
            _percent(beyond),
            _percent(missing),
        ]
    )


def _percent(share: float | None) -> str:
    return _number(None if share is None else share * 100, 1)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


__all__ = ["LiftBenchmark"]
