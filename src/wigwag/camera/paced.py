"""A recording that plays as if it happened now."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace

from wigwag.camera.frame import Frame
from wigwag.camera.live import Wait
from wigwag.camera.protocol import Source
from wigwag.errors import InputError


class Paced(Source):
    """Hands on each frame of a recording when its time has come, stamped with the time of now.

    Args:
        source: A recording.
        speed: Times real time.
        now_ns: Monotonic clock.
        wait: How to wait.

    Raises:
        InputError: If the speed is not positive.
    """

    def __init__(
        self,
        source: Source,
        speed: float = 1.0,
        now_ns: Callable[[], int] = time.monotonic_ns,
        wait: Wait = threading.Event.wait,
    ) -> None:
        if not 0 < speed < float("inf"):
            raise InputError(f"{source.address}: the speed must be above 0, but got {speed}.")
        self.address = source.address
        self._source, self._speed, self._now_ns, self._wait = source, speed, now_ns, wait
        self._stop = threading.Event()
        self._began: tuple[int, int] | None = None

    def open(self) -> None:
        """Open the recording; its time begins with its first frame."""
        self._began = None
        self._source.open()

    def read(self) -> Frame | None:
        """Return the next frame, not before its time; ``None`` at the end or when interrupted."""
        frame = self._source.read()
        if frame is None:
            return None
        if self._began is None:
            self._began = frame.stamp_ns, self._now_ns()
        first_ns, began_ns = self._began
        due_ns = began_ns + round((frame.stamp_ns - first_ns) / self._speed)
        while (left_ns := due_ns - self._now_ns()) > 0:
            if self._wait(self._stop, left_ns * 1e-9):
                return None
        return replace(frame, stamp_ns=due_ns)

    def close(self) -> None:
        """Close the recording."""
        self._source.close()

    def interrupt(self) -> None:
        """Wait no longer."""
        self._stop.set()
        self._source.interrupt()
