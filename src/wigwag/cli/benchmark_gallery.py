"""``wigwag benchmark gallery``: how the time of a query grows with what is enrolled."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True)
class GalleryBenchmark:
    """Look for the nearest of up to a million enrolled clips, by a shortlist and DTW, on one thread.

    Example: wigwag benchmark gallery --data UTD-MHAD --json gallery.json --out gallery.png
    """

    data: Path
    """Folder with UTD-MHAD's Skeleton.zip; what is enrolled are variations of its clips."""
    sizes: tuple[int, ...] = (1_000, 10_000, 100_000, 1_000_000)
    """Enrolled clips; a million takes most of the time (about 8 minutes) and 3 GB."""
    shortlist: int = 1500
    """Clips that DTW compares."""
    exact: int = 200
    """Queries whose true nearest is looked for at each size, at most; there are 173."""
    seed: int = 0
    """Of the split and of the variations."""
    json: Path | None = None
    """File for the records, one a size."""
    out: Path | None = None
    """File for the plot (PNG)."""

    def run(self) -> int:
        """Measure size by size, print the table, write records and plot."""
        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.cli.targets import check_file
        from wigwag.distances import Gallery
        from wigwag.evaluate.gallery import EnrolledClips, draw_growth, growth, measure
        from wigwag.evaluate.records import Records, command_line

        if self.out is not None:
            check_file(self.out, "--out")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark gallery", self), self.seed)
        gallery = Gallery(shortlist=self.shortlist)
        with bar_of_steps(console) as begin:
            begin("Reading UTD-MHAD")
            clips = EnrolledClips(self.data, self.seed)
            for measurement in measure(clips, gallery, self.sizes, self.exact, begin("Gallery")):
                records.add(**measurement.row(), band=gallery.band)
                if self.out is not None:
                    draw_growth(records.rows, self.out)
        console.print(_table(records.rows))
        if len(records.rows) > 1:
            console.print(
                f"Time grows with size to the power of {growth(records.rows):.2f}; "
                f"DTW on all, {growth(records.rows, 'ms_exact_median'):.2f}.",
                highlight=False,
            )
        if self.json is not None:
            console.print(f"Records: {self.json}")
        if self.out is not None:
            console.print(f"Plot: {self.out}")
        return 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    first = rows[0]
    table = Table(
        title=f"The nearest enrolled clip, one thread: ms a query ({first['queries']} recorded clips)",
        caption=f"Shortlist of {first['shortlist']}, then DTW: 24 frames, 16 features, band {first['band']}. "
        "recall: the nearest under this DTW of all was found.",
        box=SIMPLE_HEAD,
    )
    for column in ("enrolled", "ms", "p95", "recall %", "DTW on all, ms", "enrolling, s"):
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            f"{row['size']:,}",
            f"[bold]{row['ms_per_query_median']:.2f}[/]",
            f"{row['ms_per_query_p95']:.2f}",
            f"{100 * row['recall']:.1f}",
            f"{row['ms_exact_median']:.2f}",
            f"{row['build_s']:.1f}",
        )
    return table


__all__ = ["GalleryBenchmark"]
