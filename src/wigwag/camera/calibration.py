"""Intrinsics where they come from: a file, a guess from the field of view; and whether they can be right."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.camera.align import Extrinsic
from wigwag.camera.frame import Intrinsics
from wigwag.errors import DataError, InputError

HFOV_DEG = 65.0
"""Horizontal field of view of a common webcam, assumed where nothing is known. The true one lies between
55 and 78 degrees, so distances that rest on it may be off by a fifth."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """What a recording of colour and depth says about its cameras."""

    color: Intrinsics
    depth: Intrinsics | None = None
    """``None``: depth is aligned to colour already."""
    depth_to_color: Extrinsic | None = None
    depth_unit_m: float = 1e-3
    """Metres a count of the depth pictures."""
    rate_hz: float | None = None
    """Pictures a second, if the file says so."""


def assumed_intrinsics(width: int, height: int, hfov_deg: float = HFOV_DEG) -> Intrinsics:
    """Return intrinsics from the field of view: square pixels, the axis through the picture's middle.

    Args:
        width: Pixels.
        height: Pixels.
        hfov_deg: Horizontal field of view.

    Raises:
        InputError: If no lens has such a field of view.

    Example:
        >>> round(assumed_intrinsics(640, 480, 55.0).fx)
        615
    """
    if not 1.0 <= hfov_deg <= 170.0:
        raise InputError(f"hfov_deg must be from 1 to 170 degrees, but got {hfov_deg}.")
    focal = width / 2 / math.tan(math.radians(hfov_deg) / 2)
    return Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)


def check_intrinsics(intrinsics: Intrinsics, shape: tuple[int, ...], name: str) -> Intrinsics:
    """Return intrinsics that can be those of a picture.

    Args:
        intrinsics: What a file or device says.
        shape: Of the picture: (height, width, ...).
        name: The file, topic or device; the error message begins with it.

    Raises:
        DataError: If they belong to a picture of another size, or to no camera at all.
    """
    i = intrinsics
    numbers = (i.fx, i.fy, i.cx, i.cy)
    if (i.height, i.width) != tuple(shape[:2]):
        raise DataError(
            f"{name}: the intrinsics are for pictures of {i.width} x {i.height}, but the pictures are "
            f"{shape[1]} x {shape[0]}. Use those of this size."
        )
    if not all(map(math.isfinite, numbers)) or min(i.fx, i.fy) <= 0:
        raise DataError(f"{name}: fx and fy must be finite and above 0, but the intrinsics are {numbers}.")
    if not (0.1 * i.width < i.fx < 50 * i.width and 0.5 < i.fx / i.fy < 2.0):
        raise DataError(
            f"{name}: focal lengths of {i.fx:g} and {i.fy:g} pixels fit no camera with pictures of "
            f"{i.width} x {i.height}. Are they in pixels, and for this size?"
        )
    if not (-0.5 * i.width < i.cx < 1.5 * i.width and -0.5 * i.height < i.cy < 1.5 * i.height):
        raise DataError(f"{name}: the principal point ({i.cx:g}, {i.cy:g}) lies far outside the picture.")
    return i


def read_calibration(path: Path) -> Calibration:
    """Read ``camera.json`` or the ``intrinsic.json`` that Open3D writes for an Azure Kinect.

    ``{"color": {"width", "height", "fx", "fy", "cx", "cy"}}``, and if depth is not aligned to colour,
    ``"depth": {the same}`` with ``"depth_to_color": {"rotation": [3 rows], "translation_m": [3]}``;
    optional: ``"depth_unit_m"`` (0.001) and ``"rate_hz"``. Open3D's form is ``{"width", "height",
    "intrinsic_matrix"}`` with nine numbers, column after column.

    Raises:
        DataError: If the file is not there, is no such JSON, or its numbers cannot be those of a camera.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
    except ValueError as error:
        raise DataError(f"{path}: is no JSON ({error}).") from error
    try:
        return _calibration(data, str(path))
    except DataError:
        raise
    except InputError as error:
        raise DataError(f"{path}: {error}") from error
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise DataError(
            f"{path}: lacks something or has something else in its place ({type(error).__name__}: {error}). "
            'Expected {"color": {"width", "height", "fx", "fy", "cx", "cy"}, ...}, see docs/cameras.md.'
        ) from error


def _calibration(data: dict[str, Any], name: str) -> Calibration:
    if "intrinsic_matrix" in data:
        m = np.asarray(data["intrinsic_matrix"], np.float64).reshape(3, 3).T
        color = Intrinsics(m[0, 0], m[1, 1], m[0, 2], m[1, 2], int(data["width"]), int(data["height"]))
    else:
        color = _intrinsics(data["color"])
    color = check_intrinsics(color, (color.height, color.width), f"{name}: color")
    depth, to_color = None, None
    if data.get("depth") is not None:
        depth = _intrinsics(data["depth"])
        depth = check_intrinsics(depth, (depth.height, depth.width), f"{name}: depth")
        pose = data["depth_to_color"]
        to_color = Extrinsic(
            np.asarray(pose["rotation"], np.float64), np.asarray(pose["translation_m"], np.float64)
        )
    unit_m = float(data.get("depth_unit_m", 1e-3))
    rate = data.get("rate_hz")
    if not 0 < unit_m < 1 or (rate is not None and not 0 < float(rate) < 10_000):
        raise DataError(f"{name}: depth_unit_m must be metres a count and rate_hz above 0.")
    return Calibration(color, depth, to_color, unit_m, None if rate is None else float(rate))


def _intrinsics(data: dict[str, Any]) -> Intrinsics:
    fx, fy, cx, cy = (float(data[key]) for key in ("fx", "fy", "cx", "cy"))
    return Intrinsics(fx, fy, cx, cy, int(data["width"]), int(data["height"]))
