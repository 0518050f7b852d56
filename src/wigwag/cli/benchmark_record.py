"""``wigwag benchmark record``: what recording costs, and what kills leave of it."""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class RecordBenchmark:
    """Record flights at 30 Hz with 640x480 pictures: size, processor time, and kill -9 at random moments.

    Exit code 1: a file did not open, or more than a second was lost.
    Example: wigwag benchmark record --seconds 60 --kills 20
    """

    seconds: float = 600.0
    """Length of the flight whose size and cost are measured."""
    kills: int = 100
    """Flights that are killed."""
    seed: int = 0
    """Of flights and moments."""
    json: Path | None = None
    """File for the records."""

    def run(self) -> int:
        """Measure, print, write; return 0, or 1 if a kill took too much."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table
        from threadpoolctl import threadpool_limits

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.recording import account, measure_cost, measure_kills, pictures
        from wigwag.evaluate.records import Records, command_line

        if not 1 <= self.seconds <= 7200 or not 0 <= self.kills <= 10_000:
            raise InputError(
                f"--seconds must be 1 to 7200 and --kills 0 to 10000, but got {self.seconds:g}, {self.kills}."
            )
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark record", self), self.seed)
        table = Table(
            title="A recorded flight, 640x480 at 30 Hz",
            caption="ms of processor a frame: of the loop's own thread, and of the one that writes",
            box=SIMPLE_HEAD,
        )
        for column in ("pictures", "depth", "MB in 10 min", "loop mean", "p99", "writer"):
            table.add_column(column, justify="right", no_wrap=True)
        bad = False
        with (
            tempfile.TemporaryDirectory() as name,
            threadpool_limits(1),
            console.status("rendering") as status,
        ):
            folder, frames = Path(name), pictures(seed=self.seed)
            for depth in (False, True):
                cost = measure_cost(
                    folder, frames, self.seconds if not depth else min(self.seconds, 60.0), depth=depth,
                    seed=self.seed, progress=lambda done: status.update(f"recording: {done:.0f} s"),
                )  # fmt: skip
                records.add(measure="cost", mb_ten_minutes=cost.mb_ten_minutes, **asdict(cost))
                table.add_row(
                    cost.pictures, "yes" if depth else "no", f"[bold]{cost.mb_ten_minutes:.0f}[/]",
                    f"[bold]{cost.loop_ms_mean:.3f}[/]", f"{cost.loop_ms_p99:.3f}",
                    f"{cost.writer_ms_mean:.2f}",
                )  # fmt: skip
            console.print(table)
            if self.kills:
                kills = measure_kills(
                    folder, frames, self.kills, self.seed, lambda done: status.update(f"killed: {done}")
                )
                said = account(kills)
                records.add(measure="kills", **said)
                bad = said["opened"] < len(kills) or said["lost_s_max"] > 1.0
                console.print(
                    f"{said['opened']} of {said['kills']} killed flights open in mcap's own reader "
                    f"({said['needed_repair']} needed a repair); lost: {said['lost_s_median']:.2f} s median, "
                    f"{said['lost_s_max']:.2f} s at most; {said['decided_alike']} are decided again alike.",
                    highlight=False,
                )
        return int(bad)


__all__ = ["RecordBenchmark"]
