"""A decision as a picture: the movement beside its nearest examples, and what tells them apart."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from jaxtyping import Float, Int
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wigwag.recognise.explain import Example, Explanation
from wigwag.skeleton import BONES, LANDMARKS
from wigwag.view.plots import BLUE, INK, ORANGE, STYLE

_ROOM = 0.42
"""Above and below a skeleton, in arm's lengths: for what is written there."""


@dataclass(frozen=True, slots=True)
class _Room:
    """The place where the skeletons stand."""

    moments: int
    """Skeletons a row."""
    wide: float
    """Width over height."""
    letters: float
    """Size of what is written there, points."""
    distance: str
    """What follows an example's distance."""


_FULL = _Room(9, 1.44, 9.5, "times the usual distance")
_TURN_RAD = 0.5
"""They are drawn from a little beside, so that what moves to and fro is seen."""
_LEFT, _RIGHT, _MIDDLE = "#2f80d8", "#e0771a", "#4b5a63"
_GREEN, _RED = "#1a9e6c", "#d1345b"
_SMALL: dict[str, Any] = {"color": "#8fa3ad", "fontsize": 7.5, "ha": "center", "va": "bottom"}


def figure_of(explained: Explanation, title: str = "") -> Figure:
    """Draw a decision: rows of skeletons on the left, distances and what gave the lead on the right.

    Args:
        explained: The decision.
        title: Stands before what was decided, such as when.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(13.0, 7.4), layout="constrained")
        FigureCanvasAgg(figure)
        rows = 1 + len(explained.nearest)
        grid = figure.add_gridspec(2, 2, width_ratios=(2.6, 1), height_ratios=(1, 1))
        strip = figure.add_subplot(grid[:, 0])
        _strip(strip, explained, rows, _FULL)
        _distances(figure.add_subplot(grid[0, 1]), explained)
        _pushes(figure.add_subplot(grid[1, 1]), explained)
        figure.suptitle(headline_of(explained, title), x=0.01, ha="left", fontsize=13, fontweight="bold")
        figure.supxlabel("\n".join(_lines(explained)), x=0.01, ha="left", fontsize=9.5, color=INK)
        return figure


def svg_of(explained: Explanation, title: str = "") -> str:
    """Return the picture as SVG text that a page can hold."""
    with mpl.rc_context(STYLE):
        text = io.StringIO()
        figure_of(explained, title).savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def png_of(explained: Explanation, title: str = "", dpi: int = 100) -> bytes:
    """Return the picture as a PNG file's bytes."""
    data = io.BytesIO()
    figure_of(explained, title).savefig(data, format="png", dpi=dpi)
    return data.getvalue()


def narrow_figure_of(explained: Explanation) -> Figure:
    """Draw it for a column beside something else: fewer moments, one above the other, and no text around."""
    with mpl.rc_context(STYLE | {"font.size": 8.5}):
        rows = 1 + len(explained.nearest)
        strip_in, bars_in = 1.05 * rows, 4.1
        figure = Figure(figsize=(5.0, strip_in + bars_in))
        FigureCanvasAgg(figure)
        share, room = bars_in / (strip_in + bars_in), _Room(6, 5.0 / strip_in, 8.0, "times the usual")
        _strip(figure.add_axes((0.0, share, 1.0, 1.0 - share)), explained, rows, room)
        grid = figure.add_gridspec(
            2, 1, left=0.2, right=0.97, top=0.93 * share, bottom=0.06 * share, hspace=0.65
        )
        _distances(figure.add_subplot(grid[0]), explained, 0.14)
        _pushes(figure.add_subplot(grid[1]), explained)
        return figure


def narrow_png_of(explained: Explanation, dpi: int = 150) -> bytes:
    """Return the narrow picture as a PNG file's bytes."""
    data = io.BytesIO()
    with mpl.rc_context(STYLE):
        narrow_figure_of(explained).savefig(data, format="png", dpi=dpi)
    return data.getvalue()


def _plainly(label: str | None) -> str:
    return "no gesture" if label is None else label.replace("_", " ")


def headline_of(explained: Explanation, title: str = "") -> str:
    """Say what was decided, and how sure it was.

    Args:
        explained: The decision.
        title: Stands before it, such as when.
    """
    said = _plainly(explained.gesture.label)
    if explained.gesture.label is None:
        said += f" (most like {_plainly(explained.label)})"
    sure = f"{explained.sure:.3f} sure, {explained.least:.3f} asked for"
    return f"{title}{': ' if title else ''}{said}, {sure}"


def _lines(explained: Explanation) -> list[str]:
    """Return what would have made it a different answer, two sentences a line."""
    said = explained.answers
    return ["It would have been:", *("   ".join(said[i : i + 2]) for i in range(0, len(said), 2))]


