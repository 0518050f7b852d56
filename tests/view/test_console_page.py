"""The console in a real browser: a simulated flight is seen, stopped and held from the page."""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from tests.view.browsers import Tab, chromium, of_color
from tests.view.console.test_console import snapshot
from tests.view.console_flight import fly
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.view.console.config import ConsoleConfig
from wigwag.view.console.console import Console
from wigwag.view.draw import RIGHT

NOSE = (255, 210, 60)
"""RGB of the front rotors: the drone's, and nothing else's."""
SCENE = np.s_[150:, :600]
"""Rows and columns of the screenshot that show the 3-D scene, below what viser says of the graphics."""


class Flown:
    """A flight in another process, as it tells of itself."""

    def __init__(self, seconds: float) -> None:
        context = multiprocessing.get_context("spawn")
        self._link, theirs = context.Pipe()
        self.process = context.Process(target=fly, args=(theirs, seconds), kwargs={"port": 0})
        self.process.start()
        theirs.close()
        assert self._link.poll(120), "the flight does not begin"
        self.url: str = self._link.recv()["url"]
        self.turns: list[dict[str, Any]] = []
        self._more = threading.Condition()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        try:
            while True:
                told = self._link.recv()
                with self._more:
                    self.turns.append(told)
                    self._more.notify_all()
        except (EOFError, OSError):
            return

    def until(self, holds: Callable[[dict[str, Any]], bool], after_s: float = 0.0) -> dict[str, Any]:
        """Wait for the first turn after a time for which something holds, and return it."""

        def found() -> dict[str, Any] | None:
            return next((t for t in self.turns if t["wall_s"] >= after_s and holds(t)), None)

        with self._more:
            assert self._more.wait_for(lambda: found() is not None, 120), self.turns[-1:]
            turn = found()
        assert turn is not None
        return turn


@contextmanager
def flight(seconds: float) -> Iterator[Flown]:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    flown = Flown(seconds)
    try:
        yield flown
    finally:
        flown.process.terminate()
        flown.process.join(10)


def test_a_flight_is_seen_and_stopped_from_the_page() -> None:
    with chromium() as browser, flight(900.0) as flown:
        tab = Tab(browser, flown.url)
        began = flown.until(lambda turn: turn["mode"] == "executing")
        tab.until("executing")
        first, first_turn = tab.picture(), flown.turns[-1]
        flown.until(lambda turn: turn["now_s"] > first_turn["now_s"] + 2.0)
        second, second_turn = tab.picture(), flown.turns[-1]
        moved = np.subtract(second_turn["position"], first_turn["position"])
        assert np.linalg.norm(moved) > 0.4, "the drone orbits"
        drones = [np.argwhere(of_color(picture[SCENE], NOSE)).mean(axis=0) for picture in (first, second)]
        assert np.linalg.norm(drones[1] - drones[0]) > 10, "and is seen to"
        operators = [of_color(picture[SCENE], RIGHT) for picture in (first, second)]
        assert operators[0].sum() > 30 and (operators[0] ^ operators[1]).sum() > 30, "the operator moves"

        other = Tab(browser, flown.url)
        other.page.locator("[data-mode]").wait_for()
        pressed_s = tab.press("STOP")
        held = flown.until(lambda turn: turn["mode"] == "holding", pressed_s)
        turn_s = np.median(np.diff([turn["wall_s"] for turn in flown.turns[-60:]]))
        took_s = held["wall_s"] - pressed_s
        print(f"stop held after {1e3 * took_s:.0f} ms; a turn of the loop takes {1e3 * turn_s:.0f} ms")
        assert took_s < max(0.3, 3 * turn_s), "a busy machine has slow turns; an idle one holds in 0.3 s"
        still = flown.until(lambda turn: turn["speed"] < 0.1, held["wall_s"])
        assert still["now_s"] - held["now_s"] < 1.5
        other.until("stop pressed on the page")
        other.until("holding")

        other.press("Hold")
        flown.until(lambda turn: turn["withheld"], held["wall_s"])
        tab.until("held at the console")
        tab.press("Engage")
        flown.until(lambda turn: not turn["withheld"], flown.turns[-1]["wall_s"])
        tab.press("Land")
        flown.until(lambda turn: turn["mode"] == "landing", held["wall_s"])
        flown.until(lambda turn: turn["mode"] == "disarmed", held["wall_s"])
        assert began["mode"] == "executing"
        assert tab.complaints == [] and other.complaints == []


def test_limits_are_tightened_on_the_page_and_only_so() -> None:
    with chromium() as browser, flight(900.0) as flown:
        tab = Tab(browser, flown.url)
        flown.until(lambda turn: turn["mode"] == "executing")
        tab.until("executing")
        speed = tab.page.locator("input[inputmode]").first
        speed.fill("0.3")
        speed.press("Enter")
        tab.press("Tighten")
        tab.until("max_speed_m_s is 0.3 from now on")
        flown.until(lambda turn: turn["limit"] == 0.3)
        tightened_s = flown.turns[-1]["wall_s"]
        speed.fill("1.2")
        speed.press("Enter")
        tab.press("Tighten")
        tab.until("in flight a limit only gets tighter")
        flown.until(lambda turn: turn["now_s"] > flown.turns[0]["now_s"], tightened_s)
        sent = [turn["sent"] for turn in flown.turns if turn["wall_s"] > tightened_s and turn["sent"]]
        assert sent and max(np.hypot(*s.velocity_m_s[:2]) for s in sent) < 0.3 + 1e-9
        assert tab.complaints == []


def test_without_the_token_a_browser_sees_nothing_and_commands_nothing() -> None:
    pytest.importorskip("viser", reason="needs viser: pip install 'wigwag[console]'")
    with chromium() as browser:
        page = Console(ConsoleConfig(port=0, token="a-long-enough-secret"))
        try:
            base = page.url.partition("?")[0]
            for wrong in ("", "?token=", "?token=a-wrong-secret-of-length"):
                tab = browser.new_page()
                answer = tab.goto(base + wrong)
                assert answer.status == 401 and "token" in tab.content()
                refused = tab.evaluate(CONNECT, base.replace("http", "ws") + wrong)
                assert refused == "closed"
                tab.context.clear_cookies()
            right = Tab(browser, page.url)
            right.page.get_by_role("button", name="STOP").wait_for()
            right.press("STOP")
            asks: list[Any] = []
            for _ in range(200):
                asks += page.asks()
                if asks:
                    break
                right.page.wait_for_timeout(50)
            assert [ask.button for ask in asks] == ["stop"]
            page.show(snapshot())
            right.until("no news for")
            assert right.complaints == []
        finally:
            page.close()


CONNECT = """url => new Promise(done => {
    const socket = new WebSocket(url, 'viser-v1.1.1');
    socket.onopen = () => done('open');
    socket.onclose = () => done('closed');
})"""
