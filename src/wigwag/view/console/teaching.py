"""The part of the page by which gestures are taught: a name, what to do now, what was said."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

from wigwag.view.console.text import line_html
from wigwag.view.console.values import NAME_MOST, Ask, Button, Lesson

_SHOWN_LINES = 5
_MOST_DOTS = 12


class TeachingPanel:
    """What to do now, a field for a name, and two buttons.

    Args:
        gui: A viser server's ``gui``.
        ask: Is called with what somebody asks for, from threads of the server.
    """

    def __init__(self, gui: Any, ask: Callable[[Ask], None]) -> None:
        self._ask = ask
        self._lesson: Lesson | None = None
        self._now = gui.add_html("")
        self._name = gui.add_text("Gesture", "", hint="A name for what you are going to show.")
        self._teach = gui.add_button("Teach", color="green", hint="Show it a few times; the model learns it.")
        self._cancel = gui.add_button(
            "Cancel", color="gray", disabled=True, hint="End this lesson; nothing is learned of it."
        )
        self._teach.on_click(lambda _: self._ask(Ask(teach=str(self._name.value)[:NAME_MOST])))
        self._cancel.on_click(lambda _: self._ask(Ask(Button.CANCEL)))

    def show(self, lesson: Lesson) -> None:
        """Show how a lesson stands."""
        if lesson == self._lesson:
            return
        self._lesson = lesson
        self._now.content = lesson_html(lesson)
        for button, off in ((self._teach, lesson.under_way), (self._cancel, not lesson.under_way)):
            if button.disabled != off:
                button.disabled = off

    @property
    def learning(self) -> str:
        """What the model is learning, while the loop is not heard of for it; empty: nothing."""
        return self._lesson.gesture if self._lesson is not None and self._lesson.learning else ""


def lesson_html(lesson: Lesson) -> str:
    """Return how a lesson stands: what to do now in large letters, the repetitions, and what was said.

    Example:
        >>> html = lesson_html(Lesson("wave", "now!", "", 1, 3, True, False, (), ()))
        >>> "now!" in html, "wave: 1 of 3" in html
        (True, True)
    """
    color = "#5fd39a" if lesson.headline == "now!" else "#e6edf3"
    count = ""
    if lesson.gesture:
        dots = "&#9679;" * lesson.taken + "&#9675;" * max(lesson.wanted - lesson.taken, 0)
        dots = dots if lesson.wanted <= _MOST_DOTS else ""
        count = (
            f"<div><b>{escape(lesson.gesture)}: {lesson.taken} of {lesson.wanted}</b> "
            f'<span style="color:#5fd39a;letter-spacing:.2em">{dots}</span></div>'
        )
    advice = f'<div style="color:#f2c94c">{escape(lesson.advice)}</div>' if lesson.advice else ""
    said = "".join(line_html(line) for line in reversed(lesson.said[-_SHOWN_LINES:]))
    known = f'<div style="opacity:.6">knows: {escape(", ".join(lesson.known))}</div>' if lesson.known else ""
    return (
        f'<div style="padding:.4em .8em;font-size:.85em">{count}'
        f'<div style="font-size:1.9em;font-weight:700;line-height:1.3;color:{color}">'
        f'{escape(lesson.headline)}</div><div style="min-height:2.6em">{advice}</div>'
        f'<div style="height:9.5em;overflow-y:auto">{said}</div>{known}</div>'
    )


__all__ = ["TeachingPanel", "lesson_html"]
