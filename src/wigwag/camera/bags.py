"""ROS 1 and ROS 2 bags, and MCAP, with ``sensor_msgs`` pictures; ROS itself is not needed."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt16

from wigwag.camera.align import DepthAligner
from wigwag.camera.bag_topics import Topics, choose, transform
from wigwag.camera.calibration import check_intrinsics
from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.lens import Lens, LensConfig
from wigwag.camera.protocol import Source
from wigwag.camera.ros_images import depth_of, intrinsics_of, rgb_of
from wigwag.errors import DataError, InputError
from wigwag.extras import load


@dataclass(frozen=True, slots=True)
class BagConfig:
    """Which topics are read. Empty: found by their types and names, if there is one choice only."""

    color: str = ""
    """``Image`` or ``CompressedImage``."""
    depth: str = ""
    """``Image`` or ``CompressedImage``; a bag without is read without depth."""
    info: str = ""
    """``CameraInfo`` of colour; by default ``camera_info`` beside its topic."""
    depth_info: str = ""
    """``CameraInfo`` of depth; by default ``camera_info`` beside its topic."""
    aligned: bool = False
    """Depth is aligned to colour, whatever the frames' names say."""
    tolerance_s: float = 0.02
    """Colour and depth belong together if their stamps differ by no more."""
    lens: LensConfig | None = None
    """Used for a bag without depth and without ``CameraInfo``."""


@dataclass(slots=True)
class _Picture:
    """A message on its way to a frame."""

    stamp_ns: int
    message: Any


