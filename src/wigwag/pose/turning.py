"""The camera turns: how far the whole picture has moved since the frame before."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.camera.frame import Intrinsics

_Grey = UInt8[np.ndarray, "rows columns"]

_WIDTH = 160
"""Pixels to which the picture is shrunk: small enough to take a millisecond and to be free of noise."""
_POINTS, _LEAST = 60, 8
"""How many corners are followed, and with how few nothing is known (a cut, a black frame, a blank wall)."""
_DISAGREE = 1.5
"""Small pixels: if half of the corners are off the median by more, the pictures show different things."""
_ALIKE = 0.5
"""How sharp the peak of two pictures' phases has to be: it was 0.67 and more in a jerk of 86 pixels, and
is 0.14 in the middle for photos of different people."""
_TILE, _GREYS, _WHOLE = 20, 4.0, 0.5
"""A tile of so many small pixels a side has something to see if its greys vary by more; it takes half of
the tiles, more than people fill, to speak of the whole picture."""
_STOP = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 12, 0.02)


class PictureShift:
    """Follows corners from frame to frame (Lucas, Kanade 1981; Shi, Tomasi 1994), most of which move alike.

    A drone pitches and yaws, and who stands a few metres away moves by a metre in its camera's frame, though
    they stand still. Most corners are of the background; the median takes no notice of people who walk.
    Corners are not found again after a jerk of 80 pixels a frame; then the phases of the whole pictures are
    compared (Kuglin, Hines 1975), which is coarser.

    Example:
        >>> picture = np.random.default_rng(0).integers(0, 255, (480, 640, 3), dtype=np.uint8)
        >>> picture = cv2.GaussianBlur(picture, (0, 0), 6.0)
        >>> shift = PictureShift()
        >>> shift(picture), np.round(shift(np.roll(picture, (8, -12), axis=(0, 1)))).tolist()
        ((0.0, 0.0), [-12.0, 8.0])
    """

    def __init__(self) -> None:
        self._last: UInt8[np.ndarray, "rows columns"] | None = None

    def reset(self) -> None:
        """Forget the last picture."""
        self._last = None

    def __call__(self, rgb: UInt8[np.ndarray, "height width 3"]) -> tuple[float, float]:
        """Return how far the picture has moved to the right and down since the last one, pixels."""
        height, width = rgb.shape[:2]
        size = (_WIDTH, max(round(_WIDTH * height / width), 8))
        now = cv2.cvtColor(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), cv2.COLOR_RGB2GRAY)
        last, self._last = self._last, now
        if last is None or last.shape != now.shape:
            return 0.0, 0.0
        moved = _by_corners(last, now) or _by_phase(last, now) or (0.0, 0.0)
        return moved[0] * width / size[0], moved[1] * height / size[1]


def _by_corners(last: _Grey, now: _Grey) -> tuple[float, float] | None:
    """Return the movement that most corners share, small pixels; ``None``: they are too few, or disagree."""
    corners = cv2.goodFeaturesToTrack(last, _POINTS, 0.003, _WIDTH / 28, blockSize=5)
    if corners is None or len(corners) < _LEAST:
        return None
    moved, found, _ = cv2.calcOpticalFlowPyrLK(
        last, now, corners, None, winSize=(11, 11), maxLevel=2, criteria=_STOP
    )
    flow = (moved - corners)[found.ravel() == 1].reshape(-1, 2)
    if len(flow) < _LEAST:
        return None
    middle = np.median(flow, axis=0)
    away = np.linalg.norm(flow - middle, axis=1)
    if float(np.median(away)) > _DISAGREE:
        return None
    u, v = flow[away <= max(1.0, 1.5 * float(np.median(away)))].mean(axis=0)
    return float(u), float(v)


def _by_phase(last: _Grey, now: _Grey) -> tuple[float, float] | None:
    """Return the movement of the whole picture, small pixels; ``None``: they are not of the same things.

    Before a blank wall the phases are of the people who walk there, and nothing is known of the camera.
    """
    if _structured(last) < _WHOLE:
        return None
    window = cv2.createHanningWindow((now.shape[1], now.shape[0]), cv2.CV_32F)
    (u, v), alike = cv2.phaseCorrelate(last.astype(np.float32), now.astype(np.float32), window)
    return (float(u), float(v)) if alike >= _ALIKE else None


def _structured(grey: _Grey) -> float:
    """Return the share of a picture's tiles in which there is something to see."""
    rows, columns = grey.shape[0] // _TILE, grey.shape[1] // _TILE
    tiles = grey[: rows * _TILE, : columns * _TILE].reshape(rows, _TILE, columns, _TILE)
    return float((tiles.std(axis=(1, 3)) > _GREYS).mean()) if tiles.size else 0.0


def turned(
    points_m: Float[np.ndarray, "*batch 3"], shift_px: tuple[float, float], k: Intrinsics
) -> Float[np.ndarray, "*batch 3"]:
    """Return where points are in the camera's frame after the camera has turned.

    Args:
        points_m: Metres, camera optical frame before.
        shift_px: How far the middle of the picture has moved to the right and down.
        k: The camera's intrinsics.

    Example:
        >>> k = Intrinsics()
        >>> k.project(turned(np.array([0.0, 0.0, 5.0]), (30.0, 0.0), k)).round(6).tolist()
        [350.0, 240.0]
    """
    a, b = np.arctan(shift_px[0] / k.fx), np.arctan(shift_px[1] / k.fy)
    yaw = np.array([[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]])
    pitch = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(b), np.sin(b)], [0.0, -np.sin(b), np.cos(b)]])
    return np.asarray(np.asarray(points_m) @ (pitch @ yaw).T)


__all__ = ["PictureShift", "turned"]
