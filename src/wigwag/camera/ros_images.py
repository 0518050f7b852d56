"""What ``sensor_msgs`` say about pictures, as arrays."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from jaxtyping import UInt8, UInt16

from wigwag.camera.align import Extrinsic
from wigwag.camera.frame import Intrinsics
from wigwag.camera.pictures import as_rgb, decode, to_millimetres
from wigwag.errors import DataError, InputError

_PLAIN = {
    "rgb8": (np.uint8, 3, "rgb"),
    "rgba8": (np.uint8, 4, "rgb"),
    "rgb16": (np.uint16, 3, "rgb"),
    "bgr8": (np.uint8, 3, "bgr"),
    "bgra8": (np.uint8, 4, "bgr"),
    "bgr16": (np.uint16, 3, "bgr"),
    "8UC3": (np.uint8, 3, "bgr"),
    "8UC4": (np.uint8, 4, "bgr"),
    "mono8": (np.uint8, 1, "rgb"),
    "8UC1": (np.uint8, 1, "rgb"),
    "mono16": (np.uint16, 1, "rgb"),
    "16UC1": (np.uint16, 1, "rgb"),
    "32FC1": (np.float32, 1, "rgb"),
}
"""Encoding to type, channels, order."""
# OpenCV names the second row's second and third pixel, ROS the first row's first and second.
_MOSAIC = {"bayer_rggb8": "BG", "bayer_bggr8": "RG", "bayer_gbrg8": "GR", "bayer_grbg8": "GB"}
_PACKED = {"yuv422": "UYVY", "uyvy": "UYVY", "yuv422_yuy2": "YUY2", "yuyv": "YUY2"}
_DEPTH_HEADER = struct.Struct("<iff")
"""compressedDepth: a kind, and two numbers that undo the quantisation of 32FC1."""


def rgb_of(message: Any, topic: str) -> UInt8[np.ndarray, "height width 3"]:
    """Return the picture of an ``Image`` or ``CompressedImage``.

    Raises:
        DataError: If the encoding is unknown or the data do not fit it; the message names the topic.
    """
    import cv2

    if hasattr(message, "format"):
        return _picture(decode(bytes(message.data), topic), "bgr", topic)
    encoding = message.encoding
    if encoding in _MOSAIC or encoding in _PACKED:
        code = (
            f"COLOR_Bayer{_MOSAIC[encoding]}2RGB"
            if encoding in _MOSAIC
            else f"COLOR_YUV2RGB_{_PACKED[encoding]}"
        )
        pixels = _pixels(message, np.dtype(np.uint8), 1 if encoding in _MOSAIC else 2, topic)
        return np.asarray(cv2.cvtColor(pixels, getattr(cv2, code)))
    kind, channels, order = _kind(encoding, topic)
    return _picture(_pixels(message, kind, channels, topic), order, topic)


def depth_of(message: Any, topic: str) -> UInt16[np.ndarray, "height width"]:
    """Return the depth in millimetres of an ``Image`` (16UC1, mono16, 32FC1) or a compressed one (PNG).

    Raises:
        DataError: If it is no depth, or the data are damaged; the message names the topic.
    """
    if hasattr(message, "format"):
        return _compressed_depth(message, topic)
    kind, channels, _ = _kind(message.encoding, topic)
    if channels != 1 or kind == np.uint8:
        raise DataError(f"{topic}: depth must be 16UC1 or 32FC1, but its encoding is {message.encoding!r}.")
    unit_m = 1.0 if kind == np.float32 else 1e-3  # REP 118
    return to_millimetres(_pixels(message, kind, 1, topic), unit_m)


def intrinsics_of(message: Any) -> Intrinsics:
    """Return the intrinsics of a ``CameraInfo``; its distortion is left aside."""
    k = np.asarray(message.K if hasattr(message, "K") else message.k, np.float64).reshape(3, 3)
    return Intrinsics(k[0, 0], k[1, 1], k[0, 2], k[1, 2], int(message.width), int(message.height))


def extrinsic_of(transform: Any) -> Extrinsic:
    """Return a ``geometry_msgs/Transform``, which carries points of the child frame into the parent's."""
    q, t = transform.rotation, transform.translation
    x, y, z, w = np.array([q.x, q.y, q.z, q.w]) / np.linalg.norm([q.x, q.y, q.z, q.w])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return Extrinsic(rotation, np.array([t.x, t.y, t.z]))


def _kind(encoding: str, topic: str) -> tuple[np.dtype[Any], int, str]:
    if encoding not in _PLAIN:
        known = ", ".join([*_PLAIN, *_MOSAIC, *_PACKED])
        raise DataError(f"{topic}: its encoding {encoding!r} is not known. Known are {known}.")
    kind, channels, order = _PLAIN[encoding]
    return np.dtype(kind), channels, order


def _pixels(message: Any, kind: np.dtype[Any], channels: int, topic: str) -> np.ndarray:
    """Return the rows without their padding, in the machine's byte order."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    row = width * channels * kind.itemsize
    data = np.frombuffer(bytes(message.data), np.uint8)
    if not height or step < row or len(data) < step * height:
        raise DataError(
            f"{topic}: an image of {width} x {height} {message.encoding} needs rows of {row} bytes, but has "
            f"{len(data)} bytes in rows of {step}. The recording is damaged."
        )
    rows = np.ascontiguousarray(data[: step * height].reshape(height, step)[:, :row])
    stored = rows.view(kind.newbyteorder(">" if message.is_bigendian else "<"))
    pixels = stored.astype(kind, copy=False)
    return pixels.reshape(height, width, channels) if channels > 1 else pixels.reshape(height, width)


def _picture(pixels: np.ndarray, order: str, topic: str) -> UInt8[np.ndarray, "height width 3"]:
    try:
        return as_rgb(pixels, order)
    except InputError as error:
        raise DataError(f"{topic}: {error}") from error


def _compressed_depth(message: Any, topic: str) -> UInt16[np.ndarray, "height width"]:
    data = bytes(message.data)
    if "compressedDepth" not in message.format:
        return _counts(decode(data, topic), topic)
    if len(data) <= _DEPTH_HEADER.size:
        raise DataError(f"{topic}: a compressed depth image of {len(data)} bytes is damaged.")
    _, a, b = _DEPTH_HEADER.unpack_from(data)
    counts = _counts(decode(data[_DEPTH_HEADER.size :], topic), topic)
    if not message.format.startswith("32FC1"):
        return counts
    # depth_image_transport stores what is near more finely: count = a / z + b, 0 is a hole
    with np.errstate(divide="ignore"):
        metres = np.where(counts > 0, a / (counts.astype(np.float64) - b), 0.0)
    return to_millimetres(metres, 1.0)


def _counts(pixels: np.ndarray, topic: str) -> UInt16[np.ndarray, "height width"]:
    if pixels.dtype != np.uint16 or pixels.ndim != 2:
        raise DataError(
            f"{topic}: compressed depth must be a 16-bit PNG, but it is {pixels.dtype} {pixels.shape}."
        )
    return pixels
