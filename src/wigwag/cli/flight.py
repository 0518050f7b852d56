"""``wigwag flight``: what is in a recorded flight, and the end that one cut short lacks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Info:
    """Say what is in a recorded flight.

    Example: wigwag flight info flight.mcap
    """

    flight: tyro.conf.Positional[Path]
    """The .mcap file."""

    def run(self) -> int:
        """Print it; return 0."""
        from rich.box import SIMPLE_HEAD
        from rich.console import Console
        from rich.table import Table

        from wigwag.record.flight import Flight
        from wigwag.record.repair import is_whole

        flight, console = Flight.open(self.flight), Console()
        table = Table(title=str(self.flight), box=SIMPLE_HEAD, show_header=False)
        turns = gestures = 0
        first_s = last_s = 0.0
        for recorded in flight.turns():
            last_s = recorded.turn.situation.now_ns * 1e-9
            first_s = last_s if turns == 0 else first_s
            turns += 1
            gestures += recorded.gesture is not None and recorded.gesture.label is not None
        model = "none" if flight.model is None else f"{len(flight.model) / 1e6:.1f} MB"
        rows = {
            "turns": f"{turns} in {last_s - first_s:.1f} s",
            "gestures": str(gestures),
            "pictures": f"{flight.facts['pictures']}, depth: {flight.facts['depth']}",
            "what was taught": model,
            "size": f"{self.flight.stat().st_size / 1e6:.1f} MB",
            "its end": "whole" if is_whole(self.flight) else "cut short; wigwag flight repair FILE mends it",
        }
        given = {"version", "config", "commands", "pose_config", "pictures", "depth", "tells_operator"}
        for name, value in (rows | {k: v for k, v in flight.facts.items() if k not in given}).items():
            table.add_row(name, value)
        console.print(table)
        return 0


@dataclass(frozen=True)
class Repair:
    """Give flights that were cut short their end, in place, so that every MCAP reader opens them.

    Only a kill in the very moment of writing leaves such a file; what is whole in it is kept as it is.
    Exit code 1: one is no MCAP file. Example: wigwag flight repair flight.mcap
    """

    flights: tyro.conf.Positional[tuple[Path, ...]]
    """The .mcap files."""

    def run(self) -> int:
        """Repair them; return 0, or 1 if one cannot be."""
        from rich.console import Console

        from wigwag.errors import DataError, InputError
        from wigwag.record.repair import repair

        if not self.flights:
            raise InputError("There is nothing to repair: name at least one .mcap file.")
        console, failed = Console(), False
        for path in self.flights:
            try:
                done = repair(path)
            except DataError as error:
                console.print(f"[red]{error}[/]", highlight=False)
                failed = True
                continue
            state = "whole already" if done.complete else f"repaired, {done.dropped_bytes} bytes dropped"
            console.print(f"{path}: {state}; {done.messages} messages.", highlight=False)
        return int(failed)


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