def _strip(axes: Any, explained: Explanation, rows: int, room: _Room) -> None:
    """Draw the movement, and below it each example at the moments that DTW lays on it."""
    moments = np.round(np.linspace(0, len(explained.joints) - 1, room.moments)).astype(int)
    everybody = np.concatenate([explained.joints, *(e.joints for e in explained.nearest)])
    below = float(everybody[..., 1].max()) + _ROOM
    high = below - float(everybody[..., 1].min()) + 2 * _ROOM
    wide, last = room.wide * rows * high / room.moments, max(len(explained.joints) - 1, 1)
    lanes = [(f"what was seen, {explained.duration_s:.1f} s", explained.joints, list(moments), INK)]
    for example in explained.nearest:
        colour = _GREEN if example.label == explained.label else _RED
        lanes.append(
            (_named(example, room.distance), example.joints, _matched(example.path, moments), colour)
        )
    for row, (name, joints, frames, colour) in enumerate(lanes):
        foot = (rows - 1 - row) * high
        axes.axhline(foot, color="#e3e9ec", lw=0.8)
        for k, frame in enumerate(frames):
            _skeleton(axes, joints[frame], k * wide, foot + below)
            axes.text(k * wide, foot + 0.05, f"{100 * frame / last:.0f} %", **_SMALL)
        axes.text(
            -0.5 * wide,
            foot + 0.97 * high,
            name,
            color=colour,
            fontsize=room.letters,
            weight="bold",
            va="top",
        )
    axes.set_xlim(-0.55 * wide, (room.moments - 0.45) * wide)
    axes.set_ylim(-0.05, rows * high)
    axes.set_aspect("equal")
    axes.axis("off")


def _named(example: Example, distance: str) -> str:
    label = "" if example.name.startswith(example.label) else f"{example.label}: "
    return f"{label}{example.name}, {example.times:.2f} {distance}".replace("_", " ")


def _matched(path: Int[np.ndarray, "steps 2"], moments: Int[np.ndarray, " moments"]) -> list[int]:
    """Return the example's frame for each moment of the movement: the middle one, if there are several."""
    return [int(np.median(path[path[:, 0] == moment, 1])) for moment in moments]


def _skeleton(axes: Any, joints: Float[np.ndarray, "13 3"], right: float, up: float) -> None:
    across = np.cos(_TURN_RAD) * joints[:, 0] + np.sin(_TURN_RAD) * joints[:, 2] + right
    for a, b in BONES:
        sides = {LANDMARKS[end].partition("_")[0] for end in (a, b)}
        colour = _LEFT if sides == {"left"} else _RIGHT if sides == {"right"} else _MIDDLE
        axes.plot(across[[a, b]], up - joints[[a, b], 1], color=colour, lw=1.6, solid_capstyle="round")
    axes.plot(across[0], up - joints[0, 1], "o", color=_MIDDLE, ms=4)


def _distances(axes: Any, explained: Explanation, below: float = 0.08) -> None:
    """Draw how far the nearest examples are in each view; and what is what, so far below."""
    shown: list[Example] = [explained.nearest[0]]
    shown += [e for e in explained.nearest if e.label != explained.label][:1]
    _bars(
        axes, explained.views[: len(shown[0].by_view)], [e.by_view for e in shown], [_GREEN, _RED],
        [f"nearest {_plainly(e.label)}" for e in shown],
    )  # fmt: skip
    axes.legend(frameon=False, fontsize=8.5, loc="upper center", bbox_to_anchor=(0.4, -below), ncols=2)
    axes.axvline(1.0, color=INK, ls=":", lw=1)
    axes.set_title("Distance by view (1: any two examples)", fontsize=9.5)


def _pushes(axes: Any, explained: Explanation) -> None:
    """Draw what each view gives to the lead over the runner-up."""
    pushes = explained.pushes
    colours = [BLUE if push >= 0 else ORANGE for push in pushes]
    axes.barh(range(len(pushes)), pushes, color=colours, height=0.62)
    axes.set_yticks(range(len(pushes)), explained.views)
    axes.invert_yaxis()
    axes.axvline(0, color=INK, lw=0.8)
    other = _plainly(explained.runner_up) if explained.runner_up is not None else "nothing"
    axes.set_title(f"What gives the lead of {explained.lead:.2f} over {other}", fontsize=9.5)


def _bars(
    axes: Any,
    names: Sequence[str],
    groups: Sequence[np.ndarray],
    colours: Sequence[str],
    labels: Sequence[str],
) -> None:
    height = 0.76 / len(groups)
    for k, (values, colour, label) in enumerate(zip(groups, colours, labels, strict=False)):
        at = np.arange(len(names)) + (k - (len(groups) - 1) / 2) * height
        axes.barh(at, values, height=0.9 * height, color=colour, label=label)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()


__all__ = ["figure_of", "headline_of", "narrow_figure_of", "narrow_png_of", "png_of", "svg_of"]
