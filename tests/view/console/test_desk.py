"""Between loop and page: what is pressed reaches the pilot by the supervisor's rules, and what is shown."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.view.console.test_console import snapshot
from tests.view.seen import body, somebody, standing
from wigwag.camera.frame import Frame, Intrinsics
from wigwag.evaluate.prompted import PromptedFlight, Prompter
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.gesture import Gesture
from wigwag.recognise.explain import Example, Explanation
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld
from wigwag.view.console.desk import SNAPSHOT_HZ, Desk
from wigwag.view.console.page import events_html, picture_html, state_html
from wigwag.view.console.teaching import lesson_html
from wigwag.view.console.values import Ask, Button, Lesson, Line, Snapshot, Why, newer
from wigwag.view.console.why import why_html


class Page:
    """Stands where the console goes: wishes are put into it, snapshots gather."""

    trouble = ""

    def __init__(self) -> None:
        self.wishes: list[Ask] = []
        self.shown: list[Snapshot] = []

    def show(self, snapshot: Snapshot) -> None:
        self.shown.append(snapshot)

    def asks(self) -> list[Ask]:
        wishes, self.wishes = self.wishes, []
        return wishes


class Bench:
    """A flight in a sketched world with a page beside it; the wall's clock is the world's."""

    def __init__(self) -> None:
        airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), 2)
        self.flown = PromptedFlight(SketchWorld(airframe, lambda t: (4.5, 0.2), seed=2))
        self.pilot, self.page = self.flown.pilot, Page()
        self.desk = Desk(self.page, self.pilot, clock_ns=lambda: self.flown.world.now_ns)

    def turn(self, *wishes: Ask, gesture: Command | None = None) -> None:
        self.page.wishes += wishes
        asked, world = self.desk.asked(), self.flown.world
        if gesture is not None:
            self.flown.prompter.says = gesture
        frame = world.step()
        step = self.pilot.step(frame, world.now_ns, asked)
        self.desk.show(frame, step)

    def turns(self, seconds: float) -> None:
        for _ in range(round(seconds * 30)):
            self.turn()

    def up(self) -> Bench:
        self.turns(1.5)
        self.turn(gesture=Command.TAKE_OFF)
        self.turns(6.0)
        assert self.mode is Mode.FOLLOWING
        return self

    @property
    def mode(self) -> Mode:
        return self.pilot.supervisor.mode

    @property
    def said(self) -> list[str]:
        return [line.text for line in self.desk._lines]


def press(button: Button) -> Ask:
    return Ask(button)


def test_stop_holds_within_the_turn_and_the_next_gesture_moves_it() -> None:
    bench = Bench().up()
    bench.turn(press(Button.STOP))
    assert bench.mode is Mode.HOLDING
    bench.turns(2.0)
    bench.turn(gesture=Command.UP)
    assert bench.mode is Mode.EXECUTING
    assert "stop pressed on the page" in bench.said and "stop: holding" in bench.said


def test_hold_keeps_it_from_gestures_until_engage() -> None:
    bench = Bench().up()
    bench.turn(press(Button.HOLD))
    bench.turns(2.0)
    bench.turn(gesture=Command.UP)
    assert bench.mode is Mode.HOLDING
    assert bench.said[-1] == "up: held at the console, until somebody there presses engage"
    bench.turn(press(Button.ENGAGE))
    assert bench.mode is Mode.HOLDING, "engage lets go, and moves nothing"
    bench.turns(1.5)
    bench.turn(gesture=Command.UP)
    assert bench.mode is Mode.EXECUTING


def test_land_lands_and_stop_comes_before_it() -> None:
    bench = Bench().up()
    bench.turn(press(Button.LAND), press(Button.STOP))
    assert bench.mode is Mode.HOLDING
    bench.turn(press(Button.LAND))
    assert bench.mode is Mode.LANDING
    bench.turns(6.0)
    assert bench.mode is Mode.DISARMED


@pytest.mark.parametrize("button", list(Button))
def test_on_the_ground_no_button_arms(button: Button) -> None:
    bench = Bench()
    bench.turns(1.5)
    bench.turn(press(button))
    bench.turns(2.0)
    assert bench.mode is Mode.DISARMED and not bench.flown.world.airframe.state.armed


def test_a_held_drone_on_the_ground_does_not_take_off() -> None:
    bench = Bench()
    bench.turns(1.5)
    bench.turn(press(Button.HOLD))
    bench.turn(gesture=Command.TAKE_OFF)
    assert bench.mode is Mode.DISARMED and "held at the console" in bench.said[-1]


def test_limits_are_tightened_and_never_loosened() -> None:
    bench = Bench().up()
    bench.turn(Ask(None, "max_speed_m_s", 0.4), Ask(None, "colour", 1.0))
    assert bench.pilot.supervisor.config.max_speed_m_s == 0.4
    bench.turn(Ask(None, "max_speed_m_s", 1.2))
    assert bench.pilot.supervisor.config.max_speed_m_s == 0.4
    assert "max_speed_m_s is 0.4 from now on" in bench.said
    assert "refused: colour: 1.0 cannot be set" in bench.said
    assert any("in flight a limit only gets tighter" in text for text in bench.said)
    bench.turn(Ask(None, "max_distance_m", 4.7))
    assert bench.pilot.helm.movement.config.max_distance_m == 4.7, "and movements keep within"


def test_snapshots_are_few_whole_and_can_be_sent() -> None:
    bench = Bench().up()
    assert len(bench.page.shown) == pytest.approx(bench.flown.now_s * SNAPSHOT_HZ, rel=0.2)
    pictures = sum(shown.picture is not None for shown in bench.page.shown)
    assert pictures == pytest.approx(len(bench.page.shown) / 2, abs=1.0)
    last = pickle.loads(pickle.dumps(next(s for s in bench.page.shown[::-1] if s.picture is not None)))
    assert last.flight.mode is Mode.FOLLOWING and last.flight.distance_m == pytest.approx(4.5, abs=0.4)
    assert last.rate_hz == pytest.approx(30.0, rel=0.05)
    assert [line.text for line in last.lines][:3] == ["take off 100%", "take off: arming", last.lines[2].text]
    assert last.figures[0].is_operator and last.picture.size_px == (4, 4)
    shown = state_html(last)
    assert "following" in shown and "keeps 4.5 m" in shown and "not known" in shown


class Eyes:
    """Sees two people, and is called."""

    why = "nobody has engaged"
    called = 0

    def __init__(self) -> None:
        self.people = (
            somebody(1, body(), standing(), engaging=0.4),
            somebody(2, body(), None),
        )

    def call_operator(self) -> None:
        self.called += 1


def test_watching_shows_everybody_and_engage_calls_for_an_operator() -> None:
    page, eyes, clock = Page(), Eyes(), iter(range(0, 10**12, 10**8))
    desk = Desk(page, None, eyes, clock_ns=lambda: next(clock))  # type: ignore[arg-type]
    frame = Frame(np.zeros((480, 640, 3), np.uint8), None, Intrinsics(), 5)
    desk.show_watched(frame, None, 5, 0.01, "the picture is black")
    page.wishes = [press(Button.STOP), press(Button.ENGAGE)]
    assert desk.asked() is None and eyes.called == 1, "where nothing flies there is nothing to stop"
    desk.show_watched(frame, eyes.people[0].pose, 10, 0.01, "")
    first, second = page.shown
    assert len(first.figures) == 2 and first.figures[1].joints_m is None and first.flight is None
    assert (first.who, second.who, first.engaging) == ("nobody has engaged", "seen", 0.4)
    assert first.lines[0] == Line(5e-9, "the picture is black", "alarm")
    assert "a hand is up: 40%" in state_html(first)


def test_what_is_shown_is_text_and_no_page_of_its_own() -> None:
    lines = tuple(Line(float(k), f"<script>{k}</script>", "alarm") for k in range(20))
    shown = events_html(lines)
    assert "<script>" not in shown and shown.index("{19}".strip("{}")) < shown.index("11&lt;")
    assert "data:image/jpeg;base64,/9j/" in picture_html(np.zeros((30, 40, 3), np.uint8))


class Teller(Prompter):
    """A prompter that can say why."""

    def __init__(self) -> None:
        super().__init__()
        self.told = 0

    def explain(self) -> Explanation | None:
        self.told += 1
        if self.told == 2:
            raise RuntimeError("it is broken")
        if self.told == 3:
            return None
        views = ("positions",)
        path = np.stack([np.arange(20), np.arange(20)], axis=1)
        example = Example("orbit", "orbit of <ann>", 1.1, np.array([0.4]), np.zeros((20, 13, 3)), path)
        return Explanation(
            Gesture("orbit", 0.97), "orbit", None, 0.97, 0.7, 1.2, None, views, np.array([1.5]), None, 20,
            (example,), np.zeros((20, 13, 3)), 1.4,
        )  # fmt: skip


def test_why_something_was_heard_is_handed_over_once() -> None:
    bench = Bench()
    teller = bench.pilot.spotter = bench.flown.prompter = Teller()  # type: ignore[assignment]
    bench.turns(1.5)
    for _ in range(4):
        bench.turn(gesture=Command.ORBIT)
        bench.turns(0.5)
    assert teller.told == 4
    whys = [why for snapshot in bench.page.shown for why in snapshot.whys]
    assert [why.label for why in whys] == ["orbit", "orbit"], "of four, one failed and one could not be told"
    assert whys[0].title.endswith(" s: orbit") and whys[0].explained.sure == 0.97
    said = [line.text for line in bench.page.shown[-1].lines]
    assert "cannot be explained: it is broken" in said, "and it flies on"
    shown = why_html(whys[0])
    assert "orbit, 0.970 sure" in shown and "data:image/png;base64,iVBOR" in shown
    assert "Refused, were more than 0.970 asked for" in shown


def test_what_was_heard_is_in_the_next_snapshot_if_one_was_missed() -> None:
    def heard(*seconds: float) -> Snapshot:
        return replace(snapshot(), whys=tuple(Why(at_s, "up", b"") for at_s in seconds))

    assert [why.at_s for why in newer(heard(1.0), heard(2.0)).whys] == [1.0, 2.0]
    many = newer(heard(1.0, 2.0, 3.0), heard(4.0, 5.0, 6.0))
    assert [why.at_s for why in many.whys] == [2.0, 3.0, 4.0, 5.0, 6.0]
    assert newer(heard(1.0), heard()).whys[0].at_s == 1.0


def lesson(**changed: Any) -> Lesson:
    stands = Lesson(
        "<i>wave</i>", "3 ...", "feet out of view", 1, 3, True, False, (Line(1.0, "<u>"),), ("a",)
    )
    return replace(stands, **changed)


def test_lessons_are_for_whoever_gives_them_and_what_is_learned_is_shown_at_once() -> None:
    page = Page()
    desk = Desk(page, None, None, clock_ns=lambda: 0)
    page.wishes = [Ask(teach="wave"), press(Button.CANCEL), press(Button.STOP)]
    assert desk.asked() is None
    assert list(desk.lessons) == [Ask(teach="wave"), press(Button.CANCEL)]
    for learning in (False, False, True):
        desk.show_watched(None, None, 7, 0.01, "", lesson=lesson(learning=learning))
    shown = [snapshot.lesson for snapshot in page.shown]
    assert [one.learning for one in shown if one is not None] == [False, True], "out of its turn"


def test_a_flight_that_is_asked_to_teach_flies_on() -> None:
    bench = Bench()
    bench.turns(0.5)
    for _ in range(20):
        bench.turn(Ask(teach="x"))
    assert bench.flown.pilot.supervisor.mode is Mode.DISARMED and len(bench.desk.lessons) <= 8
    assert bench.page.shown[-1].lesson is None


def test_a_lesson_is_shown_as_text() -> None:
    shown = lesson_html(lesson())
    for part in ("&lt;i&gt;wave&lt;/i&gt;: 1 of 3", "3 ...", "feet out of view", "&lt;u&gt;", "knows: a"):
        assert part in shown, part
    assert "<i>" not in shown and "<u>" not in shown
    assert "knows" not in lesson_html(lesson(known=())) and "of 3" not in lesson_html(lesson(gesture=""))
