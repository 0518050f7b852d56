"""Compiled kernels: which shape each pixel sees, and how far away it is.

A ray through pixel (u, v) is ``t * (x, y, 1)`` in the camera optical frame, so ``t`` is the depth along
the optical axis, which is what an RGB-D camera measures.
"""

# ruff: noqa: PLR0912, PLR0915, PLR0917 - compiled code takes flat arrays and calls little

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float32, Float64, Int16, Int64
from numba import njit

FAR = np.float32(1e9)
"""Depth of a pixel that sees no shape."""
NEAR_M = 0.15
"""Nothing closer than this is drawn."""
COLUMNS = 29
"""Of the table of placed shapes: map 9, end 3, axis 3, length, two radii, sine, cosine squared; then what
paints it: is a box, surface, cut, two colours 6."""
BOX, SURFACE, CUT, FIRST, SECOND = 20, 21, 22, 23, 26
"""Where in that table."""


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def place(
    a: Float64[np.ndarray, "shapes 3"],
    b: Float64[np.ndarray, "shapes 3"],
    radii: Float64[np.ndarray, "shapes 2"],
    maps: Float64[np.ndarray, "shapes 3 3"],
    paint: Float64[np.ndarray, "shapes 9"],
    position: Float64[np.ndarray, 3],
    rotation: Float64[np.ndarray, "3 3"],
    camera: Float64[np.ndarray, 6],
    placed: Float64[np.ndarray, "shapes 29"],
    boxes: Int64[np.ndarray, "shapes 4"],
) -> None:
    """Bring shapes into the camera's view: fill ``placed`` and the screen ``boxes`` (u0, v0, u1, v1).

    A shape that the camera cannot see gets an empty box. ``camera`` is fx, fy, cx, cy, width, height.
    """
    fx, fy, cx, cy, width, height = camera
    for i in range(a.shape[0]):
        row = placed[i]
        for k in range(9):
            row[BOX + k] = paint[i, k]
        for r in range(3):
            for c in range(3):
                row[3 * r + c] = (
                    maps[i, r, 0] * rotation[c, 0]
                    + maps[i, r, 1] * rotation[c, 1]
                    + maps[i, r, 2] * rotation[c, 2]
                )
        length = 0.0
        for r in range(3):
            at = 0.0
            to = 0.0
            for c in range(3):
                at += maps[i, r, c] * (a[i, c] - position[c])
                to += maps[i, r, c] * (b[i, c] - a[i, c])
            row[9 + r] = at
            row[12 + r] = to
            length += to * to
        length = math.sqrt(length)
        ra, rb = radii[i, 0], radii[i, 1]
        sine = 0.0
        if length > abs(ra - rb) + 1e-9:
            sine = (ra - rb) / length
            for r in range(3):
                row[12 + r] /= length
        else:  # one sphere holds the other: only that one is seen
            if rb > ra:
                for r in range(3):
                    row[9 + r] += row[12 + r]
                ra = rb
            length = 0.0
            row[12], row[13], row[14] = 0.0, 0.0, 1.0
        row[15], row[16], row[17], row[18], row[19] = length, ra, rb, sine, 1 - sine * sine

        u0, v0, u1, v1 = 1e9, 1e9, -1e9, -1e9
        behind, beyond_left, beyond_right, above, below = True, True, True, True, True
        for end in range(2):
            px = (b[i, 0] if end else a[i, 0]) - position[0]
            py = (b[i, 1] if end else a[i, 1]) - position[1]
            pz = (b[i, 2] if end else a[i, 2]) - position[2]
            x = rotation[0, 0] * px + rotation[0, 1] * py + rotation[0, 2] * pz
            y = rotation[1, 0] * px + rotation[1, 1] * py + rotation[1, 2] * pz
            z = rotation[2, 0] * px + rotation[2, 1] * py + rotation[2, 2] * pz
            r_end = radii[i, end]
            # Distance of the end's centre from the planes that bound the view, against its radius.
            behind = behind and z + r_end < NEAR_M
            beyond_left = beyond_left and fx * x + cx * z < -r_end * math.hypot(fx, cx)
            beyond_right = beyond_right and fx * x - (width - cx) * z > r_end * math.hypot(fx, width - cx)
            above = above and fy * y + cy * z < -r_end * math.hypot(fy, cy)
            below = below and fy * y - (height - cy) * z > r_end * math.hypot(fy, height - cy)
            front = z - r_end
            if front < NEAR_M:  # reaches beside or behind the lens: look everywhere
                u0, v0, u1, v1 = 0.0, 0.0, width, height
                continue
            back = z + r_end
            left, right = x - r_end, x + r_end
            upper, lower = y - r_end, y + r_end
            u0 = min(u0, cx + fx * left / (front if left < 0 else back))
            u1 = max(u1, cx + fx * right / (front if right > 0 else back))
            v0 = min(v0, cy + fy * upper / (front if upper < 0 else back))
            v1 = max(v1, cy + fy * lower / (front if lower > 0 else back))
        hidden = behind or beyond_left or beyond_right or above or below
        if hidden or u1 < 0 or v1 < 0 or u0 >= width or v0 >= height:
            boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = 0, 0, 0, 0
        else:
            boxes[i, 0] = int(max(0.0, math.floor(u0)))
            boxes[i, 1] = int(max(0.0, math.floor(v0)))
            boxes[i, 2] = int(min(width, math.ceil(u1) + 1))
            boxes[i, 3] = int(min(height, math.ceil(v1) + 1))


