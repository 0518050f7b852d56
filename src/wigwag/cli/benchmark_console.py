"""``wigwag benchmark console``: what viewers of the console cost the loop."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.view.console.measure import Load


@dataclass(frozen=True)
class ConsoleBenchmark:
    """Fly the whole simulated chain with nobody, and with many viewers, looking on; by turns, in one run.

    Exit code: 0, or 1 if the viewers cost more than a tenth of the loop's rate, or 2 for wrong use.
    Example: wigwag benchmark console --viewers 10 --json out/console.json
    """

    viewers: int = 10
    """How many look on, from another process on this machine."""
    rounds: int = 40
    """How often it is measured without and with them."""
    turns: int = 15
    """Of the loop, each time."""
    seed: int = 2
    """Chooses the operator and all noise."""
    json: Path | None = None
    """File for the records, one a load."""

    def run(self) -> int:
        """Measure, print the table, write the records."""
        from threadpoolctl import threadpool_limits

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.evaluate.records import Records, command_line
        from wigwag.fly.situation import Mode
        from wigwag.pilot import Pilot
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.rig import open_rig
        from wigwag.view.console.config import ConsoleConfig
        from wigwag.view.console.console import Console as Page
        from wigwag.view.console.measure import Asker, measure

        if not (1 <= self.viewers <= 200 and 1 <= self.rounds <= 1000 and 5 <= self.turns <= 10_000):
            raise InputError("--viewers takes 1 to 200, --rounds 1 to 1000, --turns 5 to 10000.")
        terminal = wide_console()
        records = Records(self.json, command_line("wigwag benchmark console", self), self.seed)
        with threadpool_limits(1), ExitStack() as stack:
            status = stack.enter_context(terminal.status("opening"))
            page = Page(ConsoleConfig(port=0))
            stack.callback(page.close)
            rig = stack.enter_context(open_rig(f"sim:?seed={self.seed}", "sim:"))
            asker = Asker()
            pilot = Pilot(PoseEstimator(PoseConfig.alone()), asker, rig.vehicle, in_the_air=Mode.HOLDING)
            pilot.spotter = asker  # it asks, and never listens
            loads = measure(
                rig, pilot, page, viewers=self.viewers, rounds=self.rounds, turns=self.turns,
                told=lambda number: status.update(f"round {number + 1} of {self.rounds}"),
            )  # fmt: skip
        alone = loads[0]
        self._print(terminal, loads)
        for load in loads:
            records.add(
                load=load.name, viewers=self.viewers if load.name == "viewers" else 0, turns=load.turns,
                rate_hz=load.rate_hz, loop_ms=load.loop_ms, process_ms=load.process_ms,
                rate_left=load.left_of(alone), rate_left_low=load.interval_of(alone)[0],
                rate_left_high=load.interval_of(alone)[1],
            )  # fmt: skip
        return 0 if loads[-1].left_of(alone) >= 0.9 else 1

    def _print(self, terminal: Console, loads: list[Load]) -> None:
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        table = Table(
            title="The whole simulated chain, with and without a console, medians over the rounds",
            caption=f"{self.rounds} rounds of {self.turns} turns each way; page and viewers run here, too",
            box=SIMPLE_HEAD,
        )
        for column in (
            "who looks on",
            "turns a second",
            "of it left (95 %)",
            "loop, ms a turn",
            "process, ms a turn",
        ):
            table.add_column(column, justify="right", no_wrap=True)
        for load in loads:
            name = f"{self.viewers} viewers" if load.name == "viewers" else load.name
            low, high = load.interval_of(loads[0])
            left = f"[bold]{load.left_of(loads[0]):.0%}[/] ({low:.0%} to {high:.0%})"
            table.add_row(
                name, f"{load.rate_hz:.1f}", left, f"{load.loop_ms:.2f}",
                f"{load.process_ms:.2f}",
            )  # fmt: skip
        terminal.print(table)
        if self.json is not None:
            terminal.print(f"Records: {self.json}")


__all__ = ["ConsoleBenchmark"]
