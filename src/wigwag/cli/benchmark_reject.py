"""``wigwag benchmark reject``: how well movements that are no taught gesture are turned away."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from wigwag.skeleton import Clip


@dataclass(frozen=True)
class RejectBenchmark:
    """Teach some of UTD-MHAD's classes by some people and show others all classes: who is let through?

    Example: wigwag benchmark reject --data UTD-MHAD --json reject.json
    """

    data: Path
    """Folder with Skeleton.zip (or the zip file, or a folder with Skeleton/*.mat)."""
    recognizer: tuple[str, ...] = ("kernel",)
    """Which recognisers."""
    known: Literal["6", "21", "all"] = "all"
    """How many of the 27 classes are known."""
    precog: Path | None = None
    """File or folder of PRECOG's skeletons: further movements that are no gesture, for the background."""
    precog_clips: int = 200
    """How many clips of it are taught, chosen at random."""
    draws: int = 5
    """How many choices of the known classes; the first is made of the paper's six."""
    seed: int = 0
    """Of the random choices."""
    json: Path | None = None
    """File for the records, one a draw; kept up to date row by row."""

    def run(self) -> int:
        """Run the settings asked for; print the table, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, read, wide_console
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.errors import InputError
        from wigwag.evaluate.recognizers import maker_of
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.reject import SETTINGS, run_draw

        if self.draws < 1:
            raise InputError(f"--draws must be 1 or more, but got {self.draws}.")
        for recognizer in self.recognizer:
            maker_of(recognizer)
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark reject", self), self.seed)
        clips = read(console, "UTD-MHAD", lambda bar: load_skeletons(self.data, progress=bar)).clips
        more = self._background(console)
        chosen = [s for s in SETTINGS if self.known in (str(s[0]), "all")]
        with bar_of_steps(console) as bar:
            for recognizer, setting, draw in product(self.recognizer, chosen, range(self.draws)):
                name = f"{recognizer}, {setting[0]} known, background: {setting[1]}"
                result = run_draw(clips, recognizer, setting, draw, more, seed=self.seed, progress=bar(name))
                records.add(**result.record())
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0

    def _background(self, console: Console) -> list[Clip]:
        import numpy as np

        from wigwag.cli.benchmark_text import read
        from wigwag.datasets.precog import load_background
        from wigwag.errors import InputError

        if self.precog is None:
            return []
        if self.precog_clips < 1:
            raise InputError(f"--precog-clips must be 1 or more, but got {self.precog_clips}.")
        path = self.precog
        pieces = read(console, "PRECOG", lambda _: load_background(path)).clips
        some = np.random.default_rng([0xB6, self.seed]).permutation(len(pieces))[: self.precog_clips]
        return [pieces[int(i)] for i in np.sort(some)]


def _table(rows: list[dict[str, Any]]) -> Table:
    """Show the mean and the deviation over the draws of each setting."""
    import numpy as np
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title="UTD-MHAD, people kept apart: gestures let through, other movements turned away; %",
        caption="±: between draws of the known classes. at 95: at the threshold that 95 % of the known test "
        "clips pass. own: at the threshold that the recogniser chose on training people.",
        box=SIMPLE_HEAD,
    )
    for column in ("recogniser", "known", "background"):
        table.add_column(column)
    figures = {
        "AUROC": "auroc",
        "false accepts at 95": "false_accept_at_95",
        "true accepts, own": "true_accept_at_threshold",
        "false accepts, own": "false_accept_at_threshold",
        "right, own": "right_at_threshold",
    }
    for column in ("draws", *figures):
        table.add_column(column, justify="right")
    groups: dict[tuple[str, int, str], list[dict[str, Any]]] = {}
    for row in rows:
        groups.setdefault((row["recognizer"], row["known"], row["background"]), []).append(row)
    for (recognizer, known, background), draws in groups.items():
        values = [100 * np.array([row[key] for row in draws]) for key in figures.values()]
        table.add_row(
            recognizer,
            f"{known} of 27",
            background,
            str(len(draws)),
            *[f"{v.mean():.1f} ±{v.std(ddof=1) if len(v) > 1 else 0.0:.1f}" for v in values],
        )
    return table


__all__ = ["RejectBenchmark"]
