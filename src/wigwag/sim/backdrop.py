"""Compiled kernels: ground, sky, far trees, and the shadows on the ground."""

# ruff: noqa: PLR0915, PLR0917 - compiled code takes flat arrays and calls little

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def backdrop(
    rgb: np.ndarray, depth: np.ndarray, camera: np.ndarray, position: np.ndarray, rotation: np.ndarray,
    ground: np.ndarray, starts: np.ndarray, texel_m: float, levels: np.ndarray, patches: np.ndarray,
    sky: np.ndarray, clouds: np.ndarray, skyline: np.ndarray,
) -> None:  # fmt: skip
    """Paint ground, sky and a far row of trees, and write the ground's depth in millimetres.

    ``ground`` is a flat stack of square textures (packed RGB), each half the size of the one before;
    ``levels`` holds, by distance in half metres, which one to read and how hazy it is there. ``patches``
    are large stains that hide the texture's repetition. ``skyline`` gives the far trees' height by
    azimuth, as a slope.
    """
    one = np.float32(1.0)
    per_fx, per_fy = np.float32(1.0 / camera[0]), np.float32(1.0 / camera[1])
    cx, cy = np.float32(camera[2]), np.float32(camera[3])
    height, width = depth.shape
    h = np.float32(max(position[2], 0.05))
    side = 1 << (len(starts) - 2)
    inverse = np.float32(1.0 / texel_m)
    # The textures repeat, so the camera's place within one repetition is enough, and small.
    span = side * 16
    x0 = np.float32((position[0] / texel_m) % span + 4 * span)
    y0 = np.float32((position[1] / texel_m) % span + 4 * span)
    stain_mask = patches.shape[0] - 1
    n_sky, n_cloud = sky.shape[0], clouds.shape[0] - 1
    hr, hg, hb = sky[0, 0], sky[0, 1], sky[0, 2]
    tops = _skyline_tops(camera, rotation, skyline, width)
    rx, ry, rz = np.float32(rotation[0, 0]), np.float32(rotation[0, 1]), np.float32(rotation[0, 2])
    step_x, step_y = inverse * rx * per_fx, inverse * ry * per_fx
    slope = rz * per_fx
    reach = np.empty(width, np.float32)
    for v in range(height):
        y = (np.float32(v) - cy) * per_fy
        wz0 = np.float32(rotation[1, 2]) * y + np.float32(rotation[2, 2]) - cx * slope
        wx0 = inverse * (np.float32(rotation[1, 0]) * y + np.float32(rotation[2, 0])) - cx * step_x
        wy0 = inverse * (np.float32(rotation[1, 1]) * y + np.float32(rotation[2, 1])) - cx * step_y
        line = depth[v]
        # Plain arithmetic on a whole row, which the compiler does many pixels at a time.
        for u in range(width):
            t = -h / min(wz0 + slope * np.float32(u), np.float32(-1e-6))
            reach[u] = t
            line[u] = np.uint16(np.float32(1000.0) * t + np.float32(0.5)) if t < 65.0 else np.uint16(0)
        for u in range(width):
            t = reach[u]
            column = np.float32(u)
            wz = wz0 + slope * column
            if wz < np.float32(-0.005):
                far = min(int(t + t), 255)
                level = int(levels[far, 0])
                gx = int(x0 + t * (wx0 + step_x * column))
                gy = int(y0 + t * (wy0 + step_y * column))
                mask = (side >> level) - 1
                c = ground[starts[level] + ((gy >> level) & mask) * (mask + 1) + ((gx >> level) & mask)]
                clear = levels[far, 1]
                haze = one - clear
                gain = clear * patches[(gy >> 4) & stain_mask, (gx >> 4) & stain_mask]
                rgb[v, u, 0] = np.uint8(np.float32(c & 255) * gain + haze * hr)
                rgb[v, u, 1] = np.uint8(np.float32((c >> 8) & 255) * gain + haze * hg)
                rgb[v, u, 2] = np.uint8(np.float32(c >> 16) * gain + haze * hb)
            elif wz < tops[u]:
                high = max(wz, np.float32(0.0)) / tops[u]
                rgb[v, u, 0] = np.uint8(62 + 30 * high)
                rgb[v, u, 1] = np.uint8(86 + 22 * high)
                rgb[v, u, 2] = np.uint8(74 + 26 * high)
            else:
                k = min(n_sky - 1, int(wz * n_sky))
                r, g, b = sky[k, 0], sky[k, 1], sky[k, 2]
                if wz > np.float32(0.06):
                    s = np.float32(96.0 * texel_m) / wz
                    cu = int(s * (wx0 + step_x * column) + np.float32(65536)) & n_cloud
                    cv = int(s * (wy0 + step_y * column) + np.float32(65536)) & n_cloud
                    cover = np.float32(clouds[cv, cu]) * np.float32(1 / 255)
                    cover *= min(one, np.float32(5.0) * (wz - np.float32(0.06)))
                    r += (np.float32(250) - r) * cover
                    g += (np.float32(250) - g) * cover
                    b += (np.float32(252) - b) * cover
                rgb[v, u, 0], rgb[v, u, 1], rgb[v, u, 2] = np.uint8(r), np.uint8(g), np.uint8(b)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _skyline_tops(camera: np.ndarray, rotation: np.ndarray, skyline: np.ndarray, width: int) -> np.ndarray:
    """Rise of the far trees' tops over each column's unit ray.

    The azimuth changes so little up a column that one value serves the whole of it.
    """
    tops = np.empty(width, np.float32)
    n = skyline.shape[0]
    for u in range(width):
        x = (u - camera[2]) / camera[0]
        east = rotation[0, 0] * x + rotation[2, 0]
        north = rotation[0, 1] * x + rotation[2, 1]
        f = (math.atan2(north, east) / (2 * math.pi) + 1.0) * n
        k = int(f)
        w = f - k
        tops[u] = math.hypot(east, north) * ((1 - w) * skyline[k % n] + w * skyline[(k + 1) % n])
    return tops


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _shadow_box(
    ends: np.ndarray, reach: float, camera: np.ndarray, position: np.ndarray, rotation: np.ndarray,
    box: np.ndarray,
) -> bool:  # fmt: skip
    """Part of the screen that a shadow between two points of the ground can touch; false: none."""
    u0, v0, u1, v1 = 1e9, 1e9, -1e9, -1e9
    gz = -position[2]
    for k in range(8):
        gx = ends[2 * (k & 1)] + (reach if k & 2 else -reach) - position[0]
        gy = ends[2 * (k & 1) + 1] + (reach if k & 4 else -reach) - position[1]
        z = rotation[2, 0] * gx + rotation[2, 1] * gy + rotation[2, 2] * gz
        if z < 0.3:  # beside or behind the camera: not worth the trouble
            return False
        u = camera[2] + camera[0] * (rotation[0, 0] * gx + rotation[0, 1] * gy + rotation[0, 2] * gz) / z
        v = camera[3] + camera[1] * (rotation[1, 0] * gx + rotation[1, 1] * gy + rotation[1, 2] * gz) / z
        u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
    if u1 < 0 or v1 < 0 or u0 >= camera[4] or v0 >= camera[5]:
        return False
    box[0], box[1] = int(max(0.0, u0)), int(max(0.0, v0))
    box[2], box[3] = int(min(camera[4], u1 + 2)), int(min(camera[5], v1 + 2))
    return True


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _cover(
    cover: np.ndarray, box: np.ndarray, ends: np.ndarray, radii: np.ndarray, camera: np.ndarray,
    position: np.ndarray, rotation: np.ndarray,
) -> None:  # fmt: skip
    """Mark how much of the sun the ground loses to one shape, whose shadow is taken as a flat capsule."""
    x0, y0, ex, ey = ends[0], ends[1], ends[2] - ends[0], ends[3] - ends[1]
    per_ee = 1.0 / (ex * ex + ey * ey + 1e-9)
    per_fx = 1.0 / camera[0]
    for v in range(box[1], box[3]):
        y = (v - camera[3]) / camera[1]
        for u in range(box[0], box[2]):
            x = (u - camera[2]) * per_fx
            wz = rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]
            if wz > -0.005:
                continue
            t = -position[2] / wz
            gx = position[0] + t * (rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0]) - x0
            gy = position[1] + t * (rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1]) - y0
            s = min(1.0, max(0.0, (gx * ex + gy * ey) * per_ee))
            dx, dy = gx - s * ex, gy - s * ey
            away = math.sqrt(dx * dx + dy * dy)
            soft = (radii[0] + s * (radii[1] - radii[0]) + 0.02 - away) / 0.05
            if soft > cover[v, u]:
                cover[v, u] = min(soft, 1.0)


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def shadows(
    rgb: np.ndarray, depth: np.ndarray, camera: np.ndarray, position: np.ndarray, rotation: np.ndarray,
    a: np.ndarray, b: np.ndarray, radii: np.ndarray, sun: np.ndarray, cover: np.ndarray,
) -> None:  # fmt: skip
    """Darken the ground where tapered capsules keep the sun away; ``sun`` is the unit vector to it."""
    boxes = np.zeros((a.shape[0], 4), np.int64)
    ends = np.empty((a.shape[0], 4), np.float64)
    u0, v0, u1, v1 = int(camera[4]), int(camera[5]), 0, 0
    for i in range(a.shape[0]):
        for k in range(2):
            ends[i, k] = a[i, k] - a[i, 2] / sun[2] * sun[k]
            ends[i, 2 + k] = b[i, k] - b[i, 2] / sun[2] * sun[k]
        reach = 1.4 * max(radii[i, 0], radii[i, 1]) + 0.03
        if _shadow_box(ends[i], reach, camera, position, rotation, boxes[i]):
            u0, v0 = min(u0, boxes[i, 0]), min(v0, boxes[i, 1])
            u1, v1 = max(u1, boxes[i, 2]), max(v1, boxes[i, 3])
    cover[v0:v1, u0:u1] = 0.0
    for i in range(a.shape[0]):
        _cover(cover, boxes[i], ends[i], radii[i], camera, position, rotation)
    for v in range(v0, v1):
        for u in range(u0, u1):
            if cover[v, u] > 0.0 and depth[v, u] > 0:
                k = 1.0 - 0.48 * cover[v, u]
                rgb[v, u, 0] = np.uint8(rgb[v, u, 0] * k)
                rgb[v, u, 1] = np.uint8(rgb[v, u, 1] * k)
                rgb[v, u, 2] = np.uint8(rgb[v, u, 2] * (0.06 + 0.94 * k))
