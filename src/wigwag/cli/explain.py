"""``wigwag explain``: why each gesture of a recorded flight was what it was, as pictures."""

from __future__ import annotations

import json as json_format
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    from wigwag.recognise.explain import Explanation
    from wigwag.record.replay import Replay
    from wigwag.stream.overhear import Overhearing


@dataclass(frozen=True)
class Explain:
    """Draw every gesture of a recorded flight beside its nearest enrolled examples. Needs wigwag[record].

    Each picture shows the movement, the examples aligned with it, their distances, and what would have made
    it a different answer. Also writes explained.json. Exit code 1: no gesture was heard.
    Example: wigwag explain flight.mcap --out explained
    """

    flight: tyro.conf.Positional[Path]
    """The .mcap file."""
    out: Path = Path("explained")
    """Folder for the pictures."""
    model: Path | None = None
    """What is heard with; by default what was heard with then."""
    refused: bool = False
    """Draw movements that were refused too."""

    def run(self) -> int:
        """Decide again, draw, write; return 0, or 1 if there was no gesture."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.cli.replay import taught_in
        from wigwag.cli.targets import make_folder
        from wigwag.record.flight import Flight
        from wigwag.record.replay import Replay
        from wigwag.stream.overhear import Overhearing, parts_of
        from wigwag.view.explained import png_of

        console, told = Console(), list[dict[str, Any]]()
        with threadpool_limits(1), console.status("deciding again") as status:
            flight = Flight.open(self.flight)
            taught = taught_in(flight, self.model)
            if taught is None:
                raise InputError(f"{self.flight}: holds no model. Name one with --model.")
            parts_of(taught)  # what cannot be explained is told before anything is done
            make_folder(self.out, "--out")
            listener = Overhearing(taught, flight.config.spot)
            for at_s, why in self._explained(Replay(flight, listener), listener):
                name = f"{len(told) + 1:03}_{why.gesture.label or 'none'}.png"
                status.update(f"drawing {name}")
                (self.out / name).write_bytes(png_of(why, f"{at_s:.1f} s"))
                told.append(facts(why, at_s) | {"picture": name})
        text = json_format.dumps(told, indent=1)
        (self.out / "explained.json").write_text(text + "\n", encoding="utf-8")
        console.print(f"{len(told)} pictures in [bold]{self.out}[/], figures in explained.json.")
        return 0 if told else 1

    def _explained(self, replay: Replay, listener: Overhearing) -> Iterator[tuple[float, Explanation]]:
        for _, step in replay:
            if step.gesture is None or (step.gesture.label is None and not self.refused):
                continue
            why = listener.explain()
            if why is not None:
                yield step.situation.now_ns * 1e-9, why


def facts(why: Explanation, at_s: float) -> dict[str, Any]:
    """Return an explanation as figures."""
    return {
        "time_s": at_s,
        "label": why.gesture.label,
        "most_like": why.label,
        "runner_up": why.runner_up,
        "sure": why.sure,
        "asked_for": why.least,
        "lead": why.lead,
        "over_nothing": why.over_nothing,
        "pushes": dict(zip(why.views, why.pushes.tolist(), strict=True)),
        "nearest": [
            {"label": e.label, "name": e.name, "times_the_usual": e.times,
             "by_view": dict(zip(why.views[: len(e.by_view)], e.by_view.tolist(), strict=True))}
            for e in why.nearest
        ],
        "would_change": list(why.answers),
    }  # fmt: skip


__all__ = ["Explain", "facts"]
