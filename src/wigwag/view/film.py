"""A flight as a film: H.264 in MP4, which every browser plays."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path
from types import TracebackType

import av
import cv2
import numpy as np
from jaxtyping import UInt8


class Film:
    """Writes pictures to an MP4 file as they come; what was written before a crash can be played.

    Args:
        path: The file.
        rate_hz: Pictures a second.
        crf: x264's constant rate factor: larger is smaller and coarser.

    Example:
        ``with Film(Path("flight.mp4")) as film: film.add(picture)``
    """

    def __init__(self, path: Path, rate_hz: int = 15, crf: int = 31) -> None:
        self.path, self.rate_hz, self.crf = path, rate_hz, crf
        self._container = av.open(str(path), "w", options={"movflags": "frag_keyframe+empty_moov"})
        self._stream: av.VideoStream | None = None
        self._encoding = ThreadPoolExecutor(1, "film")
        self._waiting: deque[Future[None]] = deque()

    def add(self, rgb: UInt8[np.ndarray, "height width 3"]) -> None:
        """Append a picture; all must have the size of the first, which must be even.

        It is encoded on a thread of its own; a picture that comes while two wait makes the caller wait.
        """
        while len(self._waiting) > 2:
            self._waiting.popleft().result()
        self._waiting.append(self._encoding.submit(self._encode, rgb))

    def _encode(self, rgb: UInt8[np.ndarray, "height width 3"]) -> None:
        if self._stream is None:
            self._stream = self._container.add_stream("libx264", rate=self.rate_hz)
            self._stream.height, self._stream.width = rgb.shape[:2]
            self._stream.pix_fmt = "yuv420p"
            self._stream.time_base = Fraction(1, self.rate_hz)
            self._stream.options = {
                "crf": str(self.crf),
                "preset": "veryfast",
                "threads": "1",
                # No picture is held back: half the memory, and a film cut short by a crash lacks nothing.
                "tune": "zerolatency",
                "bf": "0",
                "refs": "1",
            }
        # OpenCV's conversion needs neither FFmpeg's scaler nor its buffers.
        planes = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2YUV_I420)
        picture = av.VideoFrame.from_ndarray(planes, format="yuv420p")
        for packet in self._stream.encode(picture):
            self._container.mux(packet)

    def close(self) -> None:
        """Write what is left and close the file."""
        while self._waiting:
            self._waiting.popleft().result()
        self._encoding.shutdown()
        if self._stream is not None:
            for packet in self._stream.encode():
                self._container.mux(packet)
        self._container.close()

    def __enter__(self) -> Film:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
