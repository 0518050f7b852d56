"""``wigwag benchmark transfer``: the same settings on another data set."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class TransferBenchmark:
    """Recognise MSR-Action3D's 20 actions, leaving one person out at a time; no setting is touched.

    Example: wigwag benchmark transfer --data MSR-Action3D --json transfer.json
    """

    data: Path
    """File msr_action3d*.npz, its folder, or the folder or zip file of the official *_skeleton3D.txt."""
    recognizer: tuple[str, ...] = ("kernel", "heavy", "classical", "aeon-dtw", "multirocket")
    """Which recognisers."""
    people: tuple[str, ...] = ()
    """Only these people, such as s01 s03; none given: all that the data hold."""
    seeds: int = 1
    """How many seeds of each recogniser that depends on one."""
    seed: int = 0
    """The first seed."""
    json: Path | None = None
    """File for the records, one a recogniser; kept up to date row by row."""

    def run(self) -> int:
        """Run every recogniser; print the table, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, read, wide_console
        from wigwag.datasets.msr_action3d import load_skeletons
        from wigwag.errors import InputError
        from wigwag.evaluate.recognizers import maker_of
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.transfer import run_transfer
        from wigwag.evaluate.utd_mhad import warm_up

        if self.seeds < 1:
            raise InputError(f"--seeds must be 1 or more, but got {self.seeds}.")
        for recognizer in self.recognizer:
            maker_of(recognizer)
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark transfer", self), self.seed)
        clips = read(
            console,
            "MSR-Action3D",
            lambda bar: load_skeletons(self.data, subjects=self.people or None, progress=bar),
        ).clips
        seeds = range(self.seed, self.seed + self.seeds)
        with bar_of_steps(console) as bar:
            for recognizer in self.recognizer:
                warm_up(clips, recognizer)
                result = run_transfer(clips, recognizer, seeds, bar(recognizer))
                record = records.add(**result.record(self.seed))
                console.print(f"{recognizer}: {100 * record['accuracy_mean']:.2f} % right", highlight=False)
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from wigwag.cli.benchmark_text import per_cent

    table = Table(
        title="MSR-Action3D, each person judged by what the others taught: accuracy and macro F1 in %",
        caption="±: between people. ms: from raw clip to label, one thread, median.",
        box=SIMPLE_HEAD,
    )
    table.add_column("recogniser", no_wrap=True)
    for column in ("people", "clips", "accuracy", "95 %", "F1", "fit s", "ms"):
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        low, high = row["accuracy_ci95"]
        table.add_row(
            row["recognizer"],
            str(row["people"]),
            str(row["cases"]),
            f"[bold]{per_cent(row['accuracy_mean'], 2)}[/] ±{per_cent(row['accuracy_std'])}",
            f"{per_cent(low)}-{per_cent(high)}",
            per_cent(row["macro_f1_mean"], 2),
            f"{row['fit_s']:.1f}",
            f"{row['ms_per_case_median']:.1f}",
        )
    return table


__all__ = ["TransferBenchmark"]
