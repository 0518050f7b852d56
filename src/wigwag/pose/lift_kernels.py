"""The compiled inside of lifting: from depths in windows to one depth a landmark."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from wigwag.skeleton import Landmark

SURFACE, QUARTILE, MEDIAN, PIXEL = range(4)
"""Codes of the statistics."""

DEPTH, SPREAD, FILL, WIDENED = range(4)
"""Columns of what the kernel finds for a landmark: depth, millimetres, 0 if there is none; half the range of
the middle two thirds of its surface's depths, millimetres; the share of the window's pixels that the surface
fills (holes, the background and other surfaces take the rest); 1 if a window twice as wide was needed."""


class Task(NamedTuple):
    """What the kernels must know beside picture and landmarks."""

    fx: float
    """Pixels."""
    fy: float
    """Pixels."""
    window_mm: float
    """Side of the window at the body's distance."""
    reach_mm: float
    """Depths farther from the body's distance than this do not count."""
    statistic: int
    """One of the codes above."""


# The "surface" rule. Chosen on UTD-MHAD depth of subjects 1, 3, 5, 7 (`wigwag benchmark lift` reports the
# other four). Trunk landmarks are wide, and an arm may cross them: a window of 135 mm, and of the surfaces
# in it the one at the trunk's depth. A wrist has nothing of the body before it that matters: the nearest
# surface, a little before its middle. Elbow, knee and heel: the largest surface.
_TRUNK, _FRONT, _LARGEST = range(3)
_RULE = np.array([_TRUNK] * 3 + [_LARGEST] * 2 + [_FRONT] * 2 + [_TRUNK] * 2 + [_LARGEST] * 4)
_SCALE = np.array([1.0] + [1.5] * 2 + [1.0] * 4 + [1.5] * 4 + [1.0] * 2)
_QUANTILE = np.array([0.5] * 5 + [0.35] * 2 + [0.5] * 6)
_PARENT = np.array([-1, -1, -1, 1, 2, 3, 4, -1, -1, 7, 8, 9, 10])
"""The landmark a bone hangs on; -1: the trunk itself."""
_BONE_MM = np.array([400.0] * 9 + [600.0] * 4)
"""No bone is longer, so no landmark's depth differs more from its parent's (arm segments, thigh, shank)."""
_GAP_MM = 40.0
"""Sorted depths of one surface lie closer than this; stereo noise grows with the square of distance."""
_GAP_FROM_MM = 3000.0
"""The distance from which the gap grows."""
_TRUNK_QUANTILE = 0.65
"""Where among the trunk's depths the trunk itself lies: arms lie before it, little lies behind."""
_ARM_MM = 120.0
"""A shoulder or hip that seems this far before the trunk is covered by an arm: look farther around it."""
_LEAST_SHARE = 0.05
"""A surface has at least this share of its window; less is flying pixels."""
_LEFT_SHOULDER, _RIGHT_SHOULDER = int(Landmark.LEFT_SHOULDER), int(Landmark.RIGHT_SHOULDER)
_LEFT_HIP, _RIGHT_HIP = int(Landmark.LEFT_HIP), int(Landmark.RIGHT_HIP)
_TRUNK_SAMPLES = 1000
_WINDOW_SAMPLES = 21
"""Larger windows are thinned to about this many rows and columns, to bound the time."""


@njit(cache=True)  # type: ignore[untyped-decorator]  # numba ships no types
def lift_depths(depth: Any, points: Any, task: Task) -> Any:
    """Find each landmark's surface depth.

    Args:
        depth: Shape (height, width), uint16 millimetres.
        points: Shape (13, 2), float64 pixels.
        task: See :class:`Task`.

    Returns:
        Shape (13, 4), the columns above, all 0 where there is no depth; and the body's distance in
        millimetres, 0 if there is no depth at the trunk.
    """
    found = np.zeros((len(points), 4))
    values = np.empty(4 * _TRUNK_SAMPLES + 4 * _WINDOW_SAMPLES * _WINDOW_SAMPLES)
    n = _trunk_depths(depth, points, values)
    if n == 0:
        return found, 0.0
    trunk_depths = np.sort(values[:n])
    distance = _first_quartile_mean(trunk_depths)
    trunk = trunk_depths[int(n * _TRUNK_QUANTILE)]
    for i in range(len(points)):
        u, v = points[i, 0], points[i, 1]
        if not (-0.5 <= u < depth.shape[1] - 0.5 and -0.5 <= v < depth.shape[0] - 0.5):
            continue
        if task.statistic == PIXEL:
            pixel = float(depth[int(np.floor(v + 0.5)), int(np.floor(u + 0.5))])
            if abs(pixel - distance) <= task.reach_mm:
                found[i] = np.array([pixel, 0.0, 1.0, 0.0])
            continue
        for widen in (1.0, 2.0):  # a hole at the landmark may be smaller than twice the window
            scale = widen * (_SCALE[i] if task.statistic == SURFACE else 1.0)
            # eq. window: 90 mm x f / Z
            side_mm = scale * task.window_mm
            half = (0.5 * side_mm * task.fx / distance, 0.5 * side_mm * task.fy / distance)
            accepted = (distance - task.reach_mm, distance + task.reach_mm)
            n, pixels = _gather(depth, (u, v), half, accepted, values)
            if n == 0:
                continue
            window = np.sort(values[:n])
            value: Any = 0.0
            start, end = 0, n
            if task.statistic == QUARTILE:
                value = _first_quartile_mean(window)
            elif task.statistic == MEDIAN:
                value = np.median(window)
            else:
                value, start, end = _surface(window, i, found[:, DEPTH], trunk)
            if value > 0.0:
                found[i, DEPTH] = value
                found[i, SPREAD] = _spread(window[start:end])
                found[i, FILL] = (end - start) / pixels
                found[i, WIDENED] = 1.0 if widen > 1.0 else 0.0
                covered = task.statistic == SURFACE and _RULE[i] == _TRUNK and value < trunk - _ARM_MM
                if not covered:
                    break
    return found, distance


