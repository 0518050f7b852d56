"""What the page makes of snapshots, without a server: what stands on it, and what its buttons ask for."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any
from unittest.mock import MagicMock

from tests.view.console.test_console import snapshot
from tests.view.console.test_desk import Teller, lesson
from wigwag.view.console.config import ConsoleConfig
from wigwag.view.console.page import Page
from wigwag.view.console.values import KEPT_WHYS, Ask, Button, Why


class Html:
    """A part of the page whose content somebody waits for."""

    def __init__(self) -> None:
        self._said: list[str] = []
        self._news = threading.Condition()

    @property
    def content(self) -> str:
        return self._said[-1] if self._said else ""

    @content.setter
    def content(self, text: str) -> None:
        with self._news:
            self._said.append(text)
            self._news.notify_all()

    def until(self, part: str) -> None:
        with self._news:
            assert self._news.wait_for(lambda: any(part in text for text in self._said), 60), self.content


class Gui(MagicMock):
    """Makes parts of a page and keeps them by what they are called."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.made: dict[str, MagicMock] = {}

    def make(self, label: str, *rest: Any, **options: Any) -> MagicMock:
        part = MagicMock(content="", value=rest[0] if rest else "", disabled=options.get("disabled", False))
        self.made[label or f"html {len(self.made)}"] = part
        return part


def page_of(**config: bool) -> tuple[Page, Gui, list[Ask]]:
    server, gui, asked = MagicMock(), Gui(), list[Ask]()
    server.gui = gui
    for part in ("html", "text", "button", "dropdown", "folder", "slider"):
        setattr(gui, f"add_{part}", gui.make)
    return Page(server, ConsoleConfig(**config), asked.append), gui, asked


def pressed(part: MagicMock) -> None:
    part.on_click.call_args.args[0](None)


def test_a_lesson_is_asked_for_by_name_and_cancelled() -> None:
    page, gui, asked = page_of(flies=False, teaches=True)
    assert "STOP" not in gui.made and "Engage" not in gui.made
    gui.made["Gesture"].value = "wave" * 1000
    pressed(gui.made["Teach"])
    pressed(gui.made["Cancel"])
    assert asked == [Ask(teach=("wave" * 1000)[:200]), Ask(Button.CANCEL)]
    page.show(replace(snapshot(), lesson=lesson()))
    assert gui.made["Teach"].disabled and not gui.made["Cancel"].disabled
    page.show(replace(snapshot(), lesson=lesson(under_way=False)))
    assert not gui.made["Teach"].disabled and gui.made["Cancel"].disabled


def test_a_loop_that_learns_is_not_said_to_be_silent() -> None:
    page, gui, _ = page_of(flies=False, teaches=True)
    page.say_silent(1.0)
    assert all("no news" not in str(part.content) for part in gui.made.values())
    page.show(replace(snapshot(), lesson=lesson(learning=True)))
    page.say_silent(7.0)
    assert "learning &lt;i&gt;wave&lt;/i&gt; for 7 s" in page._state.content
    page.show(replace(snapshot(), lesson=lesson(learning=False)))
    page.say_silent(7.0)
    assert "no news for 7 s" in page._state.content


def test_the_last_gestures_can_be_chosen_from() -> None:
    page, gui, _ = page_of()
    assert "gesture" not in gui.made, "nothing was heard yet"
    explained = Teller().explain()
    assert explained is not None
    whys = [Why.of(float(k), explained) for k in range(KEPT_WHYS + 2)]
    page.show(replace(snapshot(), whys=tuple(whys[:1])))
    choice = gui.made["gesture"]
    assert page._why is not None
    picture = page._why._picture = Html()
    page.show(replace(snapshot(), whys=tuple(whys[1:])))
    assert choice.options == [f"{k:.1f} s: orbit" for k in range(KEPT_WHYS + 1, 1, -1)]
    assert choice.value == "6.0 s: orbit"
    picture.until("6.0 s: orbit, 0.970 sure")
    choice.value = "3.0 s: orbit"
    choice.on_update.call_args.args[0](None)
    picture.until("3.0 s: orbit, 0.970 sure")
