"""The page: what stands beside the 3-D scene, and what its buttons ask for."""

from __future__ import annotations

import base64
from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from jaxtyping import UInt8

from wigwag.fly.tighten import DIALS, setting
from wigwag.view.console.scene import Scene
from wigwag.view.console.teaching import TeachingPanel
from wigwag.view.console.text import line_html
from wigwag.view.console.values import Ask, Button, Flight, Line, Picture, Snapshot
from wigwag.view.console.why import WhyPanel
from wigwag.view.draw import draw_body, draw_skeleton

if TYPE_CHECKING:
    from wigwag.view.console.config import ConsoleConfig

_JPEG_QUALITY = 70
_SHOWN_LINES = 9
_BUTTONS: tuple[tuple[Button, str, str, str], ...] = (
    (Button.STOP, "STOP", "red", "Hold at once. The next gesture is obeyed."),
    (Button.HOLD, "Hold", "orange", "Hold, and refuse gestures until somebody presses engage."),
    (Button.LAND, "Land", "blue", "Land where it is. Stop breaks it off."),
    (Button.ENGAGE, "Engage", "green", "Let go of a hold; whoever is seen alone becomes the operator."),
)


class Page:
    """Fills a viser server's page from snapshots, and says what is pressed.

    Args:
        server: A ``viser.ViserServer``.
        config: What it is called, and what can be done.
        ask: Is called with what somebody asks for, from threads of the server.
    """

    def __init__(self, server: Any, config: ConsoleConfig, ask: Callable[[Ask], None]) -> None:
        self._server, self._ask = server, ask
        gui = server.gui
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, control_width="large")
        gui.main_panel.dock_right()
        gui.set_panel_label(config.title)
        self.scene = Scene(server)
        self._state = gui.add_html("waiting for the first picture ...")
        self._teaching = TeachingPanel(gui, ask) if config.teaches else None
        for button, label, color, hint in _BUTTONS:
            if config.flies or (button is Button.ENGAGE and not config.teaches):
                self._add_button(button, label, color, hint)
        self._picture = gui.add_html("")
        self._events = gui.add_html("")
        self._why = WhyPanel(gui) if config.flies else None
        self._sliders: dict[str, Any] = {}
        self._set: dict[str, float] = {}
        """What each slider last was set to by us: where it stands otherwise, somebody has moved it."""
        self._lines: tuple[Line, ...] = ()
        self._shown = False

    def show(self, snapshot: Snapshot) -> None:
        """Show a snapshot to everybody who looks, as one change."""
        self._shown = True
        with self._server.atomic():
            self.scene.show(snapshot)
            self._state.content = state_html(snapshot)
            if snapshot.lesson is not None and self._teaching is not None:
                self._teaching.show(snapshot.lesson)
            if snapshot.lines != self._lines:
                self._lines = snapshot.lines
                self._events.content = events_html(snapshot.lines)
            if self._why is not None:
                self._why.show(snapshot.whys)
            if snapshot.flight is not None:
                self._dials(snapshot.flight)
            if snapshot.picture is not None:
                self._picture.content = picture_html(drawn(snapshot.picture, snapshot))

    def say_silent(self, silent_s: float) -> None:
        """Say that the loop is silent, so that nobody takes an old picture for now; and why, if it learns."""
        if not self._shown:
            return
        learns = "" if self._teaching is None else self._teaching.learning
        text, color = f"no news for {silent_s:.0f} s: what is shown is old", "#a00"
        if learns:
            text, color = f"learning {learns} for {silent_s:.0f} s: what is shown is from before", "#0a5f8a"
        self._state.content = f'<div style="background:{color};padding:.6em .8em"><b>{escape(text)}</b></div>'

    def _add_button(self, button: Button, label: str, color: str, hint: str) -> None:
        made = self._server.gui.add_button(label, color=color, hint=hint)
        made.on_click(lambda _: self._ask(Ask(button)))

    def _dials(self, flight: Flight) -> None:
        """Make the sliders once the limits are known; let those that nobody has moved say what holds."""
        if not self._sliders:
            self._add_sliders(flight)
        for name, slider in self._sliders.items():
            now = setting(flight.limits, name)
            if now is not None and abs(now - self._set[name]) > 1e-6:
                self._set[name] = now
                slider.value = now

    def _add_sliders(self, flight: Flight) -> None:
        gui = self._server.gui
        with gui.add_folder("Limits: in flight only tighter"):
            for dial in DIALS:
                first, now = setting(flight.start, dial.name), setting(flight.limits, dial.name)
                if first is None or now is None or abs(first - dial.tightest) < 1e-6:
                    continue
                low, high = sorted((first, dial.tightest))
                slider = gui.add_slider(f"{dial.label}, {dial.unit}", low, high, _step(high - low), now)
                self._sliders[dial.name], self._set[dial.name] = slider, now
            apply = gui.add_button("Tighten", hint="Set the limits as the sliders stand.")
        apply.on_click(lambda _: self._tighten())

    def _tighten(self) -> None:
        """Ask for every limit whose slider was moved; what is refused springs back."""
        for name, slider in self._sliders.items():
            if abs(slider.value - self._set[name]) > 1e-6:
                self._ask(Ask(None, name, float(slider.value)))
                slider.value = self._set[name]


