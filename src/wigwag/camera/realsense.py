"""Intel RealSense: a device, or what was recorded from one. Depth is aligned to colour by librealsense."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from jaxtyping import UInt8

from wigwag.camera.calibration import check_intrinsics
from wigwag.camera.clock import DeviceClock
from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.pictures import as_rgb, to_millimetres
from wigwag.camera.protocol import Source
from wigwag.errors import CameraError, DataError, InputError
from wigwag.extras import load_realsense


@dataclass(frozen=True, slots=True)
class RealSenseConfig:
    """What is asked of a device; a recording gives what it has.

    Raises:
        InputError: If anything is not positive.
    """

    width: int = 640
    """Pixels, of colour and depth."""
    height: int = 480
    """Pixels, of colour and depth."""
    rate_hz: int = 30
    timeout_s: float = 2.0
    """A device that is silent for so long counts as lost."""

    def __post_init__(self) -> None:
        """Check what librealsense would only say in its own way."""
        if not (min(self.width, self.height, self.rate_hz) > 0 and self.timeout_s > 0):
            raise InputError(
                "realsense: width, height, rate_hz and timeout_s must be above 0, but got "
                f"{self.width}, {self.height}, {self.rate_hz} and {self.timeout_s}."
            )


class Framesets(Protocol):
    """Where sets of frames come from that belong together, as librealsense's ``composite_frame``."""

    def wait(self, timeout_ms: int) -> Any | None:
        """Return the next set, ``None`` at the end of a recording.

        Raises:
            RuntimeError: If none comes in time, or the device is gone.
        """
        ...

    def stop(self) -> None:
        """Let go of the device or file."""
        ...


