"""The report of a flight: one HTML file that holds everything it shows."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import UInt8
from jinja2 import Environment

from wigwag.evaluate.flight import FlightLog, judge
from wigwag.recognise.explain import Explanation


@dataclass(frozen=True, slots=True)
class Still:
    """A picture of the moment a gesture was decided."""

    caption: str
    jpeg: bytes
    why: Explanation | None = None
    """What it came from, if that can be told: drawn beside its nearest examples."""


def jpeg(rgb: UInt8[np.ndarray, "height width 3"], width: int = 420) -> bytes:
    """Shrink a picture to ``width`` pixels and encode it."""
    height = round(rgb.shape[0] * width / rgb.shape[1])
    small = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA)
    _, data = cv2.imencode(".jpg", small[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])
    return bytes(data.tobytes())


def write_report(
    out: Path,
    summary: dict[str, Any],
    log: FlightLog,
    stills: list[Still],
    film: Path | None = None,
) -> None:
    """Write the report of a flight.

    Args:
        out: The HTML file.
        summary: The figures of ``summary.json``.
        log: The flight.
        stills: What the camera saw when gestures were decided.
        film: The MP4 to embed.
    """
    from wigwag.view import plots  # and matplotlib with it: 30 MB that nobody needs in flight
    from wigwag.view.explained import svg_of

    judgement = judge(log.shown, log.events)
    rows = [
        {
            "time": f"{showing.start_s:.1f}",
            "label": showing.label.replace("_", " "),
            "kind": "command" if showing.is_command else "other",
            "outcome": outcome.value,
            "heard": "" if event is None or event.label is None else event.label.replace("_", " "),
            "confidence": "" if event is None else f"{event.confidence:.2f}",
            "delay": "" if event is None else f"{event.decided_ns * 1e-9 - showing.end_s:+.2f}",
            "reason": "" if event is None else event.reason,
        }
        for showing, outcome, event in judgement.showings
    ]
    false = [
        {
            "time": f"{event.decided_ns * 1e-9:.1f}",
            "label": str(event.label).replace("_", " "),
            "outcome": outcome.value,
            "reason": event.reason,
        }
        for event, outcome in judgement.false_events
    ]
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(files("wigwag.view").joinpath("report.html").read_text("utf-8"))
    pieces = template.generate(
        s=summary,
        rows=rows,
        false=false,
        stills=[{"caption": s.caption, "data": base64.b64encode(s.jpeg).decode()} for s in stills],
        film=None if film is None else _base64_of(film),
        explained=({"caption": s.caption, "svg": svg_of(s.why)} for s in stills if s.why is not None),
        timeline=plots.timeline(log),
        path=plots.path(log),
        errors=plots.errors(log),
        timing=plots.timing(log),
    )
    # Piece by piece: a film of 20 MB is never in memory, and no copy of the page with it.
    with out.open("w", encoding="utf-8") as file:
        file.writelines(pieces)


def _base64_of(path: Path) -> Iterator[str]:
    """Encode a file a piece at a time; all but the last are multiples of three bytes: no padding between."""
    with path.open("rb") as file:
        while part := file.read(3 * 2**16):
            yield base64.b64encode(part).decode("ascii")