@njit(cache=True)  # type: ignore[untyped-decorator]
def _trunk_depths(depth: Any, points: Any, values: Any) -> int:
    """Collect the depths between shoulders and hips; returns how many."""
    height, width = depth.shape
    quad = np.array([_LEFT_SHOULDER, _RIGHT_SHOULDER, _RIGHT_HIP, _LEFT_HIP])
    u0, u1 = points[quad, 0].min(), points[quad, 0].max()
    v0, v1 = points[quad, 1].min(), points[quad, 1].max()
    u0, u1 = max(np.floor(u0), 0.0), min(np.ceil(u1), width - 1.0)
    v0, v1 = max(np.floor(v0), 0.0), min(np.ceil(v1), height - 1.0)
    if u1 < u0 or v1 < v0:
        return 0
    stride = max(int(np.ceil(np.sqrt((u1 - u0 + 1) * (v1 - v0 + 1) / _TRUNK_SAMPLES))), 1)
    for inside_only in (True, False):  # a trunk seen from the side has no inside: take its box
        n = 0
        for v in range(int(v0), int(v1) + 1, stride):
            for u in range(int(u0), int(u1) + 1, stride):
                if depth[v, u] > 0 and (not inside_only or _is_inside(points, quad, u, v)):
                    values[n] = depth[v, u]
                    n += 1
        if n >= 8:
            return n
    return n


@njit(cache=True)  # type: ignore[untyped-decorator]
def _is_inside(points: Any, quad: Any, u: float, v: float) -> bool:
    """Whether a pixel lies inside the polygon (crossings of a ray to the right are odd)."""
    inside = False
    for a in range(len(quad)):
        ua, va = points[quad[a], 0], points[quad[a], 1]
        ub, vb = points[quad[a - 1], 0], points[quad[a - 1], 1]
        if (va > v) != (vb > v) and u < (ub - ua) * (v - va) / (vb - va) + ua:
            inside = not inside
    return inside


@njit(cache=True)  # type: ignore[untyped-decorator]
def _first_quartile_mean(ascending: Any) -> Any:
    """Mean of the nearest quarter: leaves the background out (paper, section 1, step 3)."""
    return ascending[: (len(ascending) + 3) // 4].mean()


@njit(cache=True)  # type: ignore[untyped-decorator]
def _spread(ascending: Any) -> Any:
    """Half the range of the middle two thirds: for Gaussian noise, its standard deviation."""
    last = len(ascending) - 1
    return 0.5 * (ascending[int(0.84 * last + 0.5)] - ascending[int(0.16 * last + 0.5)])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _gather(depth: Any, center: Any, half: Any, accepted: Any, values: Any) -> Any:
    """Collect the depths within ``accepted`` in the window around ``center``.

    Returns how many there are, and how many pixels were looked at.
    """
    height, width = depth.shape
    half_u, half_v = max(half[0], 1.0), max(half[1], 1.0)
    u0, u1 = max(int(np.ceil(center[0] - half_u)), 0), min(int(np.floor(center[0] + half_u)), width - 1)
    v0, v1 = max(int(np.ceil(center[1] - half_v)), 0), min(int(np.floor(center[1] + half_v)), height - 1)
    stride = (max(u1 - u0, v1 - v0) + _WINDOW_SAMPLES) // _WINDOW_SAMPLES
    n, pixels = 0, 0
    for v in range(v0, v1 + 1, stride):
        for u in range(u0, u1 + 1, stride):
            pixels += 1
            z = float(depth[v, u])
            if z > 0.0 and accepted[0] <= z <= accepted[1]:
                values[n] = z
                n += 1
    return n, pixels


@njit(cache=True)  # type: ignore[untyped-decorator]
def _surface(window: Any, i: int, z: Any, trunk: float) -> Any:
    """Split a window's ascending depths into surfaces and pick landmark ``i``'s.

    Returns its depth, 0 if no surface can be the landmark's own, and where it starts and ends in the window.

    Surfaces are runs of depths without a gap. One that no bone could reach from the parent's depth is
    the background, not the landmark.
    """
    parent = _PARENT[i]
    hangs = parent >= 0 and z[parent] > 0.0
    anchor = z[parent] if hangs else trunk
    reach = _BONE_MM[i] if hangs or parent < 0 else 2.0 * _BONE_MM[i]
    gap = _GAP_MM * max(1.0, trunk / _GAP_FROM_MM) ** 2
    n = len(window)
    best_score, best, best_start, best_end, start = -np.inf, 0.0, 0, n, 0
    for end in range(1, n + 1):
        if end < n and window[end] - window[end - 1] <= gap:
            continue
        middle = window[start + (end - start) // 2]
        value = window[start + int((end - start - 1) * _QUANTILE[i])]
        if _RULE[i] == _TRUNK:
            score = -abs(middle - trunk)
        elif _RULE[i] == _FRONT:
            score = -middle
        else:
            score = float(end - start)
        # an elbow misread onto the chest must not forbid the wrist before it: a wrist may be any nearer
        possible = value - anchor <= reach and (anchor - value <= reach or _RULE[i] == _FRONT)
        if possible and end - start >= _LEAST_SHARE * n and score > best_score:
            best_score, best, best_start, best_end = score, value, start, end
        start = end
    return best, best_start, best_end


__all__ = [
    "DEPTH", "FILL", "MEDIAN", "PIXEL", "QUARTILE", "SPREAD", "SURFACE", "WIDENED", "Task",
    "lift_depths",
]  # fmt: skip
