"""``wigwag benchmark operator``: is the operator kept, and nobody else's pose handed on?"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

    from wigwag.evaluate.passers import Condition


@dataclass(frozen=True)
class OperatorBenchmark:
    """Let people cross, stop beside and before, and replace a rendered operator, from pixels to pose.

    Example: wigwag benchmark operator --json operator.json
    """

    crossings: int = 20
    """How many crossings (or other events) in each condition at each distance, half before the operator and
    half behind."""
    seed: int = 1
    """Chooses people, clothes, surroundings, ways, gusts and noise; every condition has its own."""
    json: Path | None = None
    """File for the records, one a condition and distance."""
    condition: tuple[str, ...] = ()
    """Which conditions, by name; all by default."""
    distance_m: tuple[float, ...] = (3.0, 4.0, 6.0, 8.0)
    """How far the operator stands from the drone, metres."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        import cv2
        from threadpoolctl import threadpool_limits

        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.evaluate.operator import measure
        from wigwag.evaluate.records import Records, command_line
        from wigwag.pose.estimator import PoseEstimator

        chosen = self._conditions()
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark operator", self), self.seed)
        cv2.setNumThreads(1)
        sessions = [(condition, distance) for condition in chosen for distance in self.distance_m]
        with threadpool_limits(1), bar_of_steps(console) as bar:
            estimator = PoseEstimator()
            for number, (condition, distance) in enumerate(sessions):
                bar(f"{condition.name}, {distance:g} m")("", number, len(sessions))
                records.add(**measure(condition, distance, self.crossings, self.seed + number, estimator))
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0

    def _conditions(self) -> list[Condition]:
        from wigwag.errors import InputError
        from wigwag.evaluate.passers import CONDITIONS

        if self.crossings < 1:
            raise InputError(f"--crossings must be 1 or more, but got {self.crossings}.")
        if not self.distance_m or min(self.distance_m) < 2 or max(self.distance_m) > 10:
            raise InputError(f"--distance-m must be from 2 to 10 m, but got {self.distance_m}.")
        by_name = {condition.name: condition for condition in CONDITIONS}
        for name in self.condition:
            if name not in by_name:
                raise InputError(f"There is no condition {name!r}. There are: {', '.join(by_name)}.")
        return [by_name[name] for name in self.condition] or list(CONDITIONS)


def _table(rows: list[dict[str, Any]]) -> Table:
    """Show a row a condition and distance, and the sum."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title="The operator among passers-by",
        caption="kept: handed on again within 1.5 s after the passer-by is clear, and nobody else's pose "
        "meanwhile. found: share of the frames in which nobody stands before the operator. back: seconds "
        "from when the operator is in view again until they are handed on, median / greatest.",
        box=SIMPLE_HEAD,
    )
    columns = ("kept", "found %", "frames", "of passers-by", "elsewhere", "back s", "ms median / mean")
    table.add_column("condition")
    for column in ("m", *columns):
        table.add_column(column, justify="right")
    for row in rows:
        table.add_row(
            row["condition"], f"{row['distance_m']:g}", f"{row['kept']} of {row['crossings']}",
            f"{row['frames_operator_pct']:.1f}", str(row["frames"]), str(row["frames_of_passerby"]),
            str(row["frames_elsewhere"]),
            f"{_seconds(row['reacquired_s_median'])} / {_seconds(row['reacquired_s_max'])}",
            f"{row['ms_median']:.1f} / {row['ms_mean']:.1f}",
        )  # fmt: skip
    total = {
        name: sum(row[name] for row in rows) for name in ("kept", "crossings", "frames", "frames_of_passerby")
    }
    table.add_section()
    table.add_row(
        "all", "", f"{total['kept']} of {total['crossings']}", "", str(total["frames"]),
        str(total["frames_of_passerby"]), str(sum(row["frames_elsewhere"] for row in rows)), "", "",
    )  # fmt: skip
    return table


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


__all__ = ["OperatorBenchmark"]
