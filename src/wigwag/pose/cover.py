"""What stands at somebody's place, by depth alone: they, somebody nearer, or nobody."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame

_NEARER_M, _FARTHER_M = 0.5, 0.5
"""Surfaces by this much nearer or farther than the hips are not the person's: an arm that reaches out to the
camera is nearer, but covers little of the trunk."""
_SIZE_M = (0.3, 0.44)
"""Width and height of the part of the trunk that is looked at, above the hips."""
_SAMPLES = (9, 13)


@dataclass(frozen=True, slots=True)
class Cover:
    """How much of somebody's trunk is hidden, by depth."""

    nearer: float = 0.0
    """Share of the place that somebody or something nearer covers, 0 to 1."""
    own: float = 0.0
    """Share at the person's own distance."""
    farther: float = 0.0
    """Share that shows what is behind: the person is not there."""
    range_m: float | None = None
    """Distance from the camera to what is nearer; ``None``: nothing is."""
    outside: bool = False
    """The place is out of the picture."""


def cover_at(frame: Frame, hips_m: Float[np.ndarray, " 3"]) -> Cover:
    """Look at the depth where somebody's trunk should be.

    Args:
        frame: With depth; without, nothing is known and nothing is covered.
        hips_m: Where the middle of their hips should be, camera optical frame.
    """
    k = frame.intrinsics
    height, width = frame.rgb.shape[:2]
    center = hips_m - np.array([0.0, _SIZE_M[1] / 2, 0.0])
    u, v = k.project(center)
    if not (0 <= u < width and 0 <= v < height):
        return Cover(outside=True)
    if frame.depth_mm is None:
        return Cover()
    half_u = k.fx * _SIZE_M[0] / 2 / float(center[2])
    half_v = k.fy * _SIZE_M[1] / 2 / float(center[2])
    columns = np.round(np.linspace(u - half_u, u + half_u, _SAMPLES[0])).astype(np.intp)
    rows = np.round(np.linspace(v - half_v, v + half_v, _SAMPLES[1])).astype(np.intp)
    columns, rows = columns[(columns >= 0) & (columns < width)], rows[(rows >= 0) & (rows < height)]
    z = frame.depth_mm[np.ix_(rows, columns)].astype(np.float64).ravel() * 1e-3
    z = z[z > 0]
    if len(z) < 0.25 * _SAMPLES[0] * _SAMPLES[1]:
        return Cover()
    off = z - float(hips_m[2])
    before = off < -_NEARER_M
    covering = None
    if before.any():
        covering = float(np.median(z[before])) * float(np.linalg.norm(center)) / float(center[2])
    behind = off > _FARTHER_M
    return Cover(float(before.mean()), float((~before & ~behind).mean()), float(behind.mean()), covering)


__all__ = ["Cover", "cover_at"]
