"""Compiled kernels: what colour each pixel takes."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64, UInt8
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


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
def _face(
    x: float, y: float, z: float, skin: Float64[np.ndarray, 3], hair: Float64[np.ndarray, 3], beard: float
) -> tuple[float, float, float]:
    """Colour of a face at (x forward, y left, z up), each as a share of the skull's radius."""
    r, g, b = skin[0], skin[1], skin[2]
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
        return 0.72 * r, 0.66 * g, 0.64 * b
    if beard > 0.5 and (z < -0.88 or (side > 0.52 and z < -0.45)):
        return 0.3 * r + 0.7 * hair[0], 0.3 * g + 0.7 * hair[1], 0.3 * b + 0.7 * hair[2]
    if _inside(side, z, 0.46, -0.62, 0.24, 0.20):
        return min(1.0, 1.06 * r), 0.88 * g, 0.86 * b
    return r, g, b


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
def shade(
    row: np.ndarray, t: float, x: float, y: float, rotation: np.ndarray, position: np.ndarray,
    light: np.ndarray, leaves: np.ndarray,
) -> tuple[float, float, float]:  # fmt: skip
    """Linear colour of a placed shape where the ray (x, y, 1) meets it at depth ``t``.

    ``light`` holds, in the camera optical frame, the unit vector to the sun (3) and up (3), then the
    strength of sun, sky and ground light. ``leaves`` is seamless noise, 0 to 1.
    """
    px = t * (row[0] * x + row[1] * y + row[2]) - row[9]
    py = t * (row[3] * x + row[4] * y + row[5]) - row[10]
    pz = t * (row[6] * x + row[7] * y + row[8]) - row[11]
    along = 0.0
    if row[BOX] > 0.0:
        ax, ay, az = abs(px), abs(py), abs(pz)
        top = max(ax, ay, az)
        nx = math.copysign(1.0, px) if ax == top else 0.0
        ny = math.copysign(1.0, py) if ay == top and nx == 0.0 else 0.0
        nz = math.copysign(1.0, pz) if nx == 0.0 and ny == 0.0 else 0.0
    else:
        reach = px * row[12] + py * row[13] + pz * row[14]
        foot = min(max((reach - row[18] * row[16]) / row[19], 0.0), row[15])
        along = foot / row[15] if row[15] > 0.0 else 0.0
        nx, ny, nz = px - foot * row[12], py - foot * row[13], pz - foot * row[14]
    # Normals go back through the transposed map.
    cx = row[0] * nx + row[3] * ny + row[6] * nz
    cy = row[1] * nx + row[4] * ny + row[7] * nz
    cz = row[2] * nx + row[5] * ny + row[8] * nz
    size = math.sqrt(cx * cx + cy * cy + cz * cz)
    cx, cy, cz = cx / size, cy / size, cz / size

    paint = int(row[SURFACE])
    at = FIRST if along <= row[CUT] else SECOND
    r, g, b = row[at], row[at + 1], row[at + 2]
    if paint == _FACE:
        size = row[16]
        r, g, b = _face(px / size, py / size, pz / size, row[FIRST:SECOND], row[SECOND:], row[CUT])
    elif paint == _SHOE:
        at = SECOND if pz < -0.55 * row[16] else FIRST
        r, g, b = row[at], row[at + 1], row[at + 2]
    elif paint == _LEAVES:
        wx = t * (rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0]) + position[0]
        wy = t * (rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1]) + position[1]
        wz = t * (rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]) + position[2]
        mask = leaves.shape[0] - 1
        m = leaves[int(34.0 * (wx + wz) + 1e5) & mask, int(34.0 * (wy - 0.8 * wz) + 1e5) & mask]
        r += m * (row[SECOND] - r)
        g += m * (row[SECOND + 1] - g)
        b += m * (row[SECOND + 2] - b)
    elif paint == _PLANKS:
        line = pz * 2.0 - math.floor(pz * 2.0)
        if line < 0.06:
            r, g, b = row[SECOND], row[SECOND + 1], row[SECOND + 2]

    sun = max(0.0, cx * light[0] + cy * light[1] + cz * light[2])
    up = cx * light[3] + cy * light[4] + cz * light[5]
    # A surface seen edge-on is darker: sets an arm off from the chest behind it.
    facing = abs(x * cx + y * cy + cz) / math.sqrt(x * x + y * y + 1.0)
    rim = 0.62 + 0.38 * min(1.0, 1.7 * facing)
    sky = light[7] * (0.5 + 0.5 * up)
    ground = light[8] * (0.5 - 0.5 * up)
    strength = rim * (light[6] * sun + sky + ground)
    return r * (strength + 0.03 * sun), g * strength, b * (strength + 0.05 * sky)


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
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
    for v in range(height):
        y = (np.float32(v) - cy) * per_fy
        bx = np.float32(rotation[1, 0]) * y + np.float32(rotation[2, 0])
        by = np.float32(rotation[1, 1]) * y + np.float32(rotation[2, 1])
        bz = np.float32(rotation[1, 2]) * y + np.float32(rotation[2, 2])
        for u in range(width):
            x = (np.float32(u) - cx) * per_fx
            wz = bz + rz * x
            wx = bx + rx * x
            wy = by + ry * x
            if wz < np.float32(-0.005):
                t = -h / wz
                far = min(int(t + t), 255)
                level = int(levels[far, 0])
                gx = int(x0 + inverse * t * wx)
                gy = int(y0 + inverse * t * wy)
                mask = (side >> level) - 1
                c = ground[starts[level] + ((gy >> level) & mask) * (mask + 1) + ((gx >> level) & mask)]
                clear = levels[far, 1]
                haze = one - clear
                gain = clear * patches[(gy >> 4) & stain_mask, (gx >> 4) & stain_mask]
                rgb[v, u, 0] = np.uint8(np.float32(c & 255) * gain + haze * hr)
                rgb[v, u, 1] = np.uint8(np.float32((c >> 8) & 255) * gain + haze * hg)
                rgb[v, u, 2] = np.uint8(np.float32(c >> 16) * gain + haze * hb)
                depth[v, u] = np.uint16(np.float32(1000.0) * t + np.float32(0.5)) if t < 65.0 else 0
                continue
            depth[v, u] = 0
            if wz < tops[u]:
                high = wz / tops[u]
                rgb[v, u, 0] = np.uint8(62 + 30 * high)
                rgb[v, u, 1] = np.uint8(86 + 22 * high)
                rgb[v, u, 2] = np.uint8(74 + 26 * high)
                continue
            k = min(n_sky - 1, int(wz * n_sky))
            r, g, b = sky[k, 0], sky[k, 1], sky[k, 2]
            if wz > np.float32(0.06):
                s = np.float32(24.0) / wz
                cover = clouds[int(s * wy + 65536) & n_cloud, int(s * wx + 65536) & n_cloud]
                cover *= min(one, np.float32(5.0) * (wz - np.float32(0.06)))
                r += (np.float32(250) - r) * cover
                g += (np.float32(250) - g) * cover
                b += (np.float32(252) - b) * cover
            rgb[v, u, 0], rgb[v, u, 1], rgb[v, u, 2] = np.uint8(r), np.uint8(g), np.uint8(b)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _skyline_tops(
    camera: np.ndarray, rotation: np.ndarray, skyline: np.ndarray, width: int
) -> np.ndarray:
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


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
def shadows(
    rgb: np.ndarray, depth: np.ndarray, camera: np.ndarray, position: np.ndarray, rotation: np.ndarray,
    a: np.ndarray, b: np.ndarray, radii: np.ndarray, sun: np.ndarray, cover: np.ndarray,
) -> None:  # fmt: skip
    """Darken the ground where tapered capsules keep the sun away; ``sun`` is the unit vector to it."""
    fx, fy, cx, cy, width, height = camera
    u_min, v_min, u_max, v_max = int(width), int(height), 0, 0
    todo = np.zeros((a.shape[0], 9), np.float64)
    for i in range(a.shape[0]):
        r0, r1 = radii[i, 0], radii[i, 1]
        x0, y0 = a[i, 0] - a[i, 2] / sun[2] * sun[0], a[i, 1] - a[i, 2] / sun[2] * sun[1]
        x1, y1 = b[i, 0] - b[i, 2] / sun[2] * sun[0], b[i, 1] - b[i, 2] / sun[2] * sun[1]
        reach = max(r0, r1) * 1.4 + 0.03
        u0, v0, u1, v1 = 1e9, 1e9, -1e9, -1e9
        for k in range(8):
            gx = (x1 if k & 1 else x0) + (reach if k & 2 else -reach) - position[0]
            gy = (y1 if k & 1 else y0) + (reach if k & 4 else -reach) - position[1]
            gz = -position[2]
            z = rotation[2, 0] * gx + rotation[2, 1] * gy + rotation[2, 2] * gz
            if z < 0.3:
                u0 = 1e9
                u1 = -1e9
                break
            u = cx + fx * (rotation[0, 0] * gx + rotation[0, 1] * gy + rotation[0, 2] * gz) / z
            v = cy + fy * (rotation[1, 0] * gx + rotation[1, 1] * gy + rotation[1, 2] * gz) / z
            u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
        if u1 < 0 or v1 < 0 or u0 >= width or v0 >= height or u1 < u0:
            continue
        iu0, iv0 = int(max(0.0, u0)), int(max(0.0, v0))
        iu1, iv1 = int(min(width, u1 + 2)), int(min(height, v1 + 2))
        u_min, v_min = min(u_min, iu0), min(v_min, iv0)
        u_max, v_max = max(u_max, iu1), max(v_max, iv1)
        todo[i, 0], todo[i, 1], todo[i, 2], todo[i, 3] = iu0, iv0, iu1, iv1
        todo[i, 4], todo[i, 5], todo[i, 6], todo[i, 7], todo[i, 8] = x0, y0, x1 - x0, y1 - y0, 1.0
    for v in range(v_min, v_max):
        for u in range(u_min, u_max):
            cover[v, u] = 0.0
    for i in range(a.shape[0]):
        if todo[i, 8] == 0.0:
            continue
        x0, y0, ex, ey = todo[i, 4], todo[i, 5], todo[i, 6], todo[i, 7]
        ee = ex * ex + ey * ey + 1e-9
        r0, r1 = radii[i, 0], radii[i, 1]
        for v in range(int(todo[i, 1]), int(todo[i, 3])):
            y = (v - cy) / fy
            for u in range(int(todo[i, 0]), int(todo[i, 2])):
                x = (u - cx) / fx
                wz = rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2]
                if wz > -0.005:
                    continue
                t = -position[2] / wz
                gx = position[0] + t * (rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0]) - x0
                gy = position[1] + t * (rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1]) - y0
                s = min(1.0, max(0.0, (gx * ex + gy * ey) / ee))
                away = math.hypot(gx - s * ex, gy - s * ey)
                soft = (r0 + s * (r1 - r0) + 0.02 - away) / 0.05
                if soft > cover[v, u]:
                    cover[v, u] = min(soft, 1.0)
    for v in range(v_min, v_max):
        for u in range(u_min, u_max):
            if cover[v, u] > 0.0 and depth[v, u] > 0:
                k = 1.0 - 0.48 * cover[v, u]
                rgb[v, u, 0] = np.uint8(rgb[v, u, 0] * k)
                rgb[v, u, 1] = np.uint8(rgb[v, u, 1] * k)
                rgb[v, u, 2] = np.uint8(rgb[v, u, 2] * (0.06 + 0.94 * k))


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
def _parted(i: int, j: int, zi: float, zj: float, placed: np.ndarray) -> bool:
    """Whether an edge is seen between neighbouring pixels of shapes ``i`` and ``j``."""
    if i == j:
        return False
    if i < 0 or j < 0 or abs(zi - zj) > 0.01 * zi:
        return True
    return bool(placed[i, FIRST] != placed[j, FIRST])


