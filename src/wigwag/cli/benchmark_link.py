"""``wigwag benchmark link``: how evenly and how soon set-points leave."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class LinkBenchmark:
    """Measure the stream of set-points to a fake autopilot in another process, over a real UDP socket.

    Example: wigwag benchmark link --seconds 10 --json link.json
    """

    seconds: float = 30.0
    """How long each load is measured."""
    pose: bool = True
    """Run the pose network in the loop as well; otherwise an idle loop alone is measured."""
    json: Path | None = None
    """File for the records, one a load."""

    def run(self) -> int:
        """Measure load by load, print the table, write the records."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.link import measure_link, pose_work
        from wigwag.evaluate.records import Records, command_line

        if not 3 <= self.seconds <= 3600:
            raise InputError(f"--seconds must be 3 to 3600, but got {self.seconds:g}.")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark link", self), 0)
        table = Table(
            title="Set-points over UDP, as they come at the other end, ms",
            caption="jitter: of the interval, against 1/30 s; decision: until the first set-point by it; "
            "machine: how late a bare process of the same priority was woken meanwhile",
            box=SIMPLE_HEAD,
        )
        for column in ("loop", "Hz", "jitter p50", "p99", "max", "decision p50", "p99", "max", "a turn",
                       "machine p99", "max"):  # fmt: skip
            table.add_column(column, justify="right", no_wrap=True)
        loads = [("idle", lambda: None)] + ([("pose network", pose_work())] if self.pose else [])
        for name, work in loads:
            with console.status(f"measuring: {name}"):
                f = measure_link(self.seconds, work, name)
            records.add(**f.row())
            table.add_row(
                name, f"{f.rate_hz:.1f}", f"{f.jitter_p50_ms:.2f}", f"[bold]{f.jitter_p99_ms:.2f}[/]",
                f"{f.jitter_max_ms:.1f}", f"{f.decision_p50_ms:.1f}", f"[bold]{f.decision_p99_ms:.1f}[/]",
                f"{f.decision_max_ms:.1f}", f"{f.loop_p50_ms:.1f}",
                f"{f.machine_p99_ms:.2f}", f"{f.machine_max_ms:.1f}",
            )  # fmt: skip
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


__all__ = ["LinkBenchmark"]
