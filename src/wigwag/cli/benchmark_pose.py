"""``wigwag benchmark pose``: the pose engines side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table

    from wigwag.pose.engine import EngineName, PoseEngine


@dataclass(frozen=True)
class PoseBenchmark:
    """Time both pose engines in one run on one core, and see how far apart their landmarks are.

    Exit code 1 if they are further apart than a pixel while they follow somebody.

    Example: wigwag benchmark pose --photos PHOTOS --json pose.json
    """

    photos: Path | None = None
    """Folder with photos of people, also in folders of it; without it, rendered motion alone."""
    models: tuple[Literal["lite", "full", "heavy"], ...] = ("full",)
    """Landmark networks."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    seconds: float = 10.0
    """Of rendered motion, 30 frames each."""
    seed: int = 3
    """Of the rendered people and surroundings."""
    json: Path | None = None
    """File for the records, one an engine, network, mode and kind of pictures."""

    def run(self) -> int:
        """Measure, print the table, write the records; 1 if the engines are further apart than a pixel."""
        from rich.markup import escape

        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.errors import InputError, MissingExtraError
        from wigwag.evaluate.pictures import read_photos
        from wigwag.evaluate.pose import AGREEMENT_PX, measure
        from wigwag.evaluate.records import Records, command_line
        from wigwag.pose.engine import open_engine

        if not 0.2 <= self.seconds <= 600:
            raise InputError(f"--seconds must be from 0.2 to 600, but got {self.seconds}.")
        if not self.models:
            raise InputError("--models names no network; expected one or more of lite, full, heavy.")
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark pose", self), self.seed)
        photos = read_photos(self.photos) if self.photos is not None else []
        missing: str | None = None
        with bar_of_steps(console) as begin:
            for model in self.models:

                def open_all() -> Mapping[EngineName, PoseEngine]:
                    nonlocal missing
                    engines: dict[EngineName, PoseEngine] = {
                        "litert": open_engine("litert", model, self.models_dir)  # noqa: B023  # called at once
                    }
                    try:
                        engines["mediapipe"] = open_engine("mediapipe", model, self.models_dir)  # noqa: B023
                    except MissingExtraError as error:
                        missing = str(error)
                    return engines

                for row in measure(
                    open_all,
                    model,
                    photos,
                    seconds=self.seconds,
                    seed=self.seed,
                    progress=begin(model),
                ):
                    records.add(**row)
        if missing:
            console.print(f"[yellow]left out:[/] {escape(missing)}", highlight=False)
        console.print(_table(records.rows))
        if self.json is not None:
            console.print(f"Records: {self.json}")
        wrong = [
            row
            for row in records.rows
            if row["mode"] == "track" and (row["agreement_px_median"] or 0.0) > AGREEMENT_PX
        ]
        for r in wrong[::2]:
            console.print(
                f"[red]The engines disagree:[/] {r['model']}, {r['data']}: {r['agreement_px_median']:.2f} px "
                f"while they follow somebody, expected {AGREEMENT_PX:g} at most."
            )
        return 1 if wrong else 0


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title="Pose engines in one run on one core, milliseconds of processor time a picture",
        caption="times: over LiteRT's. apart: between the engines, median and 95th percentile of all "
        "landmarks. Timed are, in a stream, pictures in which nobody was found or lost. detect: LiteRT "
        "searches crops as well and looks twice at whom it finds; search: a crop beside the full frame.",
        box=SIMPLE_HEAD,
    )
    for column in ("network", "mode", "pictures", "engine"):
        table.add_column(column, no_wrap=True)
    for column in ("found", "ms", "p95", "times", "apart, px"):
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        apart = row["agreement_px_median"]
        table.add_row(
            row["model"],
            row["mode"],
            row["data"],
            row["engine"],
            f"{row['found']} of {row['frames']}",
            _number(row["ms_median"], 1),
            _number(row["ms_p95"], 1),
            _number(row["times_litert"], 2),
            "-" if apart is None else f"{apart:.2f}, {row['agreement_px_p95']:.1f}",
        )
    return table


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


__all__ = ["PoseBenchmark"]
