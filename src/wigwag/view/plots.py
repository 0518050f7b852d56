"""Plots of a flight, as SVG text that a page can hold."""

from __future__ import annotations

import io
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from wigwag.evaluate.flight import FlightLog, Outcome, judge

COLOURS = {
    Outcome.RECOGNISED: "#1a9e6c",
    Outcome.LEFT_ALONE: "#8fa3ad",
    Outcome.MISSED: "#e0a100",
    Outcome.WRONG: "#d1345b",
    Outcome.FALSE_ON_OTHER: "#d1345b",
    Outcome.FALSE_ON_NOTHING: "#d1345b",
}
INK, BLUE, ORANGE = "#22303a", "#2b6cb0", "#d9792b"
STYLE: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#9fb0ba",
    "axes.labelcolor": INK,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": "#e3e9ec",
    "axes.grid": True,
    "axes.axisbelow": True,
    "svg.fonttype": "none",
    "svg.hashsalt": "wigwag",
}


def timeline(log: FlightLog) -> str:
    """Draw what was shown as bars and what was understood as marks, over time."""
    judgement = judge(log.shown, log.events)
    labels = list(dict.fromkeys(s.label for s, _, _ in judgement.showings if s.is_command))
    others = list(dict.fromkeys(s.label for s, _, _ in judgement.showings if not s.is_command))
    rows = {label: i for i, label in enumerate(reversed([*labels, *others]))}
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 0.9 + 0.27 * max(len(rows), 3)), layout="constrained")
        axes = figure.add_subplot()
        for showing, outcome, event in judgement.showings:
            axes.barh(
                rows[showing.label],
                showing.end_s - showing.start_s,
                left=showing.start_s,
                height=0.62,
                color=COLOURS[outcome],
                alpha=0.55 if showing.is_command else 0.4,
            )
            if event is not None and event.label in rows:
                axes.plot(event.decided_ns * 1e-9, rows[event.label], "v", color=COLOURS[outcome], ms=6)
        for event, outcome in judgement.false_events:
            if event.label in rows:
                axes.plot(event.decided_ns * 1e-9, rows[event.label], "X", color=COLOURS[outcome], ms=8)
        axes.set_yticks(list(rows.values()), [name.replace("_", " ") for name in rows])
        if others:
            axes.axhline(len(others) - 0.5, color="#9fb0ba", lw=0.8, ls=":")
        axes.set_xlabel("time in s   (bar: shown, triangle: decided, cross: false command)")
        axes.set_ylim(-0.6, len(rows) - 0.4)
        return _svg(figure)


def path(log: FlightLog) -> str:
    """Draw the drone's way and the operator's, seen from above."""
    drone = np.array([row.drone_m for row in log.rows])
    operator = np.array([row.operator_m for row in log.rows])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.6), layout="constrained")
        axes = figure.add_subplot()
        for i in range(0, len(drone), max(len(drone) // 40, 1)):
            axes.plot(
                [drone[i, 0], operator[i, 0]],
                [drone[i, 1], operator[i, 1]],
                color="#d5dfe4",
                lw=0.7,
                zorder=1,
            )
        axes.plot(drone[:, 0], drone[:, 1], color=BLUE, lw=1.4, label="drone")
        axes.plot(operator[:, 0], operator[:, 1], color=ORANGE, lw=1.4, label="operator")
        for way, colour in ((drone, BLUE), (operator, ORANGE)):
            axes.plot(*way[0, :2], "o", color=colour, ms=6)
            axes.plot(*way[-1, :2], "s", color=colour, ms=6)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="east in m", ylabel="north in m", title="From above (circle: start, square: end)")
        axes.legend(frameon=False)
        return _svg(figure)


def errors(log: FlightLog) -> str:
    """Draw bearing and distance errors and the altitude over time; grey where the drone does not follow."""
    time = np.array([row.time_s for row in log.rows])
    flown = np.array([row.flying for row in log.rows])
    series = (
        ("bearing error, °", [row.bearing_deg for row in log.rows], BLUE),
        ("distance error, m", [row.distance_error_m for row in log.rows], ORANGE),
        ("altitude, m", [row.drone_m[2] for row in log.rows], INK),
    )
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 5.2), layout="constrained")
        for axes, (name, values, colour) in zip(figure.subplots(3, 1, sharex=True), series, strict=True):
            y = np.array(values, dtype=float)
            axes.plot(time, y, color="#c3ced4", lw=0.8)
            axes.plot(time, np.where(flown, y, np.nan), color=colour, lw=1.2)
            axes.set_ylabel(name)
            if flown.any() and "error" in name:
                bound = 1.15 * np.abs(y[flown]).max() + 1e-3
                axes.set_ylim(-bound, bound)
        axes.set_xlabel("time in s")
        return _svg(figure)


def timing(log: FlightLog) -> str:
    """Draw how long a turn of the loop took."""
    pose = np.array([row.pose_ms for row in log.rows])
    loop = np.array([row.loop_ms for row in log.rows])
    top = float(np.percentile(loop, 99.5)) * 1.1
    bins = np.linspace(0, top, 60).tolist()
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 4.6), layout="constrained")
        axes = figure.add_subplot()
        axes.hist(pose.clip(0, top), bins, color=BLUE, alpha=0.65, label="finding the pose")
        axes.hist(loop.clip(0, top), bins, color=ORANGE, alpha=0.65, label="all, world included")
        axes.axvline(1000 / 30, color=INK, ls=":", lw=1)
        axes.set(xlabel="processor ms a frame", ylabel="frames", title="One turn of the loop")
        axes.legend(frameon=False)
        return _svg(figure)


def _svg(figure: Figure) -> str:
    FigureCanvasAgg(figure)
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]
