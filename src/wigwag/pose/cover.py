"""What stands at somebody's place, by depth alone: they, somebody nearer, or nobody."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame

_NEARER_M, _FARTHER_M = 0.4, 0.5
"""Surfaces nearer than the trunk's own by more, or farther than the hips, are not the person's: an arm that
reaches out to the camera is nearer, but covers little of the trunk."""
UPRIGHT_M = 0.1
"""How far the surface of an upright trunk lies before the hips."""
_MOST_LEAN_M = 0.6
_SIZE_M = (0.3, 0.44)
"""Width and height of the part of the trunk that is looked at, above the hips."""
_SAMPLES = (9, 13)
_ENOUGH = 0.5
"""Share of the place that must be the person's own to tell how far they lean."""


@dataclass(frozen=True, slots=True)
class Cover:
    """How much of somebody's trunk is hidden, by depth."""

    nearer: float = 0.0
    """Share of the place that somebody or something nearer covers, 0 to 1."""
    own: float = 0.0
    """Share at the person's own distance."""
    farther: float = 0.0
    """Share that shows what is behind: the person is not there."""
    lean_m: float | None = None
    """How far what is the person's own lies before their hips, metres; ``None``: too little of it is seen."""
    range_m: float | None = None
    """Distance from the camera to what is nearer; ``None``: nothing is."""
    outside: bool = False
    """The place is out of the picture."""


def cover_at(frame: Frame, hips_m: Float[np.ndarray, " 3"], lean_m: float = UPRIGHT_M) -> Cover:
    """Look at the depth where somebody's trunk should be.

    Who bends towards the camera has their trunk before their hips, and covers themselves; that comes bit by
    bit from frame to frame, whereas somebody who steps before them is nearer at once.

    Args:
        frame: With depth; without, nothing is known and nothing is covered.
        hips_m: Where the middle of their hips should be, camera optical frame.
        lean_m: How far their trunk's surface lay before the hips a moment ago, metres.
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
    before = off < -min(max(lean_m, UPRIGHT_M), _MOST_LEAN_M) - _NEARER_M
    covering = None
    if before.any():
        covering = float(np.median(z[before])) * float(np.linalg.norm(center)) / float(center[2])
    behind = off > _FARTHER_M
    own = ~before & ~behind
    lean = -float(np.median(off[own])) if own.mean() > _ENOUGH else None
    return Cover(float(before.mean()), float(own.mean()), float(behind.mean()), lean, covering)


__all__ = ["UPRIGHT_M", "Cover", "cover_at"]
