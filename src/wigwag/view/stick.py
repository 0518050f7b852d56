"""A stick figure out of braille dots, for a terminal."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from wigwag.skeleton import BONES, Landmark, Pose

_DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bit of each dot of a braille character, four rows of two."""
_HEIGHT_M = 2.6
"""What the figure's height holds: a tall person with raised arms."""


def stick_figure(pose: Pose | None, rows: int = 14, columns: int = 28) -> str:
    """Draw a pose as the camera sees it, hips in the middle of the width.

    Args:
        pose: Camera optical frame; ``None`` gives an empty picture.
        rows: Lines of text.
        columns: Characters a line.

    Example:
        >>> stick_figure(None, 1, 3) == chr(0x2800) * 3
        True
    """
    dots = np.zeros((rows * 4, columns * 2), dtype=bool)
    if pose is not None:
        scale = rows * 4 / _HEIGHT_M
        middle = np.array([pose.hip_center[0], pose.hip_center[1]])
        place = (pose.joints[:, :2] - middle) * scale + np.array([columns, 0.56 * rows * 4])
        for start, stop in BONES:
            _line(dots, place[start], place[stop])
        head = place[Landmark.NOSE]
        for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False):
            _dot(dots, head + 0.09 * scale * np.array([np.cos(angle), np.sin(angle)]))
    cells = dots.reshape(rows, 4, columns, 2).transpose(0, 2, 1, 3)
    codes = 0x2800 + (cells * _DOTS).sum(axis=(2, 3))
    return "\n".join("".join(chr(int(code)) for code in line) for line in codes)


def _line(
    dots: Bool[np.ndarray, "y x"], start: Float[np.ndarray, " 2"], stop: Float[np.ndarray, " 2"]
) -> None:
    steps = int(np.ceil(np.abs(stop - start).max())) + 1
    for share in np.linspace(0, 1, min(steps, 400)):
        _dot(dots, start + share * (stop - start))


def _dot(dots: Bool[np.ndarray, "y x"], place: Float[np.ndarray, " 2"]) -> None:
    x, y = int(np.floor(place[0])), int(np.floor(place[1]))
    if 0 <= y < dots.shape[0] and 0 <= x < dots.shape[1]:
        dots[y, x] = True


__all__ = ["stick_figure"]
