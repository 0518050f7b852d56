"""The part of the page that says why a gesture was what it was: a picture, and what would have changed it."""

from __future__ import annotations

import base64
import threading
from collections import deque
from html import escape
from typing import Any

from wigwag.view.console.slot import Slot
from wigwag.view.console.values import KEPT_WHYS, Why


class WhyPanel:
    """A folder with the last gestures to choose from, and the picture of one of them.

    A picture takes half a second of processor time, and the first one the import of a library for plots: they
    are drawn by a thread of their own, so that the rest of the page goes on.

    Args:
        gui: A viser server's ``gui``.
    """

    def __init__(self, gui: Any) -> None:
        self._gui = gui
        # Below everything else: what is pressed and set stays where it is when a gesture is heard.
        self._folder: Any = gui.add_folder("Why", order=1e9, visible=False)
        self._choice: Any = None
        self._picture: Any = None
        self._whys: deque[Why] = deque(maxlen=KEPT_WHYS)
        self._chosen: Slot[Why] = Slot()

    def show(self, whys: tuple[Why, ...]) -> None:
        """Add what was decided since the last call, and choose the newest."""
        if not whys:
            return
        self._whys.extend(whys)
        titles = [why.title for why in reversed(self._whys)]
        if self._choice is None:
            self._folder.visible = True
            with self._folder:
                self._choice = self._gui.add_dropdown("gesture", titles, hint="One of the last few.")
                self._picture = self._gui.add_html(_framed("drawing ..."))
            self._choice.on_update(lambda _: self._choose())
            threading.Thread(target=self._draw, name="why", daemon=True).start()
        else:
            self._choice.options = titles
            self._choice.value = titles[0]
        self._choose()

    def _choose(self) -> None:
        for why in list(self._whys):
            if why.title == self._choice.value:
                self._chosen.put(why)

    def _draw(self) -> None:
        drawn = ""
        while (why := self._chosen.take()) is not None:
            if why.title == drawn:
                continue
            drawn = why.title
            try:
                self._picture.content = why_html(why)
            except Exception as error:  # of whatever kind: the next one is drawn again
                self._picture.content = _framed(f"cannot be drawn: {escape(str(error))}")


def why_html(why: Why) -> str:
    """Return the picture and what would have made it a different answer."""
    from wigwag.view.explained import headline_of, narrow_png_of

    explained = why.explained
    data = base64.b64encode(narrow_png_of(explained)).decode()
    answers = "".join(f"<li>{escape(answer)}</li>" for answer in explained.answers)
    return _framed(
        f"<b>{escape(headline_of(explained, why.at))}</b>"
        f'<img alt="why" style="width:100%;display:block;margin:.4em 0;border-radius:4px" '
        f'src="data:image/png;base64,{data}">It would have been:'
        f'<ul style="margin:.2em 0;padding-left:1.3em">{answers}</ul>'
    )


def _framed(html: str) -> str:
    return f'<div style="padding:.4em .8em;font-size:.85em">{html}</div>'


__all__ = ["WhyPanel", "why_html"]
