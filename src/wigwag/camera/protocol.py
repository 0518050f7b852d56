"""What a camera is to those who use one, and what a kind of camera must be able to do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import Protocol, Self

from wigwag.camera.frame import Frame


@dataclass(slots=True)
class Counts:
    """What became of the frames of a camera."""

    received: int = 0
    """Frames that the source gave."""
    handed: int = 0
    """Frames that were handed on."""
    skipped: int = 0
    """Frames that a newer one replaced before anybody asked for them."""
    out_of_order: int = 0
    """Frames that were no newer than one before them, and were dropped."""
    reconnects: int = 0
    """How often the source was lost and came back."""


class Camera(Protocol):
    """Anything that yields frames in order of time.

    A live camera keeps one frame, the newest; it never queues. A recording waits for whoever reads it.
    Stamps rise strictly, whatever the source does.

    Example:
        ``with open_camera("webcam:0") as camera: for frame in camera: ...``
    """

    @property
    def address(self) -> str:
        """Where the frames come from, as the user would write it."""
        ...

    @property
    def counts(self) -> Counts:
        """What became of the frames so far."""
        ...

    @property
    def ended(self) -> bool:
        """Whether the last frame has been handed on."""
        ...

    @property
    def now_ns(self) -> int:
        """The time on the clock of the frames' stamps, nanoseconds.

        For a live camera that is the host's monotonic clock. In a recording no time passes but with its
        frames: it is the newest frame's stamp.
        """
        ...

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames until the source ends: all of a recording, the newest ones of a live camera.

        Raises:
            CameraError: If the camera was lost and did not come back.
            DataError: If a recording is damaged.
        """
        ...

    def latest(self, timeout_s: float = 1.0) -> Frame | None:
        """Return the newest frame that was not handed on yet; what came before it is skipped.

        Args:
            timeout_s: How long to wait for one.

        Returns:
            ``None`` if nothing new came in time, or nothing will come any more (see ``ended``).

        Raises:
            CameraError: If the camera was lost and did not come back.
            DataError: If a recording is damaged.
        """
        ...

    def close(self) -> None:
        """Let go of the source. Closing twice does nothing."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


class Source(ABC):
    """One kind of camera or recording: it opens, reads the next frame, closes. All else is done for it.

    ``Playback`` makes a ``Camera`` of a source that waits for its reader, ``LiveCamera`` of one that does
    not.
    """

    address: str
    """As the user would write it; error messages begin with it."""

    @abstractmethod
    def open(self) -> None:
        """Get hold of the source; it may have been open before.

        Raises:
            CameraError: If the camera is not there; it may be later.
            DataError: If the recording is not there or cannot be read.
        """

    @abstractmethod
    def read(self) -> Frame | None:
        """Return the next frame, ``None`` at the end. Its arrays are new and never written to again.

        Raises:
            CameraError: If the camera is lost; it may come back after ``close`` and ``open``.
            DataError: If the recording is damaged here.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of the source; called in the thread that reads, also after an error, also twice."""

    def interrupt(self) -> None:  # noqa: B027  # most reads never wait long
        """Make a ``read`` that waits in another thread return soon."""
