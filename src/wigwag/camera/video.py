"""A video file, read by PyAV."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np

from wigwag.camera.frame import Frame
from wigwag.camera.lens import Lens, LensConfig
from wigwag.camera.protocol import Source
from wigwag.errors import DataError

_MISSING_S = 0.5
"""A video that ends this much before its end was cut short; less is how containers round."""


class VideoSource(Source):
    """Frames without depth from a video file, stamped with the file's own times.

    A damaged stretch is left out. A file that was cut short gives what is in it; then it fails.

    Args:
        path: Whatever FFmpeg reads.
        lens: What is known of the lens.

    Raises:
        InputError: If the field of view is none.
        DataError: If the intrinsics file cannot be used.
    """

    def __init__(self, path: str | Path, lens: LensConfig | None = None) -> None:
        self.address = f"video:{path}"
        self._path, self._lens = Path(path), Lens(lens)
        self._container: av.container.InputContainer | None = None
        self._frames: Iterator[Frame] = iter(())

    def open(self) -> None:
        """Open the file.

        Raises:
            DataError: If it is not there, no video, or cut short so that nothing can be read.
        """
        self.close()
        if not self._path.is_file():
            raise DataError(f"{self._path}: there is no such file. Name a video, such as video:flight.mp4.")
        try:
            self._container = av.open(str(self._path))
        except (av.FFmpegError, ValueError) as error:
            raise DataError(
                f"{self._path}: is no video that FFmpeg reads, or was cut short ({error}). "
                "Record or fetch it again."
            ) from error
        if not self._container.streams.video:
            self.close()
            raise DataError(f"{self._path}: has no pictures in it, only other streams.")
        self._frames = self._read(self._container)

    def read(self) -> Frame | None:
        """Return the next picture, ``None`` at the end.

        Raises:
            DataError: If the file was cut short, or nothing in it can be decoded.
        """
        return next(self._frames, None)

    def close(self) -> None:
        """Close the file."""
        self._frames = iter(())
        if self._container is not None:
            self._container.close()
            self._container = None

    def _read(self, container: av.container.InputContainer) -> Iterator[Frame]:
        stream = container.streams.video[0]
        rate = float(stream.average_rate or stream.guessed_rate or 30)
        count, last_s, first_s = 0, 0.0, None
        broken: Exception | None = None
        packets = container.demux(stream)
        while True:
            try:
                pictures = next(packets).decode()
            except StopIteration:
                break
            except av.InvalidDataError as error:  # this packet; the next may be whole
                broken = error
                continue
            except av.FFmpegError as error:
                broken = error
                break
            for picture in pictures:
                last_s = count / rate if picture.time is None else float(picture.time)
                first_s = last_s if first_s is None else first_s
                count += 1
                rgb = _upright(picture)
                yield Frame(rgb, None, self._lens.of(rgb.shape), round(last_s * 1e9))
        if first_s is None:
            raise DataError(f"{self._path}: no picture in it can be decoded ({broken or 'it is empty'}).")
        length_s = _length_s(container)
        played_s = last_s - first_s + 1 / rate
        if length_s is not None and played_s < length_s - _MISSING_S:
            raise DataError(
                f"{self._path}: was cut short: it says {length_s:.1f} s but ends after {played_s:.1f} s"
                f"{f' ({broken})' if broken else ''}. All pictures before that were handed on."
            )


def _length_s(container: av.container.InputContainer) -> float | None:
    """Return how long the pictures go on, as far as the file says so."""
    stream = container.streams.video[0]
    if stream.duration is not None and stream.time_base is not None:
        return float(stream.duration * stream.time_base)
    if container.duration is not None and len(container.streams) == 1:
        return float(container.duration / av.time_base)
    return None


def _upright(picture: av.VideoFrame) -> np.ndarray:
    """Return RGB, turned as the phone that took it says."""
    rgb = picture.to_ndarray(format="rgb24")
    quarters = round(getattr(picture, "rotation", 0) / 90) % 4
    return np.ascontiguousarray(np.rot90(rgb, quarters)) if quarters else rgb