class RealSenseSource(Source):
    """Frames with depth from a RealSense, with the intrinsics that its colour stream states.

    Args:
        serial: Of the device; empty: the first one found.
        path: A recording (``.bag`` or ``.db3``) instead of a device.
        config: What is asked of the device.
        framesets: Where sets of frames come from; librealsense's pipeline if ``None``.
        now_ns: Monotonic clock, to which a device's stamps are carried over. A recording keeps its own.

    Raises:
        MissingExtraError: If ``pyrealsense2`` is not installed.
    """

    def __init__(
        self,
        serial: str = "",
        path: Path | None = None,
        config: RealSenseConfig | None = None,
        framesets: Callable[[], Framesets] | None = None,
        now_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self.address = f"realsense:{path or serial}"
        self._rs = load_realsense(f"The camera {self.address}")
        self._serial, self._path, self._config = serial, path, config or RealSenseConfig()
        self._make, self._now_ns = framesets or self._pipeline, now_ns
        self._framesets: Framesets | None = None
        self._clock = DeviceClock()

    def open(self) -> None:
        """Start streaming.

        Raises:
            CameraError: If no such device is there, or it cannot do what is asked.
            DataError: If the recording is not there or damaged.
        """
        self.close()
        self._clock = DeviceClock()
        self._align = self._rs.align(self._rs.stream.color)
        if self._path is not None and not self._path.is_file():
            raise DataError(f"{self._path}: there is no such file. Name a recording: realsense:FILE.bag")
        try:
            self._framesets = self._make()
        except RuntimeError as error:
            if self._path is not None:
                raise DataError(
                    f"{self._path}: is no RealSense recording, or was cut short ({error}). Record it again."
                ) from error
            c = self._config
            raise CameraError(
                f"{self.address}: cannot be opened with {c.width} x {c.height} at {c.rate_hz} Hz ({error}). "
                "Check that it is plugged into USB 3, that no other program has it, and that it can do this."
            ) from error

    def read(self) -> Frame | None:
        """Return the next set of frames that has colour, ``None`` at the end of a recording.

        Raises:
            CameraError: If the device is gone or silent.
            DataError: If the recording is damaged.
        """
        while self._framesets is not None:
            try:
                frames = self._framesets.wait(round(1e3 * self._config.timeout_s))
                if frames is None:
                    return None
                arrival_ns = self._now_ns()
                aligned = self._align.process(frames) if frames.get_depth_frame() else frames
                color, depth = aligned.get_color_frame(), aligned.get_depth_frame()
                if color:
                    return self._frame(color, depth, arrival_ns)
            except RuntimeError as error:
                if self._path is not None:
                    raise DataError(f"{self._path}: is damaged ({error}). Record it again.") from error
                raise CameraError(f"{self.address}: no frames came ({error}).") from error
        raise CameraError(f"{self.address}: is not open.")

    def close(self) -> None:
        """Stop streaming."""
        framesets, self._framesets = self._framesets, None
        if framesets is not None:
            try:
                framesets.stop()
            except RuntimeError:
                return  # it stopped by itself, or was unplugged

    def _frame(self, color: Any, depth: Any, arrival_ns: int) -> Frame:
        i = color.profile.as_video_stream_profile().intrinsics
        rgb = self._rgb(color)
        intrinsics = Intrinsics(i.fx, i.fy, i.ppx, i.ppy, i.width, i.height)
        check_intrinsics(intrinsics, rgb.shape, self.address)
        millimetres = None
        if depth:
            # The SDK's memory is used again for frames to come: copy.
            millimetres = to_millimetres(np.array(depth.get_data(), np.uint16), float(depth.get_units()))
        stamp_ns = round(color.timestamp * 1e6)
        if self._path is None:
            stamp_ns = self._clock.to_host(stamp_ns, arrival_ns)
        return Frame(rgb, millimetres, intrinsics, stamp_ns)

    def _rgb(self, color: Any) -> UInt8[np.ndarray, "height width 3"]:
        import cv2

        rs, pixels = self._rs, np.array(color.get_data())
        kind = color.profile.format()
        packed = {rs.format.yuyv: cv2.COLOR_YUV2RGB_YUY2, rs.format.uyvy: cv2.COLOR_YUV2RGB_UYVY}
        if kind in packed:
            pixels = pixels.view(np.uint8).reshape(color.height, color.width, 2)
            return np.asarray(cv2.cvtColor(pixels, packed[kind]))
        try:
            return as_rgb(pixels, "bgr" if kind in (rs.format.bgr8, rs.format.bgra8) else "rgb")
        except InputError as error:
            raise DataError(f"{self.address}: colour of kind {kind} cannot be used. {error}") from error

    def _pipeline(self) -> Framesets:
        rs, c = self._rs, self._config
        asked = rs.config()
        if self._path is not None:
            asked.enable_device_from_file(str(self._path), repeat_playback=False)
        else:
            if self._serial:
                _require(rs, self._serial)
                asked.enable_device(self._serial)
            asked.enable_stream(rs.stream.depth, c.width, c.height, rs.format.z16, c.rate_hz)
            asked.enable_stream(rs.stream.color, c.width, c.height, rs.format.rgb8, c.rate_hz)
        return _Pipeline(rs, asked, recorded=self._path is not None)


def _require(rs: Any, serial: str) -> None:
    """Fail at once if the device is not there; librealsense itself would wait for it for 15 s."""
    there = [d.get_info(rs.camera_info.serial_number) for d in rs.context().query_devices()]
    if serial not in there:
        raise RuntimeError(f"no device has this serial number; there is {', '.join(there) or 'none'}")


class _Pipeline:
    """librealsense's pipeline, over a device or a file."""

    def __init__(self, rs: Any, config: Any, recorded: bool) -> None:
        self._stopped = rs.playback_status.stopped
        self._pipeline, self._playback = rs.pipeline(), None
        if recorded:
            device = config.resolve(rs.pipeline_wrapper(self._pipeline)).get_device()
            self._playback = device.as_playback()
            self._playback.set_real_time(False)  # every frame, however slow the reader is
        self._pipeline.start(config)

    def wait(self, timeout_ms: int) -> Any | None:
        """Return the next set, ``None`` at the end of the file."""
        if self._playback is None:
            return self._pipeline.wait_for_frames(timeout_ms)
        for _ in range(max(1, timeout_ms // 50)):
            over = self._playback.current_status() == self._stopped
            there, frames = self._pipeline.try_wait_for_frames(50)
            if there:
                return frames
            if over:  # it was over before the wait, and still nothing came
                return None
        raise RuntimeError(f"no frame within {timeout_ms} ms")

    def stop(self) -> None:
        """Stop the pipeline."""
        self._pipeline.stop()
