"""``wigwag benchmark far``: small people in clutter, and walls without people."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table

    from wigwag.evaluate.far import FarMeasurement


@dataclass(frozen=True)
class FarBenchmark:
    """Shrink photos of people, set them on clutter of other photos, and look for them.

    Example: wigwag benchmark far --data PHOTOS --json far.json
    """

    data: Path
    """Folder of photos with one person each: FOLDER/*.jpg."""
    json: Path | None = None
    """File for the records, one a size, mode and half of the folders."""
    sizes: tuple[int, ...] = (250, 200, 160, 136, 102, 81, 64)
    """Heights of the people, pixels of 640x480."""
    seeds: int = 1
    """So many composites of each photo and size."""
    seed: int = 0
    """The first seed; clutter, place, style, interpolation and compression follow from it."""
    streams: bool = True
    """Measure acquisition and keeping in streams too."""
    walls: int = 500
    """Crops of walls and furniture without a person."""
    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    failures: Path | None = None
    """Folder for the pictures in which something went wrong."""

    def run(self) -> int:
        """Measure, print the tables, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.errors import InputError
        from wigwag.evaluate.far import FarOptions, measure_far
        from wigwag.evaluate.records import Records, command_line
        from wigwag.pose.blazepose import BlazePose, BlazePoseConfig

        if self.seeds < 1 or self.walls < 0 or min(self.sizes, default=0) < 1:
            raise InputError(
                "Expected --seeds of 1 or more, --walls of 0 or more and --sizes of 1 pixel or more, "
                f"but got {self.seeds}, {self.walls} and {' '.join(map(str, self.sizes)) or 'none'}."
            )
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark far", self), self.seed)
        seeds = tuple(range(self.seed, self.seed + self.seeds))
        options = FarOptions(self.sizes, seeds, self.streams, self.walls)
        pose = BlazePose(BlazePoseConfig(model=self.model, models_dir=self.models_dir))
        with bar_of_steps(console) as begin:
            measurement = measure_far(
                self.data,
                pose,
                options,
                add=lambda row: records.add(**row),
                progress=begin("Looking"),
            )
        for path in measurement.not_found:
            console.print(f"nobody found at full size: {path}", markup=False, highlight=False)
        for table in _tables(measurement.rows):
            console.print(table)
        if self.failures is not None:
            _write_failures(self.failures, measurement)
            console.print(f"Failures: {len(measurement.failures)} pictures in {self.failures}")
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _tables(rows: list[dict[str, Any]]) -> list[Table]:
    from rich.table import Table

    full = rows[0]
    people = Table(
        title="Small people in clutter, rightly found",
        caption=f"At full size somebody was found in {full['found_pct']:.1f} % of {full['n']} photos.",
    )
    columns: tuple[str, ...] = (
        "px",
        "about m",
        "n",
        "picture %",
        "(95 %)",
        "full frame alone %",
        "error, torsos",
    )
    columns += ("stream: acquired %", "frames, median / mean / max", "kept %", "ms a search frame")
    for column in columns:
        people.add_column(column, justify="right")
    of_all = [row for row in rows if row["data"] == "all"]
    for row in (row for row in of_all if row["mode"] == "picture"):
        low, high = row["found_ci95"]
        cells = [row["person_px"], row["distance_m_at_640x480"], row["n"], f"{row['found_pct']:.1f}"]
        cells += [f"{low:.1f} to {high:.1f}", f"{row['full_frame_found_pct']:.1f}"]
        cells += [row["landmark_error_torso_median"]]
        for stream in of_all:
            if stream["mode"] == "stream" and stream["person_px"] == row["person_px"]:
                frames = [stream[f"frames_to_acquire_{what}"] for what in ("median", "mean", "max")]
                cells += [f"{stream['acquired_pct']:.1f}", " / ".join(map(str, frames))]
                cells += [f"{stream['kept_pct']:.1f}", stream["ms_search_frame_mean"]]
        people.add_row(*map(str, cells))
    nobody = Table(title="Walls and furniture, nobody there")
    for column in ("crops", "n", "somebody found", "ms, median"):
        nobody.add_column(column, justify="right")
    empty = [row for row in rows if row["mode"] == "nobody"]
    for row in empty:
        nobody.add_row(*(str(row[key]) for key in ("crops", "n", "false_found", "ms_median")))
    return [people, nobody] if empty else [people]


def _write_failures(folder: Path, measurement: FarMeasurement) -> None:
    import cv2

    from wigwag.errors import InputError

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made a folder for failures ({error.strerror}).") from error
    for index, (what, rgb) in enumerate(measurement.failures):
        name = "".join(c if c.isalnum() or c in "-_." else "_" for c in what)
        cv2.imwrite(str(folder / f"{index:03d}_{name}.png"), cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))


__all__ = ["FarBenchmark"]
