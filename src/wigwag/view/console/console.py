"""The console, seen from the loop: values go out, wishes come in, and nothing here waits for a viewer."""

from __future__ import annotations

import json
import multiprocessing
import threading
from dataclasses import replace

import cv2
import numpy as np

from wigwag.errors import InputError, ViewError
from wigwag.extras import require
from wigwag.view.console.config import ConsoleConfig
from wigwag.view.console.slot import Slot
from wigwag.view.console.values import Ask, Snapshot, newer

PICTURE_PX = 480
"""Width that a picture has at most when it leaves."""
_START_S = 60.0
"""So long the page's process may take to begin on a busy machine."""


class Console:
    """Serves the page from a process of its own.

    Args:
        config: Where.

    Raises:
        MissingExtraError: If viser is not installed.
        ViewError: If the page cannot be served there, for instance because another program is.
    """

    def __init__(self, config: ConsoleConfig | None = None) -> None:
        require("viser", "console", "The console")
        self.config = config or ConsoleConfig()
        from wigwag.view.console.process import serve

        context = multiprocessing.get_context("spawn")
        self._link, theirs = context.Pipe()
        self._process = context.Process(
            target=serve, args=(theirs, self.config), name="wigwag console", daemon=True
        )
        self._process.start()
        theirs.close()
        self.url = self._begun()
        """What to open in a browser; with the token, if there is one."""
        self.trouble = ""
        """Why the page is gone; empty: it is there. The loop goes on without it."""
        self._slot: Slot[Snapshot] = Slot(newer)
        self._asks: dict[tuple[str, str], Ask] = {}
        """What waits, by what it is about, in the order of asking: however fast somebody clicks, a stop is in
        here."""
        self._lock = threading.Lock()
        self._threads = [
            threading.Thread(target=self._send, name="console out", daemon=True),
            threading.Thread(target=self._receive, name="console in", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def show(self, snapshot: Snapshot) -> None:
        """Leave a snapshot for the page. Returns at once, whoever looks and however slowly."""
        self._slot.put(snapshot)

    def asks(self) -> list[Ask]:
        """Return what was asked for on the page since the last call."""
        with self._lock:
            asked, self._asks = list(self._asks.values()), {}
        return asked

    def close(self) -> None:
        """Take the page down."""
        self._slot.close()
        self._link.close()
        self._process.join(2.0)
        if self._process.is_alive():
            self._process.terminate()
            self._process.join(2.0)

    def _begun(self) -> str:
        try:
            if not self._link.poll(_START_S):
                raise EOFError("it does not answer")
            began = json.loads(self._link.recv_bytes(4096))
        except (EOFError, OSError) as error:
            self._process.terminate()
            raise ViewError(f"The console's process did not begin ({error}).") from error
        if "error" in began:
            self._process.join(2.0)
            raise ViewError(f"The console cannot be served on {self.config.address}: {began['error']}")
        query = "" if self.config.token is None else f"?token={self.config.token}"
        return f"{began['url']}/{query}"

    def _send(self) -> None:
        while (snapshot := self._slot.take()) is not None:
            try:
                self._link.send(_small(snapshot))
            except (OSError, ValueError) as error:
                self.trouble = f"the console's page is gone ({error})"
                return

    def _receive(self) -> None:
        while True:
            try:
                ask = Ask.from_json(self._link.recv_bytes(4096))
                with self._lock:
                    self._asks.pop(ask.about, None)
                    self._asks[ask.about] = ask
            except InputError as error:
                self.trouble = str(error)
            except (EOFError, OSError, TypeError) as error:  # closed, here (a TypeError) or there
                self.trouble = self.trouble or f"the console's page is gone ({error})"
                return


def _small(snapshot: Snapshot) -> Snapshot:
    """Make the picture as small as it is shown."""
    picture = snapshot.picture
    if picture is None or picture.rgb.shape[1] <= PICTURE_PX:
        return snapshot
    height, width = picture.rgb.shape[:2]
    part = -(-width // PICTURE_PX)  # a whole number of pixels become one, which is far faster than a share
    size = (max(1, width // part), max(1, height // part))
    rgb = cv2.resize(picture.rgb[: size[1] * part, : size[0] * part], size, interpolation=cv2.INTER_AREA)
    return replace(snapshot, picture=replace(picture, rgb=np.asarray(rgb, np.uint8)))


__all__ = ["PICTURE_PX", "Console"]
