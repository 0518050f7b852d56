"""Anything that OpenCV opens: a webcam, a network camera, a GStreamer pipeline."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from wigwag.camera.address import hide_password
from wigwag.camera.frame import Frame
from wigwag.camera.lens import Lens, LensConfig
from wigwag.camera.pictures import as_rgb
from wigwag.camera.protocol import Source
from wigwag.errors import CameraError, DataError, InputError


class Capture(Protocol):
    """The part of ``cv2.VideoCapture`` that is used."""

    def isOpened(self) -> bool: ...  # noqa: D102  # OpenCV's names
    def grab(self) -> bool: ...  # noqa: D102
    def retrieve(self) -> tuple[bool, Any]: ...  # noqa: D102
    def release(self) -> None: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class WebcamConfig:
    """What is asked of the camera, and what is known of its lens.

    Raises:
        InputError: If a size, the rate or the timeout is not positive.
    """

    width: int | None = None
    """Pixels; ``None``: whatever the camera gives."""
    height: int | None = None
    """Pixels."""
    rate_hz: float | None = None
    lens: LensConfig = field(default_factory=LensConfig)
    """What is known of its lens."""
    timeout_s: float = 5.0
    """How long a network camera may be silent before it counts as lost."""

    def __post_init__(self) -> None:
        """Check what OpenCV would silently leave aside."""
        asked = (self.width, self.height, self.rate_hz, self.timeout_s)
        if any(value is not None and not value > 0 for value in asked):
            raise InputError(
                f"webcam: width, height, rate_hz and timeout_s must be above 0, but got {list(asked)}."
            )


class WebcamSource(Source):
    """Frames without depth from a device, a URL or a pipeline, stamped when they arrive.

    Args:
        target: A device's number (``"0"``) or path, a URL, or a GStreamer pipeline that ends in
            ``appsink``. OpenCV's wheels from PyPI read devices and URLs; for pipelines it must be built
            with GStreamer.
        config: What is asked of it.
        capture: Opens the device; ``cv2.VideoCapture`` with the configuration applied if ``None``.
        now_ns: Monotonic clock.

    Raises:
        InputError: If the target is empty or the field of view is none.
        DataError: If the intrinsics file cannot be used.
    """

    def __init__(
        self,
        target: str,
        config: WebcamConfig | None = None,
        capture: Callable[[str], Capture] | None = None,
        now_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        if not target:
            raise InputError("webcam: needs a device, such as webcam:0, a URL or a pipeline.")
        self.address = f"webcam:{hide_password(target)}"
        self._target, self._config = target, config or WebcamConfig()
        self._make, self._now_ns = capture or self._capture, now_ns
        self._open: Capture | None = None
        self._lens = Lens(self._config.lens)

    def open(self) -> None:
        """Open the device.

        Raises:
            CameraError: If OpenCV cannot.
        """
        self.close()
        capture = self._make(self._target)
        if not capture.isOpened():
            capture.release()
            raise CameraError(
                f"{self.address}: OpenCV cannot open it. Check that the camera is plugged in or reachable, "
                "that no other program has it, and that you may read it (Linux: group video)."
                + (" A pipeline needs an OpenCV built with GStreamer." if "!" in self._target else "")
            )
        self._open = capture

    def read(self) -> Frame:
        """Return the next picture.

        Raises:
            CameraError: If none comes.
            DataError: If the intrinsics are for pictures of another size.
        """
        if self._open is None or not self._open.grab():
            raise CameraError(
                f"{self.address}: no picture came; the camera was unplugged or its stream ended."
            )
        stamp_ns = self._now_ns()
        whole, pixels = self._open.retrieve()
        if not whole or pixels is None:
            raise CameraError(f"{self.address}: a picture came but could not be decoded.")
        try:
            rgb = as_rgb(np.asarray(pixels), "bgr")
        except InputError as error:
            raise DataError(f"{self.address}: {error}") from error
        return Frame(rgb, None, self._lens.of(rgb.shape), stamp_ns)

    def close(self) -> None:
        """Release the device."""
        if self._open is not None:
            self._open.release()
            self._open = None

    def _capture(self, target: str) -> Capture:
        import cv2

        c = self._config
        device = int(target) if target.isdigit() else target
        backend = cv2.CAP_GSTREAMER if "!" in target else cv2.CAP_ANY
        # A backend that does not know a parameter refuses to open: only streams over FFmpeg know these.
        asked = []
        if "://" in target:
            ms = round(1e3 * c.timeout_s)
            asked = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, ms, cv2.CAP_PROP_READ_TIMEOUT_MSEC, ms]
        capture: Capture = (
            cv2.VideoCapture(device, backend, asked) if asked else cv2.VideoCapture(device, backend)
        )
        for key, value in (
            (cv2.CAP_PROP_FRAME_WIDTH, c.width),
            (cv2.CAP_PROP_FRAME_HEIGHT, c.height),
            (cv2.CAP_PROP_FPS, c.rate_hz),
            (cv2.CAP_PROP_BUFFERSIZE, 1),  # what waits in the driver is old
        ):
            if value is not None and capture.isOpened():
                capture.set(key, value)  # type: ignore[attr-defined]  # not part of what is needed
        return capture