@njit(cache=True, fastmath=True, inline="always")  # type: ignore[untyped-decorator]
def hit_capsule(
    dx: float, dy: float, dz: float, ax: float, ay: float, az: float,
    nx: float, ny: float, nz: float, length: float, ra: float, rb: float, sine: float, cos2: float,
) -> float:  # fmt: skip
    """Distance ``t`` at which the ray ``t * d`` enters a tapered capsule, or ``FAR``.

    The capsule is the hull of two spheres: a piece of a cone that touches both, and the spheres' outer
    caps. ``ax..`` is the first centre, ``nx..`` the unit axis, both in the ray's own frame.
    """
    dd = dx * dx + dy * dy + dz * dz
    da = dx * ax + dy * ay + dz * az
    aa = ax * ax + ay * ay + az * az
    best = 1e9
    if length > 0.0:
        dn = dx * nx + dy * ny + dz * nz
        an = ax * nx + ay * ny + az * nz
        k = ra + sine * an
        qa = cos2 * (dd - dn * dn) - sine * sine * dn * dn
        qb = cos2 * (dn * an - da) + k * sine * dn
        qc = cos2 * (aa - an * an) - k * k
        disc = qb * qb - qa * qc
        if qa > 0.0:
            if disc < 0.0:  # both spheres lie inside the endless cone: who misses it misses them
                return 1e9
            if qb < 0.0:
                t = qc / (math.sqrt(disc) - qb)  # the first root, exact also where ``qa`` vanishes
                foot = (t * dn - an - sine * ra) / cos2
                if 0.0 <= foot <= length and t > NEAR_M:
                    return t
        elif disc >= 0.0:
            # A ray steeper than the cone may enter at either root: one of them lies on the far nappe.
            q = -qb - math.copysign(math.sqrt(disc), qb)
            for root in range(2):
                below = qa if root == 0 else q
                if abs(below) > 1e-12:
                    t = (q if root == 0 else qc) / below
                    foot = (t * dn - an - sine * ra) / cos2
                    if 0.0 <= foot <= length and NEAR_M < t < best:
                        best = t
        bx, by, bz = ax + length * nx, ay + length * ny, az + length * nz
        db = dx * bx + dy * by + dz * bz
        disc = db * db - dd * (bx * bx + by * by + bz * bz - rb * rb)
        if disc > 0.0:
            t = (db - math.sqrt(disc)) / dd
            if NEAR_M < t < best:
                best = t
    disc = da * da - dd * (aa - ra * ra)
    if disc > 0.0:
        t = (da - math.sqrt(disc)) / dd
        if t > NEAR_M and t < best:
            best = t
    return best


@njit(cache=True, fastmath=True, inline="always")  # type: ignore[untyped-decorator]
def hit_box(dx: float, dy: float, dz: float, ax: float, ay: float, az: float) -> float:
    """Distance ``t`` at which the ray ``t * d`` enters the cube of half-width 1 around ``a``, or ``FAR``."""
    enter, leave = -1e9, 1e9
    for axis in range(3):
        d = dx if axis == 0 else (dy if axis == 1 else dz)
        c = ax if axis == 0 else (ay if axis == 1 else az)
        if abs(d) < 1e-12:
            d = 1e-12
        t0, t1 = (c - 1.0) / d, (c + 1.0) / d
        if t0 > t1:
            t0, t1 = t1, t0
        enter = max(enter, t0)
        leave = min(leave, t1)
    return enter if NEAR_M < enter < leave else 1e9


@njit(cache=True, fastmath=True, inline="always")  # type: ignore[untyped-decorator]
def hit(placed: Float64[np.ndarray, "shapes 29"], i: int, x: float, y: float) -> float:
    """Depth at which the pixel's ray (x, y, 1) enters the placed shape ``i``, or ``FAR``.

    The table goes in whole: a view of one row would cost more than the intersection.
    """
    dx = placed[i, 0] * x + placed[i, 1] * y + placed[i, 2]
    dy = placed[i, 3] * x + placed[i, 4] * y + placed[i, 5]
    dz = placed[i, 6] * x + placed[i, 7] * y + placed[i, 8]
    if placed[i, BOX] > 0.0:
        t: float = hit_box(dx, dy, dz, placed[i, 9], placed[i, 10], placed[i, 11])
        return t
    t = hit_capsule(
        dx, dy, dz, placed[i, 9], placed[i, 10], placed[i, 11], placed[i, 12], placed[i, 13], placed[i, 14],
        placed[i, 15], placed[i, 16], placed[i, 17], placed[i, 18], placed[i, 19],
    )  # fmt: skip
    return t


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def cast(
    placed: Float64[np.ndarray, "shapes 29"],
    boxes: Int64[np.ndarray, "shapes 4"],
    camera: Float64[np.ndarray, 6],
    nearest: Float32[np.ndarray, "height width"],
    seen: Int16[np.ndarray, "height width"],
) -> None:
    """Fill ``nearest`` with depth in metres and ``seen`` with the shape's index; -1 and ``FAR``: none."""
    per_fx, per_fy, cx, cy = 1.0 / camera[0], 1.0 / camera[1], camera[2], camera[3]
    nearest[:] = FAR
    seen[:] = -1
    for i in range(placed.shape[0]):
        u0, v0, u1, v1 = boxes[i]
        for v in range(v0, v1):
            y = (v - cy) * per_fy
            for u in range(u0, u1):
                t = hit(placed, i, (u - cx) * per_fx, y)
                if t < nearest[v, u]:
                    nearest[v, u] = t
                    seen[v, u] = i
