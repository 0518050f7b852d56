"""``wigwag replay``: a recorded flight is decided again, and what is decided otherwise is shown."""

from __future__ import annotations

import json as json_format
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.record.flight import Flight
    from wigwag.record.replay import Comparison
    from wigwag.stream.models import Taught

_SHOWN = 40


@dataclass(frozen=True)
class ReplayCommand:
    """Run the chain again over a recorded flight and compare every decision. Needs wigwag[record].

    With the flight's own model and its poses every decision is the same to the last bit; another --model
    shows what it would have done. The drone does as it did: only decisions are new. Exit code: 0 all the
    same, 1 something differs, 2 wrong input.
    Example: wigwag replay flight.mcap --model mine.wigwag
    """

    flight: tyro.conf.Positional[Path]
    """The .mcap file; one that was cut short is read as far as it goes."""
    model: Path | None = None
    """What is heard with; by default what was heard with then."""
    source: Annotated[Literal["poses", "frames"], tyro.conf.arg(name="from")] = "poses"
    """What is decided from: poses, as they were measured; or frames, for flights recorded with
    --record-depth. Pictures kept as JPEG lose detail: only --record-pictures png gives the same poses."""
    models_dir: tyro.conf.Suppress[Path | None] = None
    json: Path | None = None
    """File for the figures and all differences."""

    def run(self) -> int:
        """Replay and compare; return 0 if all is the same, else 1."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.record.flight import Flight
        from wigwag.record.replay import Comparison, Replay
        from wigwag.stream.listener import listening

        console, compared = Console(), Comparison()
        with threadpool_limits(1):
            flight = Flight.open(self.flight)
            taught = taught_in(flight, self.model)
            listener = None if taught is None else listening(taught, flight.config.spot)
            replay = Replay(flight, listener, self.source, models_dir=self.models_dir)
            began = time.perf_counter()
            with console.status("deciding again") as status:
                for then, now in replay:
                    compared.note(then, now)
                    if compared.turns % 300 == 0:
                        status.update(f"deciding again: {compared.duration_s:.0f} s of the flight")
            spent_s = time.perf_counter() - began
        if not compared.turns:
            raise InputError(f"{self.flight}: holds not one whole turn.")
        self._account(console, compared, spent_s, taught is not None)
        return 0 if compared.same else 1

    def _account(self, console: Console, compared: Comparison, spent_s: float, heard: bool) -> None:
        from wigwag import __version__

        times = compared.duration_s / max(spent_s, 1e-9)
        console.print(
            f"{compared.turns} turns, {compared.duration_s:.1f} s of flight, decided again in "
            f"{spent_s:.1f} s: {times:.1f} times real time.",
            highlight=False,
        )
        if not heard:
            console.print("No model is in the file: gestures are those that were heard then.")
        show(console, compared)
        if self.json is not None:
            figures: dict[str, Any] = asdict(compared) | {
                "command": f"wigwag replay {self.flight}", "flight": str(self.flight), "from": self.source,
                "model": None if self.model is None else str(self.model), "same": compared.same,
                "duration_s": compared.duration_s, "spent_s": spent_s, "times_real_time": times,
                "seed": None, "version": __version__,
            }  # fmt: skip
            try:
                self.json.parent.mkdir(parents=True, exist_ok=True)
                self.json.write_text(json_format.dumps(figures, indent=1) + "\n", encoding="utf-8")
            except OSError as error:
                raise InputError(f"{self.json}: cannot be written ({error.strerror}).") from error


def taught_in(flight: Flight, other: Path | None = None) -> Taught | None:
    """Return what a flight was heard with, or another model; ``None``: there is none in the file.

    Raises:
        ModelError: If it is damaged, or of another version.
    """
    from wigwag.stream.models import load_model

    if other is not None:
        return load_model(other)[0]
    if flight.model is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.wigwag"
        file.write_bytes(flight.model)
        return load_model(file)[0]


def show(console: Console, compared: Comparison) -> None:
    """Print what differs."""
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    labels = [label for _, label in compared.heard if label is not None]
    if compared.same:
        console.print(
            f"[bold green]the same to the last bit[/]: {len(labels)} gestures ({len(compared.heard)} with "
            f"what was refused), {compared.turns} verdicts and set-points.",
            highlight=False,
        )
    else:
        console.print(
            f"[bold red]not the same[/], from {compared.first_s:.1f} s on: {compared.gestures} turns with "
            f"another gesture, {compared.verdicts} with another verdict, {compared.setpoints} with another "
            f"set-point (up to {compared.most_m_s:.2f} m/s).",
            highlight=False,
        )
    if compared.poses:
        console.print(f"{compared.poses} poses are not those of then.", highlight=False)
    if not compared.differences:
        return
    table = Table(title="Decided otherwise", box=SIMPLE_HEAD)
    for column in ("s", "what", "then", "now"):
        table.add_column(column)
    for one in compared.differences[:_SHOWN]:
        table.add_row(f"{one.time_s:.2f}", one.what, escape(one.then), escape(one.now))
    console.print(table)
    if len(compared.differences) > _SHOWN:
        console.print(f"... and {len(compared.differences) - _SHOWN} more; --json FILE has them all.")


__all__ = ["ReplayCommand", "show", "taught_in"]