class BagSource(Source):
    """Frames from a bag, stamped as their messages' headers are.

    Depth goes with the colour picture that is nearest in time. If it comes from another camera, as the
    headers' ``frame_id`` or the intrinsics say, it is aligned to colour with ``/tf_static``.

    Args:
        path: A ROS 1 ``.bag``, a folder of ROS 2, or an ``.mcap`` or ``.db3`` file.
        config: Which topics.

    Raises:
        MissingExtraError: If ``rosbags`` is not installed.
        InputError: If the tolerance is negative or the field of view is none.
    """

    def __init__(self, path: str | Path, config: BagConfig | None = None) -> None:
        self.address = f"bag:{path}"
        self._anyreader = load("rosbags.highlevel", "bags", f"The camera {self.address}").AnyReader
        self._typesys = load("rosbags.typesys", "bags", f"The camera {self.address}")
        self._path, self._config = Path(path), config or BagConfig()
        if not self._config.tolerance_s >= 0:
            raise InputError(f"{self.address}: tolerance_s must not be negative.")
        self._lens = Lens(self._config.lens)
        self._reader: Any = None
        self._frames: Iterator[Frame] = iter(())

    def open(self) -> None:
        """Open the bag and choose its topics.

        Raises:
            DataError: If it is not there, damaged, or has no such topics.
        """
        self.close()
        if not self._path.exists():
            raise DataError(
                f"{self._path}: there is no such bag. Name a .bag, .mcap or .db3 file or a folder."
            )
        default = self._typesys.get_typestore(self._typesys.Stores.ROS2_HUMBLE)
        try:
            reader = self._anyreader([self._path], default_typestore=default)
            reader.open()
        except Exception as error:  # each format's reader raises what it likes on damaged files
            raise DataError(
                f"{self._path}: is no bag that can be read, or was cut short ({error}). Try to repair it: "
                "rosbag reindex, ros2 bag reindex or mcap recover."
            ) from error
        self._reader = reader
        self._topics = choose(reader, self._path, self._config)
        self._aligner: DepthAligner | None = None
        self._checked = False
        self._intrinsics = self._info(self._topics.info)
        if self._topics.depth and self._intrinsics is None:
            raise DataError(
                f"{self._path}: has no CameraInfo for {self._topics.color}. Name it: ?info=/topic; "
                f"there is {self._topics.infos or 'none'}."
            )
        self._frames = self._read()

    def read(self) -> Frame | None:
        """Return the next frame, ``None`` at the end.

        Raises:
            DataError: If the bag is damaged here or holds something that does not fit.
        """
        try:
            return next(self._frames, None)
        except (DataError, InputError):
            raise
        except Exception as error:  # as above: the storage behind the reader may be damaged
            raise DataError(
                f"{self._path}: is damaged or was cut short ({type(error).__name__}: {error}). All frames "
                "before that were handed on."
            ) from error

    def close(self) -> None:
        """Close the bag."""
        self._frames = iter(())
        reader, self._reader = self._reader, None
        if reader is not None:
            with suppress(Exception):  # a damaged file may not even close
                reader.close()

    def _messages(self, topics: list[str]) -> Iterator[tuple[str, int, Any]]:
        chosen = [c for c in self._reader.connections if c.topic in topics]
        for connection, log_ns, raw in self._reader.messages(connections=chosen) if chosen else ():
            yield connection.topic, log_ns, self._reader.deserialize(raw, connection.msgtype)

    def _info(self, topic: str) -> Intrinsics | None:
        first = next(self._messages([topic]), None) if topic else None
        return None if first is None else intrinsics_of(first[2])

    def _read(self) -> Iterator[Frame]:
        """Join each colour picture to the depth nearest in time."""
        topics, waiting = self._topics, deque[_Picture]()
        depths = deque[_Picture](maxlen=8)
        for topic, log_ns, message in self._messages([t for t in (topics.color, topics.depth) if t]):
            picture = _Picture(_stamp_ns(message, log_ns), message)
            (waiting if topic == topics.color else depths).append(picture)
            while waiting and self._decided(waiting, depths):
                yield self._frame(waiting.popleft(), depths)
        while waiting:
            yield self._frame(waiting.popleft(), depths)

    def _decided(self, waiting: deque[_Picture], depths: deque[_Picture]) -> bool:
        """Say whether no better depth can come for the oldest colour picture."""
        if not self._topics.depth or len(waiting) > 8:
            return True
        newest = max((d.stamp_ns for d in depths), default=None)
        return newest is not None and newest >= waiting[0].stamp_ns

    def _frame(self, color: _Picture, depths: deque[_Picture]) -> Frame:
        rgb = rgb_of(color.message, self._topics.color)
        if self._intrinsics is None:
            return Frame(rgb, None, self._lens.of(rgb.shape), color.stamp_ns)
        intrinsics = check_intrinsics(self._intrinsics, rgb.shape, self._topics.info)
        nearest = min(depths, key=lambda d: abs(d.stamp_ns - color.stamp_ns), default=None)
        depth = None
        if nearest and abs(nearest.stamp_ns - color.stamp_ns) <= self._config.tolerance_s * 1e9:
            depth = self._aligned(nearest.message, color.message, intrinsics)
        return Frame(rgb, depth, intrinsics, color.stamp_ns)

    def _aligned(self, message: Any, color: Any, to: Intrinsics) -> UInt16[np.ndarray, "height width"]:
        topic = self._topics.depth
        depth = depth_of(message, topic)
        if not self._checked:
            self._aligner = self._make_aligner(message, color, depth.shape, to)
            self._checked = True
        if self._aligner is not None:
            try:
                return self._aligner(depth)
            except InputError as error:
                raise DataError(f"{topic}: {error}") from error
        if depth.shape != (to.height, to.width):
            raise DataError(
                f"{topic}: depth is {depth.shape[1]} x {depth.shape[0]}, colour {to.width} x {to.height}, "
                "and the bag has no CameraInfo for depth to align it by. Name it: ?depth_info=/topic"
            )
        return depth

    def _make_aligner(
        self, message: Any, color: Any, shape: tuple[int, ...], to: Intrinsics
    ) -> DepthAligner | None:
        """Return what aligns depth to colour, ``None`` if it is."""
        of = self._info(self._topics.depth_info)
        if self._config.aligned or of is None:
            return None
        of = check_intrinsics(of, shape, self._topics.depth_info)
        names = message.header.frame_id, color.header.frame_id
        if names[0] == names[1] and of == to:
            return None
        static = [m for _, _, m in self._messages(["/tf_static"])]
        between = transform(static, *names)
        if between is None:
            raise DataError(
                f"{self._topics.depth}: depth is seen from {names[0]!r}, colour from {names[1]!r}, and "
                "/tf_static does not join them. Record the aligned depth topic, or say ?aligned=1 if it is."
            )
        return DepthAligner(of, to, between)


def _stamp_ns(message: Any, log_ns: int) -> int:
    """Return when the picture was taken; a header without a stamp leaves when it was written down."""
    stamp = message.header.stamp
    return (int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)) or log_ns


__all__ = ["BagConfig", "BagSource", "Topics"]
