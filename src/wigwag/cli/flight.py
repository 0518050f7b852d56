"""``wigwag flight``: what is in a recorded flight, and the end that one cut short lacks."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from wigwag.errors import DataError, InputError


@dataclass(frozen=True)
class Info:
    """Say what is in a recorded flight.

    Example: wigwag flight info flight.mcap
    """

    flight: tyro.conf.Positional[Path]
    """The .mcap file."""
    json: Path | None = None
    """File for the figures: one record."""

    def run(self) -> int:
        """Print it; return 0."""
        from rich.box import SIMPLE_HEAD
        from rich.console import Console
        from rich.table import Table

        from wigwag.evaluate.records import Records

        records = Records(self.json, shlex.join(["wigwag", "flight", "info", str(self.flight)]), None)
        console = Console()
        with console.status("reading"):
            figures, facts = look_into(self.flight)
        records.add(**figures, **{f"flown_{name}": value for name, value in facts.items()})
        taught = "none" if figures["model_bytes"] is None else f"{figures['model_bytes'] / 1e6:.1f} MB"
        rows = {
            "turns": f"{figures['turns']} in {figures['duration_s']:.1f} s",
            "gestures": str(figures["gestures"]),
            "pictures": f"{figures['pictures']}, depth: {figures['depth']}",
            "what was taught": taught,
            "size": f"{figures['bytes'] / 1e6:.1f} MB",
            "its end": "whole" if figures["whole"] else "cut short; wigwag flight repair FILE mends it",
        }
        table = Table(title=str(self.flight), box=SIMPLE_HEAD, show_header=False)
        for name, value in (rows | facts).items():
            table.add_row(name, value)
        console.print(table)
        return 0


def look_into(path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the figures of a recorded flight, and what it says of itself beside them.

    Raises:
        DataError: If it cannot be read or is no flight.
    """
    from wigwag.record.flight import Flight
    from wigwag.record.repair import is_whole

    flight = Flight.open(path)
    turns = gestures = 0
    first_s = last_s = 0.0
    for recorded in flight.turns():
        last_s = recorded.turn.situation.now_ns * 1e-9
        first_s = last_s if turns == 0 else first_s
        turns += 1
        gestures += recorded.gesture is not None and recorded.gesture.label is not None
    given = {"version", "config", "commands", "pose_config", "pictures", "depth", "tells_operator"}
    facts = {name: value for name, value in flight.facts.items() if name not in given}
    figures = {
        "flight": str(path), "turns": turns, "duration_s": last_s - first_s, "gestures": gestures,
        "pictures": flight.facts["pictures"], "depth": flight.facts["depth"],
        "model_bytes": None if flight.model is None else len(flight.model),
        "bytes": path.stat().st_size, "whole": is_whole(path),
    }  # fmt: skip
    return figures, facts


@dataclass(frozen=True)
class Repair:
    """Give flights that were cut short their end, in place, so that every MCAP reader opens them.

    Only a kill in the very moment of writing leaves such a file; what is whole in it is kept as it is.
    Exit code 2: one is no MCAP file; the others are repaired all the same.
    Example: wigwag flight repair flight.mcap
    """

    flights: tyro.conf.Positional[tuple[Path, ...]]
    """The .mcap files."""

    def run(self) -> int:
        """Repair them; return 0, or 2 if one is no MCAP file."""
        from rich.console import Console
        from rich.markup import escape

        from wigwag.record.repair import repair

        if not self.flights:
            raise InputError("There is nothing to repair: name at least one .mcap file.")
        console, wrong = Console(), Console(stderr=True)
        failed = False
        for path in self.flights:
            try:
                done = repair(path)
            except DataError as error:
                wrong.print(f"[bold red]error:[/] {escape(str(error))}", highlight=False, soft_wrap=True)
                failed = True
                continue
            state = "whole already" if done.complete else f"repaired, {done.dropped_bytes} bytes dropped"
            console.print(f"{path}: {state}; {done.messages} messages.", highlight=False)
        return 2 if failed else 0


@dataclass(frozen=True)
class FlightCommand:
    """Look into recorded flights (.mcap), and mend those that were cut short. Needs wigwag[record]."""

    action: tyro.conf.OmitArgPrefixes[
        tyro.conf.OmitSubcommandPrefixes[
            Annotated[Info, tyro.conf.subcommand("info")] | Annotated[Repair, tyro.conf.subcommand("repair")]
        ]
    ]

    def run(self) -> int:
        """Do what was asked for."""
        return self.action.run()


__all__ = ["FlightCommand"]
