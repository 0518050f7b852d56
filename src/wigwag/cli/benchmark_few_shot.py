"""``wigwag benchmark few-shot``: how many examples a gesture takes, and whose."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class FewShotBenchmark:
    """Teach UTD-MHAD's gestures by few examples: other people's, one's own, one's own beside the others'.

    Example: wigwag benchmark few-shot --data UTD-MHAD --json few-shot.json
    """

    data: Path
    """Folder with Skeleton.zip (or the zip file, or a folder with Skeleton/*.mat)."""
    recognizer: tuple[str, ...] = ("kernel",)
    """Which recognisers."""
    setting: Literal["others", "own+others", "own", "all"] = "all"
    """others: so many a class from other people; own+others: the test person's beside all of the others';
    own: the test person's alone."""
    protocol: Literal["cross-subject", "loso"] = "cross-subject"
    """cross-subject: the others are people 1, 3, 5, 7, tested are 2, 4, 6, 8; loso: each person in turn."""
    draws: int = 5
    """How many random choices of the examples."""
    seed: int = 0
    """The first draw."""
    json: Path | None = None
    """File for the records, one a setting; kept up to date row by row."""

    def run(self) -> int:
        """Run the settings asked for; print the table, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, read, wide_console
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.errors import InputError
        from wigwag.evaluate.few_shot import SETTINGS, folds, run_setting
        from wigwag.evaluate.recognizers import maker_of
        from wigwag.evaluate.records import Records, command_line

        if self.draws < 1:
            raise InputError(f"--draws must be 1 or more, but got {self.draws}.")
        for recognizer in self.recognizer:
            maker_of(recognizer)
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark few-shot", self), self.seed)
        clips = read(console, "UTD-MHAD", lambda bar: load_skeletons(self.data, progress=bar)).clips
        splits = folds(clips, self.protocol)
        draws = range(self.seed, self.seed + self.draws)
        chosen = [s for s in SETTINGS if self.setting in (s[0], "all")]
        with bar_of_steps(console) as bar:
            for recognizer, setting in product(self.recognizer, chosen):
                name = f"{recognizer}, {setting[0]}, {setting[1]} a class"
                result = run_setting(clips, recognizer, setting, draws, splits, progress=bar(name))
                record = records.add(**result.record(self.seed), protocol=self.protocol)
                console.print(f"{name}: {100 * record['accuracy_mean']:.2f} % right", highlight=False)
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from wigwag.cli.benchmark_text import per_cent

    table = Table(
        title="UTD-MHAD, 27 classes: accuracy in % on people whose examples are few or none",
        caption="95 %: bootstrap of people. enrol: milliseconds a gesture added to a fitted recogniser.",
        box=SIMPLE_HEAD,
    )
    for column in ("recogniser", "taught"):
        table.add_column(column, no_wrap=True)
    for column in ("a class", "clips", "accuracy", "95 %", "enrol ms"):
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        low, high = row["accuracy_ci95"]
        table.add_row(
            row["recognizer"],
            row["setting"],
            str(row["examples"]),
            str(row["n_train"]),
            f"[bold]{per_cent(row['accuracy_mean'], 2)}[/] ±{per_cent(row['accuracy_std'])}",
            f"{per_cent(low)}-{per_cent(high)}",
            "" if row["enrol_ms_median"] is None else f"{row['enrol_ms_median']:.1f}",
        )
    return table


__all__ = ["FewShotBenchmark"]
