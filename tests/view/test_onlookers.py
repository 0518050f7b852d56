"""Whoever looks on: time is held to the wall's for a page, and Rerun is shown every turn."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.view.console.test_desk import Page
from tests.view.test_rerun import printed
from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.values import Command
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld
from wigwag.view.onlookers import Onlookers, Pace
from wigwag.view.rerun import RerunView

MS = 1_000_000


def test_time_is_held_to_the_walls_and_what_is_late_is_not_hurried() -> None:
    wall_ns, waited = [0], []

    def wait(seconds: float) -> None:
        waited.append(round(seconds, 3))
        wall_ns[0] += round(seconds * 1e9)

    pace = Pace(lambda: wall_ns[0], wait)
    for now_ms in (0, 33, 66):
        pace.wait(now_ms * MS)
    assert waited == [0.033, 0.033]
    wall_ns[0] += 2_000 * MS
    pace.wait(99 * MS)
    pace.wait(132 * MS)
    assert waited[2:] == [0.033]


def flown(onlookers: Onlookers, turns: int) -> PromptedFlight:
    airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), 2)
    flight = PromptedFlight(SketchWorld(airframe, lambda t: (4.5, 0.2), seed=2))
    onlookers.begin(flight.pilot)
    for turn in range(turns):
        if turn == 45:
            flight.prompter.says = Command.TAKE_OFF
        frame = flight.world.step()
        onlookers.turn(frame, flight.pilot.step(frame, flight.world.now_ns, onlookers.asked()))
    return flight


def test_a_flight_is_in_reruns_file(tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="needs rerun-sdk: pip install 'wigwag[view]'")
    view = RerunView(save=tmp_path / "flight.rrd", spawn=False)
    flown(Onlookers(view), 240)
    view.close()
    shown = printed(tmp_path / "flight.rrd")
    for path in (
        "/flight/drone", "/flight/operator", "/flight/way", "/flight/fence", "/figures/distance_m",
        "/figures/height_m", "/figures/sent_forward_m_s", "/world/camera/rgb", "/log",
    ):  # fmt: skip
        assert path in shown, path
    assert "/figures/battery" not in shown, "what is not known is not plotted"


def test_nobody_may_look_on() -> None:
    onlookers = Onlookers()
    assert flown(onlookers, 10).pilot.withheld is False and onlookers.asked() is None


def test_a_page_is_shown_a_flight() -> None:
    page = Page()
    flown(Onlookers(None, page), 90)
    assert page.shown and page.shown[-1].flight is not None
