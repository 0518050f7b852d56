"""Sources that do as they are told, and a clock that is moved by hand."""

import threading
import weakref

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.protocol import Source
from wigwag.errors import CameraError

TINY = Intrinsics(fx=8.0, fy=8.0, cx=3.5, cy=2.5, width=8, height=6)


def picture(seed=0, width=8, height=6):
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)


def frame(stamp_ns, seed=None, depth_mm=None):
    return Frame(picture(stamp_ns % 1000 if seed is None else seed), depth_mm, TINY, stamp_ns)


class Told(Source):
    """Gives what is on its list: a frame, an error to raise, or at the end None.

    ``gate`` holds back what comes after an item "wait", until it is set.
    """

    def __init__(self, items, openings=()):
        self.address = "told:"
        self.items, self.openings = list(items), list(openings)
        self.opened = self.closed = 0
        self.gate, self.waiting, self.interrupted = threading.Event(), threading.Event(), False

    def open(self):
        self.opened += 1
        if self.opened > 1 and self.openings:
            error = self.openings.pop(0)
            if error is not None:
                raise error

    def read(self):
        while self.items and self.items[0] == "wait":
            self.waiting.set()
            if not self.gate.wait(10):
                raise AssertionError("the test never opened the gate")
            self.items.pop(0)
        if not self.items:
            return None
        item = self.items.pop(0)
        if isinstance(item, Exception):
            raise item
        return item

    def close(self):
        self.closed += 1

    def interrupt(self):
        self.interrupted = True
        self.gate.set()


class Metronome(Source):
    """A camera of so many Hz, on a clock that is moved by hand, that cannot be made to wait.

    ``go_to`` returns when every frame that is due has been taken from ``read``, and the one that asked is
    waiting for the next: tests need neither sleep nor luck.
    """

    def __init__(self, rate_hz):
        self.address = f"metronome:{rate_hz}"
        self.period_ns = 1_000_000_000 // rate_hz
        self.now_ns = 0
        self._turn = threading.Condition()
        self._next_ns, self._waiting, self._stop = self.period_ns, False, False
        self.alive = self.most_alive = 0
        self._lock = threading.Lock()

    def open(self):
        pass

    def read(self):
        with self._turn:
            self._waiting = self._next_ns > self.now_ns
            self._turn.notify_all()
            if not self._turn.wait_for(lambda: self._next_ns <= self.now_ns or self._stop, 20):
                raise CameraError("nobody moves the clock")
            self._waiting = False
            if self._stop:
                return None
            stamp_ns, self._next_ns = self._next_ns, self._next_ns + self.period_ns
        rgb = np.full((6, 8, 3), stamp_ns // self.period_ns % 256, np.uint8)
        with self._lock:
            self.alive += 1
            self.most_alive = max(self.alive, self.most_alive)
        weakref.finalize(rgb, self._gone)
        return Frame(rgb, None, TINY, stamp_ns)

    def _gone(self):
        with self._lock:
            self.alive -= 1

    def go_to(self, now_ns):
        with self._turn:
            self.now_ns = now_ns
            self._turn.notify_all()
            assert self._turn.wait_for(lambda: self._waiting and self._next_ns > self.now_ns, 20)

    def close(self):
        pass

    def interrupt(self):
        with self._turn:
            self._stop = True
            self._turn.notify_all()
