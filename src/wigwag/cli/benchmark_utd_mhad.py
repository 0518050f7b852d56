"""``wigwag benchmark utd-mhad``: the paper's table, remade."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import TaskID
    from rich.table import Table

    from wigwag.evaluate.records import Records
    from wigwag.evaluate.utd_mhad import Result, Row
    from wigwag.skeleton import Clip


@dataclass(frozen=True)
class UtdMhadBenchmark:
    """Recognise UTD-MHAD's clips as the paper does, and with people kept apart.

    Example: wigwag benchmark utd-mhad --data UTD-MHAD --json utd.json
    """

    data: Path
    """Folder with Skeleton.zip (or the zip file, or a folder with Skeleton/*.mat)."""
    recognizer: Literal[
        "kernel", "kernel-fast", "heavy", "encoded", "all", "classical", "schneider", "celebi", "rwigema",
        "aeon-dtw", "multirocket", "baselines",
    ] = "all"  # fmt: skip
    """Which recogniser. all: wigwag's own; baselines: what others published, and libraries."""
    protocol: Literal["random", "cross-subject", "loso", "all"] = "all"
    """random: the paper's split; cross-subject: learn from people 1, 3, 5, 7; loso: each person in turn."""
    classes: Literal["27", "6", "7", "all"] = "all"
    """Which of the paper's class sets."""
    seeds: int = 10
    """How many seeds: random splits, and runs of a recogniser that draws random numbers."""
    seed: int = 0
    """The first seed."""
    nested: bool = False
    """Let recognisers choose their settings by leaving out training people, inside every split."""
    out: Path | None = None
    """Folder for the confusion matrices as pictures."""
    json: Path | None = None
    """File for the records, one a row of the table; kept up to date row by row."""

    def run(self) -> int:
        """Run every row asked for; print the table, write records and pictures."""
        from rich.markup import escape

        from wigwag.cli.benchmark_text import wide_console
        from wigwag.cli.targets import make_folder
        from wigwag.errors import InputError
        from wigwag.evaluate.records import Records, command_line

        if self.seeds < 1:
            raise InputError(f"--seeds must be 1 or more, but got {self.seeds}.")
        if self.out is not None:
            make_folder(self.out, "--out")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark utd-mhad", self), self.seed)
        clips = self._load(console)
        failed = self._run_rows(console, clips, records)
        if records.rows:
            console.print(_table(records.rows))
        for row, reason in failed:
            console.print(f"[yellow]left out:[/] {escape(row)}: {escape(reason)}", highlight=False)
        if not records.rows:
            raise InputError("No row of the table could be run. The reasons stand above.")
        if self.json is not None:
            console.print(f"Records: {self.json}")
        if self.out is not None:
            console.print(f"Confusion matrices: {self.out}")
        return 0

    def _load(self, console: Console) -> list[Clip]:
        from wigwag.cli.benchmark_text import read
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.evaluate.protocols import CLASS_SETS

        labels = None if self.classes in ("27", "all") else CLASS_SETS[self.classes]
        return read(
            console, "UTD-MHAD", lambda progress: load_skeletons(self.data, labels, progress=progress)
        ).clips

    def _rows(self) -> list[Row]:
        from wigwag.evaluate.protocols import CLASS_SETS, PROTOCOLS
        from wigwag.evaluate.utd_mhad import BASELINES, RECOGNIZERS, Row

        groups = {"all": tuple(RECOGNIZERS), "baselines": tuple(BASELINES)}
        return [
            Row(recognizer, protocol, classes, self.nested)
            for recognizer in groups.get(self.recognizer, (self.recognizer,))
            for protocol in PROTOCOLS
            for classes in CLASS_SETS
            if self.protocol in (protocol, "all") and self.classes in (classes, "all")
        ]

    def _run_rows(self, console: Console, clips: list[Clip], records: Records) -> list[tuple[str, str]]:
        """Run the rows one by one, recording each as it ends; return those that could not be run and why."""
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        from wigwag.errors import InputError
        from wigwag.evaluate.utd_mhad import run_row, warm_up

        failed: list[tuple[str, str]] = []
        warm: set[str] = set()
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as bar:
            whole = bar.add_task("Rows of the table", total=len(self._rows()))
            for row in self._rows():
                name = str(row)
                task = bar.add_task(name, total=None)

                def show(split: str, done: int, total: int, task: TaskID = task, name: str = name) -> None:
                    bar.update(task, description=f"{name}, {split}", completed=done, total=total)

                try:
                    if row.recognizer not in warm:
                        warm_up(clips, row.recognizer)
                        warm.add(row.recognizer)
                    seeds = range(self.seed, self.seed + self.seeds)
                    result = run_row(clips, row, seeds, show)
                except InputError as error:
                    failed.append((name, str(error)))
                else:
                    record = records.add(**result.record(self.seed))
                    console.print(f"{name}: {100 * record['accuracy_mean']:.2f} % right", highlight=False)
                    if self.out is not None:
                        _draw(result, clips, self.out)
                bar.remove_task(task)
                bar.advance(whole)
        return failed


def _draw(result: Result, clips: list[Clip], folder: Path) -> None:
    from wigwag.datasets.utd_mhad import ACTIONS
    from wigwag.evaluate.confused import draw_confused
    from wigwag.evaluate.metrics import draw_confusion
    from wigwag.evaluate.protocols import CLASS_SETS

    row = result.row
    labels = CLASS_SETS[row.classes]
    draw_confusion(
        result.confusion(),
        [f"{ACTIONS[label]} ({label})" for label in labels],
        f"UTD-MHAD: {row}",
        folder / f"confusion_{row.recognizer}_{row.protocol}_{row.classes}.png",
    )
    confused = folder / f"confused_{row.recognizer}_{row.protocol}_{row.classes}.png"
    draw_confused(result, clips, ACTIONS, confused)


def _table(rows: list[dict[str, Any]]) -> Table:
    """Lay the records out like the paper's table, its figures beside ours."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from wigwag.evaluate.utd_mhad import PAPER

    table = Table(
        title="UTD-MHAD: accuracy and macro F1 in %, milliseconds a case from raw clip to label, one thread",
        caption="paper: Chaudhary et al. 2024, random split, Intel NUC. ±: between splits (random) or "
        "between people. ECE: expected calibration error, %.",
        box=SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
    )
    for column in ("recogniser", "protocol", "classes"):
        table.add_column(column, no_wrap=True)
    for column in (
        "train / test", "accuracy", "95 %", "paper", "F1", "ECE", "fit s", "ms", "p95", "paper ms",
    ):  # fmt: skip
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        paper = PAPER.get((row["recognizer"], str(row["classes"]))) if row["protocol"] == "random" else None
        low, high = row["accuracy_ci95"]
        table.add_row(
            row["recognizer"],
            row["protocol"],
            str(row["classes"]),
            f"{row['n_train']} / {row['n_test']}",
            f"[bold]{100 * row['accuracy_mean']:.2f}[/] ±{100 * row['accuracy_std']:.2f}",
            f"{100 * low:.1f}-{100 * high:.1f}",
            f"{paper[0]:.2f}" if paper else "",
            f"{100 * row['macro_f1_mean']:.2f}",
            "" if row["ece"] is None else f"{100 * row['ece']:.1f}",
            f"{row['fit_s']:.1f}",
            f"{row['ms_per_case_median']:.1f}",
            f"{row['ms_per_case_p95']:.1f}",
            f"{paper[1]:.0f}" if paper else "",
        )
    return table


__all__ = ["UtdMhadBenchmark"]
