"""A recording as a camera: it waits for its reader, and gives every frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import TracebackType
from typing import Self

from wigwag.camera.frame import Frame
from wigwag.camera.order import Order
from wigwag.camera.protocol import Counts, Source


class Playback:
    """A ``Camera`` over a source in which no time passes but with its frames: a file, or a simulation.

    Nothing comes while the reader is busy, so ``latest`` is the next frame. To play a recording as if it
    happened now, wrap its source in ``Paced`` and hand that to ``LiveCamera``.

    Args:
        source: Opened here, closed by ``close`` or at its end.

    Raises:
        DataError: If the recording is not there or cannot be read.
    """

    def __init__(self, source: Source) -> None:
        self._source, self._order = source, Order()
        self._counts, self._ended, self._now_ns = Counts(), False, 0
        source.open()

    @property
    def address(self) -> str:
        """Where the frames come from."""
        return self._source.address

    @property
    def counts(self) -> Counts:
        """What became of the frames so far."""
        return self._counts

    @property
    def ended(self) -> bool:
        """Whether the last frame has been handed on."""
        return self._ended

    @property
    def now_ns(self) -> int:
        """Stamp of the newest frame handed on; 0 before the first."""
        return self._now_ns

    def __iter__(self) -> Iterator[Frame]:
        while (frame := self.latest()) is not None:
            yield frame

    def latest(self, timeout_s: float = 1.0) -> Frame | None:
        """Return the next frame, ``None`` at the end.

        Args:
            timeout_s: Not needed: a recording does not make its reader wait.

        Raises:
            DataError: If the recording is damaged here. Nothing comes after that.
        """
        while not self._ended:
            try:
                frame = self._source.read()
            except BaseException:
                self.close()
                raise
            if frame is None:
                self.close()
                break
            self._counts.received += 1
            stamp_ns = self._order.admit(frame.stamp_ns)
            if stamp_ns is None:
                self._counts.out_of_order += 1
                continue
            self._counts.handed += 1
            self._now_ns = stamp_ns
            return frame if stamp_ns == frame.stamp_ns else replace(frame, stamp_ns=stamp_ns)
        return None

    def close(self) -> None:
        """Let go of the source; there are no more frames."""
        if not self._ended:
            self._ended = True
            self._source.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
