"""Picture files and raw pictures of any common kind, as 8-bit RGB or depth in millimetres."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from jaxtyping import UInt8, UInt16

from wigwag.errors import DataError, InputError

PICTURES = (".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm")
"""Suffixes of what is taken for a picture in a folder."""


def as_rgb(picture: np.ndarray, order: str = "rgb") -> UInt8[np.ndarray, "height width 3"]:
    """Return a grey, colour or transparent picture of 8 or 16 bits as 8-bit RGB.

    16 bits are taken to be used up to the top: each value's upper byte is kept.

    Args:
        picture: Shape (height, width) or (height, width, 1 | 3 | 4), uint8 or uint16.
        order: ``"rgb"`` or ``"bgr"``: how three or four channels lie.

    Returns:
        A new array, or ``picture`` itself if it is RGB already.

    Raises:
        InputError: If it has another type or shape.
    """
    if picture.dtype == np.uint16:
        picture = (picture >> 8).astype(np.uint8)
    channels = 1 if picture.ndim == 2 else picture.shape[2] if picture.ndim == 3 else 0
    if picture.dtype != np.uint8 or channels not in (1, 3, 4) or not picture.size:
        raise InputError(
            "A picture must be uint8 or uint16 with shape (height, width) or (height, width, 1, 3 or 4), "
            f"but got {picture.dtype} {picture.shape}."
        )
    if channels == 1:
        return np.repeat(picture.reshape(*picture.shape[:2], 1), 3, axis=2)
    return np.ascontiguousarray(picture[:, :, :3] if order == "rgb" else picture[:, :, 2::-1])


def decode(data: bytes, name: str) -> np.ndarray:
    """Return a picture file's pixels as they are, three channels in BGR order.

    Args:
        data: The file.
        name: For the error message.

    Raises:
        DataError: If it is no picture, or a damaged one.
    """
    import cv2

    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    except cv2.error:
        pixels = None
    if pixels is None:
        raise DataError(
            f"{name}: is no picture that can be read ({len(data)} bytes). Expected a whole JPEG, PNG or the "
            "like; fetch or record it again, or take it out."
        )
    return np.asarray(pixels)


def read_rgb(path: Path) -> UInt8[np.ndarray, "height width 3"]:
    """Read a picture file as 8-bit RGB.

    Raises:
        DataError: If there is no such file or it is no picture.
    """
    pixels = decode(_bytes(path), str(path))
    try:
        return as_rgb(pixels, "bgr")
    except InputError as error:
        raise DataError(f"{path}: {error}") from error


def read_depth(path: Path, unit_m: float = 1e-3) -> UInt16[np.ndarray, "height width"]:
    """Read a 16-bit picture file as depth in millimetres.

    Args:
        path: PNG or TIFF with one channel.
        unit_m: Metres a count.

    Raises:
        DataError: If there is no such file, or it is no 16-bit picture with one channel.
    """
    pixels = decode(_bytes(path), str(path))
    if pixels.dtype != np.uint16 or pixels.ndim != 2:
        raise DataError(
            f"{path}: depth must be a 16-bit picture with one channel, but it is {pixels.dtype} "
            f"{pixels.shape}. Write depth as 16-bit PNG; a coloured view of depth has none in it."
        )
    return to_millimetres(pixels, unit_m)


def to_millimetres(depth: np.ndarray, unit_m: float) -> UInt16[np.ndarray, "height width"]:
    """Return depth counts as millimetres; what cannot be said in 16 bits, or is no number, is a hole."""
    if depth.dtype == np.uint16 and abs(unit_m - 1e-3) < 1e-9:
        return depth
    millimetres = np.nan_to_num(depth.astype(np.float32) * np.float32(unit_m * 1e3), posinf=0.0, neginf=0.0)
    millimetres[(millimetres < 0) | (millimetres > 65535)] = 0
    return np.asarray(np.rint(millimetres), np.uint16)


def picture_files(folder: Path) -> list[Path]:
    """List a folder's pictures in the order of the numbers in their names: frame2 comes before frame10.

    Raises:
        DataError: If there is no such folder or no picture in it.
    """
    if not folder.is_dir():
        raise DataError(f"{folder}: there is no such folder. Name one with pictures in it.")
    files = [f for f in folder.iterdir() if f.suffix.lower() in PICTURES and not f.name.startswith(".")]
    if not files:
        raise DataError(f"{folder}: has no pictures in it. Expected files ending in {', '.join(PICTURES)}.")
    return sorted(files, key=lambda f: _natural(f.name))


def _natural(name: str) -> tuple[tuple[int, int, str], ...]:
    parts = re.split(r"(\d+)", name)
    return tuple((0, int(p), "") if p.isdigit() else (1, 0, p) for p in parts)


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
