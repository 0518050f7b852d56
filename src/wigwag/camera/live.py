"""A source that does not wait: its newest frame is kept, and it is opened anew when it is lost."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self

from wigwag.camera.frame import Frame
from wigwag.camera.order import Order
from wigwag.camera.protocol import Counts, Source
from wigwag.errors import CameraError, InputError


@dataclass(frozen=True, slots=True)
class ReconnectConfig:
    """What happens when a camera is lost.

    Raises:
        InputError: If a wait is not positive, or the waits shrink.
    """

    first_s: float = 0.25
    """Wait before the first attempt; each further one waits twice as long."""
    longest_s: float = 4.0
    """No wait is longer."""
    give_up_s: float = 60.0
    """Give up once so much was waited without a frame; 0 never opens a lost camera again."""

    def __post_init__(self) -> None:
        """Check what would otherwise make the reader spin."""
        if not 0 < self.first_s <= self.longest_s or not self.give_up_s >= 0:
            raise InputError(
                "ReconnectConfig needs 0 < first_s <= longest_s and give_up_s >= 0, but got "
                f"{self.first_s}, {self.longest_s} and {self.give_up_s}."
            )


Wait = Callable[[threading.Event, float], bool]
"""Wait so many seconds, or until the event is set; returns whether it is."""


class LiveCamera:
    """A ``Camera`` over a source that goes on by itself.

    A thread reads the source and keeps the newest frame. A frame that nobody asked for before the next one
    came is gone: whoever is slow sees fewer frames, not older ones.

    Args:
        source: Opened here, so that a camera that is not there is known at once; then read in a thread.
        reconnect: What happens when it is lost.
        wait: How the thread waits between attempts.
        clock: The host's monotonic clock, nanoseconds, on which the source stamps its frames.

    Raises:
        CameraError: If the camera cannot be opened.
    """

    def __init__(
        self,
        source: Source,
        reconnect: ReconnectConfig | None = None,
        wait: Wait = threading.Event.wait,
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._source, self._reconnect, self._wait = source, reconnect or ReconnectConfig(), wait
        self._clock = clock
        self._order, self._counts = Order(), Counts()
        self._news = threading.Condition()
        self._newest: Frame | None = None
        self._failure: Exception | None = None
        self._over = False
        self._connected, self._waited_s = True, 0.0
        self._stop = threading.Event()
        source.open()
        self._reader = threading.Thread(target=self._run, name=f"camera {source.address}", daemon=True)
        self._reader.start()

    @property
    def address(self) -> str:
        """Where the frames come from."""
        return self._source.address

    @property
    def counts(self) -> Counts:
        """What became of the frames so far."""
        with self._news:
            return replace(self._counts)

    @property
    def connected(self) -> bool:
        """Whether the source is there; false while it is lost and attempts go on."""
        return self._connected

    @property
    def ended(self) -> bool:
        """Whether the last frame has been handed on."""
        with self._news:
            return self._over and self._newest is None

    @property
    def now_ns(self) -> int:
        """The time on the host's monotonic clock."""
        return self._clock()

    def __iter__(self) -> Iterator[Frame]:
        while True:
            over = self.ended  # asked first, so that a failure in between is raised by the next turn
            if (frame := self.latest()) is not None:
                yield frame
            elif over:
                return

    def latest(self, timeout_s: float = 1.0) -> Frame | None:
        """Return the newest frame that was not handed on yet; what came before it is skipped.

        Args:
            timeout_s: How long to wait for one.

        Returns:
            ``None`` if nothing new came in time, or nothing will come any more (see ``ended``).

        Raises:
            CameraError: If the camera was lost and did not come back.
        """
        with self._news:
            self._news.wait_for(lambda: self._newest is not None or self._over, timeout_s)
            frame, self._newest = self._newest, None
            if frame is not None:
                self._counts.handed += 1
            elif self._failure is not None:
                raise self._failure
            return frame

    def close(self) -> None:
        """Stop the thread and let go of the source. A frame that was not asked for is gone."""
        self._stop.set()
        self._source.interrupt()
        if self._reader is not threading.current_thread():
            self._reader.join(timeout=5.0)  # a driver that hangs must not hang us: the thread is a daemon
        with self._news:
            self._newest, self._failure, self._over = None, None, True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _run(self) -> None:
        """Read until the end: the thread."""
        try:
            while not self._stop.is_set():
                try:
                    frame = self._source.read()
                except CameraError as error:
                    self._reopen(error)
                    continue
                if frame is None:
                    break
                self._waited_s = 0.0
                self._keep(frame)
        except Exception as error:  # whatever it is, it belongs to the thread that asks for frames
            self._failure = error
        finally:
            self._source.close()
            with self._news:
                self._over, self._connected = True, False
                self._news.notify_all()

    def _keep(self, frame: Frame) -> None:
        with self._news:
            if self._stop.is_set():
                return
            self._counts.received += 1
            stamp_ns = self._order.admit(frame.stamp_ns)
            if stamp_ns is None:
                self._counts.out_of_order += 1
                return
            if self._newest is not None:
                self._counts.skipped += 1
            self._newest = frame if stamp_ns == frame.stamp_ns else replace(frame, stamp_ns=stamp_ns)
            self._news.notify_all()

    def _reopen(self, lost: CameraError) -> None:
        """Open the source again and again, until it is there or the time is up.

        Raises:
            CameraError: If the time is up.
        """
        self._connected = False
        config, delay_s, error = self._reconnect, self._reconnect.first_s, lost
        while not self._stop.is_set():
            self._source.close()
            if self._waited_s >= config.give_up_s:
                raise CameraError(
                    f"{self.address}: the camera was lost and did not come back within "
                    f"{self._waited_s:.1f} s. Check its cable and who else uses it. Last word: {error}"
                ) from error
            if self._wait(self._stop, delay_s):
                return
            self._waited_s += delay_s
            delay_s = min(2 * delay_s, config.longest_s)
            try:
                self._source.open()
            except CameraError as again:
                error = again
                continue
            with self._news:
                self._order.restart()
                self._counts.reconnects += 1
            self._connected = True
            return
