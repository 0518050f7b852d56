"""``wigwag benchmark dtw``: our dynamic time warping against other libraries'."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table

    from wigwag.evaluate.dtw import Comparison


@dataclass(frozen=True)
class DtwBenchmark:
    """Time dynamic time warping on one thread: 688 references of 64 frames, all libraries in turn.

    Exit code 1 if two of them find other distances.

    Example: wigwag benchmark dtw --data UTD-MHAD --features 16 --json dtw.json
    """

    data: Path | None = None
    """Folder with UTD-MHAD's Skeleton.zip; without it, random walks."""
    features: Literal["16", "1821", "all"] = "all"
    """Features a frame. 1821 needs 6 GB of memory and most of the time."""
    queries: int = 40
    """Queries timed with 16 features; with 1821 a tenth."""
    seed: int = 0
    """Of the split, or of the random walks."""
    json: Path | None = None
    """File for the records, one a case and library."""

    def run(self) -> int:
        """Measure case by case, print the table, write the records; 1 if libraries disagree."""
        from rich.markup import escape

        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.dtw import CASES, Recordings, compare, rounds, walks
        from wigwag.evaluate.records import Records, command_line

        if self.queries < 1:
            raise InputError(f"--queries must be 1 or more, but got {self.queries}.")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark dtw", self), self.seed)
        recordings = Recordings(self.data, self.seed) if self.data is not None else None
        comparisons: list[Comparison] = []
        with bar_of_steps(console) as begin:
            for case in CASES:
                if self.features not in (str(case.features), "all"):
                    continue
                count = rounds(case, self.queries)
                references, queries = (
                    recordings.arrays(case.features, count)
                    if recordings is not None
                    else walks(case.features, count, self.seed)
                )
                comparison = compare(case, references, queries, begin(str(case)))
                comparisons.append(comparison)
                for row in comparison.rows():
                    records.add(**row, inputs="UTD-MHAD" if recordings is not None else "random walks")
        for message in dict.fromkeys(m for c in comparisons for m in c.left_out):
            console.print(f"[yellow]left out:[/] {escape(message)}", highlight=False)
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        wrong = [str(c.case) for c in comparisons if not c.agrees]
        if wrong:
            console.print(f"[red]Libraries disagree by more than 1e-5:[/] {'; '.join(wrong)}")
        return 1 if wrong else 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    inputs = rows[0]["inputs"]
    table = Table(
        title=f"DTW of one query against {rows[0]['references']} references of {rows[0]['frames']} frames "
        f"({inputs}), one thread, squared local cost",
        caption="times ours: the library's time over wigwag's in float32, and in float64, in which others "
        "compute. off: largest relative difference from the plain recurrence.",
        box=SIMPLE_HEAD,
    )
    for column in ("case", "library"):
        table.add_column(column, no_wrap=True)
    for column in ("ms a query", "times ours", "float64", "off"):
        table.add_column(column, justify="right", no_wrap=True)
    case = None
    for row in rows:
        mine = str(row["library"]).startswith("wigwag")
        table.add_row(
            row["case"] if row["case"] != case else "",
            f"[bold]{row['library']}[/]" if mine else row["library"],
            f"{row['ms_per_query_median']:.3f}",
            f"{row['times_ours']:.1f}",
            f"{row['times_ours_float64']:.1f}",
            f"{row['disagreement']:.0e}",
        )
        case = row["case"]
    return table


__all__ = ["DtwBenchmark"]
