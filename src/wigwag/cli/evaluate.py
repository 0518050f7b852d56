"""``wigwag evaluate``: how good a model is on clips, and which it fails on."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.evaluate.taught import Evaluation


@dataclass(frozen=True)
class Evaluate:
    """Ask a model for clips: accuracy with its interval, confusion, the clips that fail.

    Use clips that did not teach it, of people who did not: others flatter. A clip without a label, or of a
    gesture that the model may not answer with, is right if nothing is said.

    Exit code: 0 fine, 1 the accuracy is below --least or clips could not be read, 2 wrong input.
    Example: wigwag evaluate mine.wigwag clips --json figures.json --out out
    """

    model: tyro.conf.Positional[Path]
    """File of the model, of any kind."""
    clips: tyro.conf.Positional[Path]
    """Folder of clips: <label>/<name>.json."""
    out: Path | None = None
    """Folder for confusion.png."""
    json: Path | None = None
    """File for the figures: one record of all, one a clip."""
    least: float = 1.0
    """Exit code 1 below this accuracy, 0 to 1."""

    def run(self) -> int:
        """Read, ask, say; return 0, or 1 if it is not good enough."""
        from threadpoolctl import threadpool_limits

        from wigwag.cli.benchmark_text import bar_of_steps, read, wide_console
        from wigwag.cli.targets import make_folder
        from wigwag.datasets.folder import load_folder
        from wigwag.evaluate.records import Records
        from wigwag.evaluate.taught import evaluate
        from wigwag.stream.models import load_model

        if not 0 <= self.least <= 1:
            raise InputError(f"--least must be from 0 to 1, but got {self.least}.")
        command = shlex.join(["wigwag", "evaluate", str(self.model), str(self.clips)])
        records = Records(self.json, command, 0)
        if self.out is not None:
            make_folder(self.out, "--out")
        console = wide_console()
        model, spoken = load_model(self.model)
        loaded = read(console, str(self.clips), lambda _: load_folder(self.clips))
        with threadpool_limits(1), bar_of_steps(console) as bar:
            result = evaluate(model, spoken, loaded.clips, bar("asking"))
        figures = result.figures()
        records.add(kind="all", model=str(self.model), **figures)
        for v in result.verdicts:
            records.add(
                kind="clip", clip=v.clip.name, person=v.clip.subject, expected=v.expected, said=v.said,
                right=v.right, confidence=v.confidence, reason=v.reason,
            )  # fmt: skip
        self._say(console, result)
        return 1 if figures["accuracy"] < self.least or loaded.left_out else 0

    def _say(self, console: Console, result: Evaluation) -> None:
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.evaluate.metrics import confusion, draw_confusion

        labels, figures = result.labels(), result.figures()
        table = Table(box=SIMPLE_HEAD)
        for column in ("gesture", "right", "clips", "taken for"):
            table.add_column(column, justify="right" if column in ("right", "clips") else "left")
        for label in labels:
            right, shown = result.of(label)
            if shown:
                wrong = sorted({v.said for v in result.verdicts if v.expected == label and not v.right})
                table.add_row(label, str(right), str(shown), ", ".join(wrong))
        console.print(table)
        for v in result.verdicts:
            if not v.right:
                console.print(
                    f"{v.clip.name}: {v.expected}, taken for {v.said}: {v.reason}",
                    highlight=False,
                    soft_wrap=True,
                )
        console.print(
            f"{figures['right']} of {figures['clips']} right: {100 * figures['accuracy']:.1f} % (95 % "
            f"interval over {figures['interval']} {100 * figures['accuracy_low']:.1f} to "
            f"{100 * figures['accuracy_high']:.1f} %); {figures['false_commands']} taken for a gesture that "
            "they are not.",
            highlight=False,
            soft_wrap=True,
        )
        if self.out is not None:
            counts = confusion(
                [v.expected for v in result.verdicts], [v.said for v in result.verdicts], labels
            )
            path = self.out / "confusion.png"
            draw_confusion(counts, labels, f"{self.model.name} on {self.clips.name}", path)
            console.print(f"Picture: {path}", highlight=False, soft_wrap=True)


__all__ = ["Evaluate"]