def drawn(picture: Picture, snapshot: Snapshot) -> UInt8[np.ndarray, "height width 3"]:
    """Return the picture with everybody's landmarks drawn into it."""
    rgb = picture.rgb.copy()
    scale = rgb.shape[1] / picture.size_px[0]
    for figure in snapshot.figures:
        if figure.points_px is None or figure.visibility is None:
            continue
        points = figure.points_px * scale
        if figure.is_operator:
            from wigwag.pose.body import Body

            draw_body(rgb, Body(points, figure.visibility, np.zeros((33, 3)), None, None))
        else:
            draw_skeleton(rgb, points, figure.visibility, (), [""] * len(points))
    return rgb


def picture_html(rgb: UInt8[np.ndarray, "height width 3"]) -> str:
    """Return a picture as part of the page.

    viser's own images are withdrawn when the next one comes, which a slow browser complains of.
    """
    height, width = rgb.shape[:2]
    fine, jpeg = cv2.imencode(".jpg", rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    data = base64.b64encode(jpeg.tobytes()).decode() if fine else ""
    return (
        f'<div style="padding:.3em .7em;aspect-ratio:{width}/{height}"><img decoding="sync" alt="camera" '
        f'style="width:100%;display:block" src="data:image/jpeg;base64,{data}"></div>'
    )


def state_html(snapshot: Snapshot) -> str:
    """Return the state of the moment as a table."""
    flight = snapshot.flight
    rows: list[tuple[str, str]] = []
    if flight is not None:
        rows += _flight_rows(flight)
    who = snapshot.who
    if snapshot.engaging > 0:
        who += f" (a hand is up: {snapshot.engaging:.0%})"
    rows.append(("operator", who))
    rows.append(
        (
            "loop",
            f"{snapshot.rate_hz:.0f} Hz; pose {snapshot.pose_ms:.1f} ms, rest {snapshot.rest_ms:.1f} ms",
        )
    )
    head = ""
    if flight is not None:
        mode = escape(flight.mode.replace("_", " "))
        held = " &middot; held at the console" if flight.withheld else ""
        head = (
            f'<div data-mode="{mode}" style="font-size:1.35em;font-weight:700;margin-bottom:.25em">'
            f"{mode}{held}</div>"
        )
    body = "".join(
        f'<tr><td style="opacity:.6;padding-right:.8em">{escape(name)}</td><td>{escape(text)}</td></tr>'
        for name, text in rows
    )
    return f'<div style="padding:.4em .8em;font-size:.85em">{head}<table>{body}</table></div>'


def _flight_rows(flight: Flight) -> list[tuple[str, str]]:
    state = flight.state
    battery = "not known" if state.battery is None else f"{100 * state.battery:.0f} %"
    away = "not known" if flight.distance_m is None else f"{flight.distance_m:.2f} m"
    rows = [
        (
            "vehicle",
            f"{flight.craft}, {state.position_m[2]:.2f} m high, asked for {flight.speed_m_s:.2f} m/s",
        ),
        ("distance", f"{away}; keeps {flight.goal.distance_m:.1f} m"),
        ("battery", battery),
    ]
    if flight.changed:
        rows.append(("held back by", flight.changed))
    if state.trouble or state.denied:
        rows.append(("it says", state.trouble or state.denied))
    return rows


def events_html(lines: tuple[Line, ...]) -> str:
    """Return the last events, the newest first."""
    shown = "".join(line_html(line) for line in reversed(lines[-_SHOWN_LINES:]))
    return f'<div style="padding:.4em .8em;font-size:.85em;min-height:9em">{shown}</div>'


def _step(span: float) -> float:
    """Return a slider's step: fine enough, and round."""
    return 0.05 if span < 5 else 0.1 if span < 10 else 0.5


__all__ = ["Page", "drawn", "events_html", "picture_html", "state_html"]
