"""Compiled kernels: what colour the shapes take."""

# ruff: noqa: PLR0917 - compiled code takes flat arrays and calls little

from __future__ import annotations

import math

import numpy as np
from jaxtyping import UInt8
from numba import njit

from wigwag.sim.raycast import BOX, CUT, FAR, FIRST, SECOND, SURFACE, hit
from wigwag.sim.shapes import Surface

_FACE, _SHOE = int(Surface.FACE), int(Surface.SHOE)
_LEAVES, _PLANKS = int(Surface.LEAVES), int(Surface.PLANKS)
_TONES = 2048


def tone_curve() -> UInt8[np.ndarray, " tones"]:
    """Table from linear light, 0 to 1, to display values (sRGB)."""
    x = np.linspace(0.0, 1.0, _TONES)
    x = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(255 * x), dtype=np.uint8)


@njit(cache=True, fastmath=True, inline="always")  # type: ignore[untyped-decorator]
def _inside(y: float, z: float, y0: float, z0: float, half_y: float, half_z: float) -> bool:
    """Whether (y, z) lies in an ellipse around (y0, z0)."""
    a, b = (y - y0) / half_y, (z - z0) / half_z
    return a * a + b * b < 1.0


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _face(x: float, y: float, z: float, placed: np.ndarray, i: int) -> tuple[float, float, float]:
    """Colour of a face at (x forward, y left, z up), each as a share of the skull's radius."""
    r, g, b = placed[i, FIRST], placed[i, FIRST + 1], placed[i, FIRST + 2]
    hair = (placed[i, SECOND], placed[i, SECOND + 1], placed[i, SECOND + 2])
    side = abs(y)
    hairline = 0.50 - 0.35 * max(0.0, side - 0.55)
    if z > hairline + 0.1 * y * y or (x < 0.12 and z > -0.75):
        return hair[0], hair[1], hair[2]
    if x < 0.0:
        return 0.8 * r, 0.75 * g, 0.75 * b
    if _inside(side, z, 0.40, -0.20, 0.19, 0.085):
        if _inside(side, z, 0.39, -0.20, 0.085, 0.09):
            return 0.02, 0.015, 0.012
        return 0.75, 0.74, 0.72
    if _inside(side, z, 0.41, 0.02, 0.25, 0.06):
        return 0.6 * hair[0] + 0.01, 0.6 * hair[1] + 0.01, 0.6 * hair[2] + 0.01
    if _inside(y, z, 0.0, -1.02, 0.30, 0.075):
        return 0.55 * r + 0.06, 0.33 * g, 0.33 * b
    if _inside(side, z, 0.40, -0.24, 0.27, 0.20):
        return 0.82 * r, 0.78 * g, 0.76 * b
    if placed[i, CUT] > 0.5 and (z < -0.88 or (side > 0.52 and z < -0.45)):
        return 0.45 * r + 0.55 * hair[0], 0.45 * g + 0.55 * hair[1], 0.45 * b + 0.55 * hair[2]
    if _inside(side, z, 0.46, -0.62, 0.24, 0.20):
        return min(1.0, 1.06 * r), 0.88 * g, 0.86 * b
    return r, g, b


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def shade(
    placed: np.ndarray, i: int, t: float, x: float, y: float, rotation: np.ndarray, position: np.ndarray,
    light: np.ndarray, leaves: np.ndarray,
) -> tuple[float, float, float]:  # fmt: skip
    """Linear colour of the placed shape ``i`` where the ray (x, y, 1) meets it at depth ``t``.

    ``light`` holds, in the camera optical frame, the unit vector to the sun (3) and up (3), then the
    strength of sun, sky and ground light. ``leaves`` is seamless noise, 0 to 1.
    """
    px = t * (placed[i, 0] * x + placed[i, 1] * y + placed[i, 2]) - placed[i, 9]
    py = t * (placed[i, 3] * x + placed[i, 4] * y + placed[i, 5]) - placed[i, 10]
    pz = t * (placed[i, 6] * x + placed[i, 7] * y + placed[i, 8]) - placed[i, 11]
    along = 0.0
    if placed[i, BOX] > 0.0:
        ax, ay, az = abs(px), abs(py), abs(pz)
        top = max(ax, ay, az)
        nx = math.copysign(1.0, px) if ax == top else 0.0
        ny = math.copysign(1.0, py) if ay == top and nx == 0.0 else 0.0
        nz = math.copysign(1.0, pz) if nx == 0.0 and ny == 0.0 else 0.0
    else:
        reach = px * placed[i, 12] + py * placed[i, 13] + pz * placed[i, 14]
        foot = min(max((reach - placed[i, 18] * placed[i, 16]) / placed[i, 19], 0.0), placed[i, 15])
        along = foot / placed[i, 15] if placed[i, 15] > 0.0 else 0.0
        nx, ny, nz = px - foot * placed[i, 12], py - foot * placed[i, 13], pz - foot * placed[i, 14]
    # Normals go back through the transposed map.
    cx = placed[i, 0] * nx + placed[i, 3] * ny + placed[i, 6] * nz
    cy = placed[i, 1] * nx + placed[i, 4] * ny + placed[i, 7] * nz
    cz = placed[i, 2] * nx + placed[i, 5] * ny + placed[i, 8] * nz
    size = math.sqrt(cx * cx + cy * cy + cz * cz)
    cx, cy, cz = cx / size, cy / size, cz / size

    paint = int(placed[i, SURFACE])
    at = FIRST if along <= placed[i, CUT] else SECOND
    r, g, b = placed[i, at], placed[i, at + 1], placed[i, at + 2]
    if paint == _FACE:
        size = placed[i, 16]
        r, g, b = _face(px / size, py / size, pz / size, placed, i)
    elif paint == _SHOE:
        at = SECOND if pz < -0.55 * placed[i, 16] else FIRST
        r, g, b = placed[i, at], placed[i, at + 1], placed[i, at + 2]
    elif paint == _LEAVES:
        wx = t * (rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0]) + position[0]
        wy = t * (rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1]) + position[1]
        wz = t * (rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]) + position[2]
        mask = leaves.shape[0] - 1
        m = leaves[int(34.0 * (wx + wz) + 1e5) & mask, int(34.0 * (wy - 0.8 * wz) + 1e5) & mask]
        r += m * (placed[i, SECOND] - r)
        g += m * (placed[i, SECOND + 1] - g)
        b += m * (placed[i, SECOND + 2] - b)
    elif paint == _PLANKS:
        line = pz * 2.0 - math.floor(pz * 2.0)
        if line < 0.06:
            r, g, b = placed[i, SECOND], placed[i, SECOND + 1], placed[i, SECOND + 2]

    sun = max(0.0, cx * light[0] + cy * light[1] + cz * light[2])
    up = cx * light[3] + cy * light[4] + cz * light[5]
    # A surface seen edge-on is darker: sets an arm off from the chest behind it.
    facing = abs(x * cx + y * cy + cz) / math.sqrt(x * x + y * y + 1.0)
    rim = 0.62 + 0.38 * min(1.0, 1.7 * facing)
    sky = light[7] * (0.5 + 0.5 * up)
    ground = light[8] * (0.5 - 0.5 * up)
    strength = rim * (light[6] * sun + sky + ground)
    return r * (strength + 0.03 * sun), g * strength, b * (strength + 0.05 * sky)


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _parted(i: int, j: int, zi: float, zj: float, placed: np.ndarray) -> bool:
    """Whether an edge is seen between neighbouring pixels of shapes ``i`` and ``j``."""
    if i == j:
        return False
    if i < 0 or j < 0 or abs(zi - zj) > 0.01 * zi:
        return True
    return bool(placed[i, FIRST] != placed[j, FIRST])


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _smoothed(
    u: int, v: int, rgb: np.ndarray, seen: np.ndarray, camera: np.ndarray, placed: np.ndarray,
    rotation: np.ndarray, position: np.ndarray, light: np.ndarray, leaves: np.ndarray, tones: np.ndarray,
    around: np.ndarray, paint: np.ndarray,
) -> tuple[float, float, float]:  # fmt: skip
    """Sum of four samples in one pixel, of the shapes seen in it and around it."""
    height, width = seen.shape
    top = float(len(tones) - 1)
    n = 0
    for row in range(max(v - 1, 0), min(v + 2, height)):
        for column in range(max(u - 1, 0), min(u + 2, width)):
            j = seen[row, column]
            known = j < 0
            for k in range(n):
                known = known or around[k] == j
            if not known:
                around[n] = j
                paint[n, 0] = -1.0
                n += 1
    sr, sg, sb = 0.0, 0.0, 0.0
    for s in range(4):  # a rotated grid, which smooths flat and steep edges alike
        x = (u + (0.125, 0.375, -0.125, -0.375)[s] - camera[2]) / camera[0]
        y = (v + (-0.375, 0.125, 0.375, -0.125)[s] - camera[3]) / camera[1]
        best = float(FAR)
        which = -1
        for k in range(n):
            t = hit(placed, around[k], x, y)
            if t < best:
                best = t
                which = k
        if which < 0:
            sr += rgb[v, u, 0]
            sg += rgb[v, u, 1]
            sb += rgb[v, u, 2]
            continue
        # Within one pixel only a face changes its colour.
        if paint[which, 0] < 0.0 or placed[around[which], SURFACE] == _FACE:
            r, g, b = shade(placed, around[which], best, x, y, rotation, position, light, leaves)
            paint[which, 0] = tones[int(min(1.0, r) * top)]
            paint[which, 1] = tones[int(min(1.0, g) * top)]
            paint[which, 2] = tones[int(min(1.0, b) * top)]
        sr += paint[which, 0]
        sg += paint[which, 1]
        sb += paint[which, 2]
    return sr, sg, sb


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def resolve(
    rgb: np.ndarray, depth: np.ndarray, nearest: np.ndarray, seen: np.ndarray, boxes: np.ndarray,
    camera: np.ndarray, placed: np.ndarray, rotation: np.ndarray, position: np.ndarray,
    light: np.ndarray, leaves: np.ndarray, tones: np.ndarray,
) -> None:  # fmt: skip
    """Paint the shapes over the backdrop, with four samples a pixel along their edges and in faces."""
    per_fx, per_fy, cx, cy = 1.0 / camera[0], 1.0 / camera[1], camera[2], camera[3]
    height, width = depth.shape
    u_min, v_min, u_max, v_max = width, height, 0, 0
    for i in range(boxes.shape[0]):
        if boxes[i, 2] > boxes[i, 0]:
            u_min, v_min = min(u_min, boxes[i, 0]), min(v_min, boxes[i, 1])
            u_max, v_max = max(u_max, boxes[i, 2]), max(v_max, boxes[i, 3])
    around = np.empty(9, np.int64)
    paint = np.empty((9, 3), np.float64)
    top = float(len(tones) - 1)
    for v in range(v_min, v_max):
        y = (v - cy) * per_fy
        for u in range(u_min, u_max):
            i, z = seen[v, u], nearest[v, u]
            left, right = max(u - 1, 0), min(u + 1, width - 1)
            over, under = max(v - 1, 0), min(v + 1, height - 1)
            edge = False
            if seen[v, left] != i or seen[v, right] != i or seen[over, u] != i or seen[under, u] != i:
                edge = (
                    _parted(i, seen[v, left], z, nearest[v, left], placed)
                    or _parted(i, seen[v, right], z, nearest[v, right], placed)
                    or _parted(i, seen[over, u], z, nearest[over, u], placed)
                    or _parted(i, seen[under, u], z, nearest[under, u], placed)
                )
            elif i < 0:
                continue
            if i >= 0:
                depth[v, u] = np.uint16(1000.0 * z + 0.5) if z < 65.0 else np.uint16(0)
            if i < 0 and not edge:
                continue
            face = i >= 0 and placed[i, SURFACE] == _FACE
            if not (edge or face):
                r, g, b = shade(placed, i, z, (u - cx) * per_fx, y, rotation, position, light, leaves)
                rgb[v, u, 0] = tones[int(min(1.0, r) * top)]
                rgb[v, u, 1] = tones[int(min(1.0, g) * top)]
                rgb[v, u, 2] = tones[int(min(1.0, b) * top)]
                continue
            sr, sg, sb = _smoothed(
                u, v, rgb, seen, camera, placed, rotation, position, light, leaves, tones, around, paint
            )
            rgb[v, u, 0] = np.uint8(0.25 * sr + 0.5)
            rgb[v, u, 1] = np.uint8(0.25 * sg + 0.5)
            rgb[v, u, 2] = np.uint8(0.25 * sb + 0.5)