@njit(cache=True, fastmath=True)  # type: ignore[untyped-decorator]
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
                r, g, b = shade(placed[i], z, (u - cx) * per_fx, y, rotation, position, light, leaves)
                rgb[v, u, 0] = tones[int(min(1.0, r) * top)]
                rgb[v, u, 1] = tones[int(min(1.0, g) * top)]
                rgb[v, u, 2] = tones[int(min(1.0, b) * top)]
                continue
            n = 0
            for dv in range(-1, 2):
                for du in range(-1, 2):
                    if 0 <= v + dv < height and 0 <= u + du < width:
                        j = seen[v + dv, u + du]
                        known = j < 0
                        for k in range(n):
                            known = known or around[k] == j
                        if not known:
                            around[n] = j
                            paint[n, 0] = -1.0
                            n += 1
            sr, sg, sb = 0.0, 0.0, 0.0
            for s in range(4):  # a rotated grid, which smooths flat and steep edges alike
                xs = (u + (0.125, 0.375, -0.125, -0.375)[s] - cx) * per_fx
                ys = (v + (-0.375, 0.125, 0.375, -0.125)[s] - cy) * per_fy
                best = float(FAR)
                which = -1
                for k in range(n):
                    t = hit(placed[around[k]], xs, ys)
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
                    r, g, b = shade(placed[around[which]], best, xs, ys, rotation, position, light, leaves)
                    paint[which, 0] = tones[int(min(1.0, r) * top)]
                    paint[which, 1] = tones[int(min(1.0, g) * top)]
                    paint[which, 2] = tones[int(min(1.0, b) * top)]
                sr += paint[which, 0]
                sg += paint[which, 1]
                sb += paint[which, 2]
            rgb[v, u, 0] = np.uint8(0.25 * sr + 0.5)
            rgb[v, u, 1] = np.uint8(0.25 * sg + 0.5)
            rgb[v, u, 2] = np.uint8(0.25 * sb + 0.5)
