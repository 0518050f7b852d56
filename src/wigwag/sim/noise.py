"""What a stereo depth camera adds to a perfect picture: noise, steps of disparity, and holes."""

# ruff: noqa: PLR0917 - compiled code takes flat arrays

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft
from jaxtyping import Float32, UInt8, UInt16
from numba import njit

from wigwag.camera.frame import Intrinsics


@dataclass(frozen=True, slots=True)
class SensorNoiseConfig:
    """An Intel RealSense D435 at 640x480: 50 mm baseline, matching to a fraction of a pixel."""

    baseline_m: float = 0.05
    """Distance of the two infrared imagers; the left one sits where the depth is."""
    subpixel: float = 0.08
    """Deviation of the disparity, pixels: depth errs by ``z^2 / (f * baseline)`` times this."""
    disparity_step: float = 1 / 32
    """The matcher's resolution, pixels."""
    patch_px: int = 3
    """Errors of neighbouring pixels go together over about this many pixels (matching windows)."""
    range_m: tuple[float, float] = (0.3, 10.0)
    """Depth outside is not reported."""
    edge_step: float = 0.06
    """A jump of depth by this share to the next pixel is an edge, where matching fails now and then."""
    edge_loss: float = 0.35
    """Share of such pixels that become holes."""
    blobs: float = 0.006
    """Share of the picture lost in blobs, where a surface has no texture or glares."""
    colour: float = 2.2
    """Deviation of red, green and blue, in display values."""


class SensorNoise:
    """Roughens perfect pictures. Noise tables are made once; each frame reads them from a random place.

    Args:
        config: How bad the sensor is.
        intrinsics: Of the camera, for its focal length and size.
        seed: The same seed and the same pictures give the same noise.
    """

    def __init__(
        self,
        config: SensorNoiseConfig | None = None,
        intrinsics: Intrinsics | None = None,
        seed: int = 0,
    ) -> None:
        self.config = c = config or SensorNoiseConfig()
        k = intrinsics or Intrinsics()
        self._rng = rng = np.random.default_rng([seed, 0x0153])
        self._side = 1024
        self._disparity = _smooth(rng, self._side, c.patch_px) * np.float32(c.subpixel)
        colour = np.float32(c.colour) * rng.standard_normal(1 << 20, dtype=np.float32)
        self._colour = np.clip(np.round(colour), -40, 40).astype(np.int8)
        self._chance = rng.random((self._side, self._side), dtype=np.float32)
        level = _smooth(rng, self._side, 9)
        self._blob = (level < np.quantile(level, c.blobs)).astype(np.uint8)
        self._focal_baseline = k.fx * c.baseline_m

    def apply(
        self, rgb: UInt8[np.ndarray, "height width 3"], depth_mm: UInt16[np.ndarray, "height width"]
    ) -> tuple[UInt8[np.ndarray, "height width 3"], UInt16[np.ndarray, "height width"]]:
        """Return the picture and the depth as the sensor would give them; the inputs stay as they are."""
        c = self.config
        at = self._rng.integers(0, self._side, 6)
        out, depth = np.empty_like(rgb), np.empty_like(depth_mm)
        start = int(self._rng.integers(0, len(self._colour)))
        _roughen_colour(rgb.reshape(-1), self._colour, start, out.reshape(-1))
        _roughen_depth(
            depth_mm, depth, self._disparity, self._chance, self._blob, at, self._focal_baseline,
            c.disparity_step, c.range_m[0], c.range_m[1], c.edge_step, c.edge_loss,
        )  # fmt: skip
        return out, depth


def _smooth(rng: np.random.Generator, side: int, width: int) -> Float32[np.ndarray, "side side"]:
    """Seamless Gaussian noise with unit deviation whose pixels go together over ``width`` pixels."""
    fy, fx = np.fft.fftfreq(side)[:, None], np.fft.rfftfreq(side)[None, :]
    kernel = np.exp(-2 * (np.pi * width / 2.355) ** 2 * (fy**2 + fx**2)).astype(np.float32)
    spectrum = scipy.fft.rfft2(rng.standard_normal((side, side), dtype=np.float32)) * kernel
    field = scipy.fft.irfft2(spectrum, s=(side, side))
    return np.asarray(field / field.std(), dtype=np.float32)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _roughen_colour(rgb: np.ndarray, table: np.ndarray, start: int, out: np.ndarray) -> None:
    """Add the table's values, from ``start`` on and round again, to display values."""
    n, size = rgb.shape[0], table.shape[0]
    done = 0
    at = start
    while done < n:
        run = min(size - at, n - done)
        for i in range(run):
            value = np.int16(rgb[done + i]) + np.int16(table[at + i])
            out[done + i] = np.uint8(min(max(value, np.int16(0)), np.int16(255)))
        done += run
        at = 0


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _roughen_depth(
    depth: np.ndarray, out: np.ndarray, disparity_noise: np.ndarray, chance: np.ndarray, blob: np.ndarray,
    at: np.ndarray, focal_baseline: float, step: float, nearest: float, farthest: float,
    edge_step: float, edge_loss: float,
) -> None:  # fmt: skip
    """Noise in disparity, its steps, range, edges, blobs, and the shadow of the second imager.

    The second imager sits to the right, so beside the left edge of a near thing it cannot see the
    background: there, disparity jumps up to the right by more pixels than the ray needs to pass.
    """
    height, width = depth.shape
    mask = disparity_noise.shape[0] - 1
    fb = np.float32(focal_baseline * 1000.0)
    inverse = np.float32(1.0 / step)
    grain = np.float32(step)
    lo, hi = np.float32(nearest * 1000.0), np.float32(farthest * 1000.0)
    edge, loss = np.float32(edge_step), np.float32(edge_loss)
    for v in range(height):
        noise = disparity_noise[(v + at[0]) & mask]
        luck = chance[(v + at[2]) & mask]
        lost = blob[(v + at[4]) & mask]
        # Going left, the nearest thing passed so far hides all whose ray to the second imager crosses it.
        frontier = np.float32(1e9)
        for u in range(width - 1, -1, -1):
            z = np.float32(depth[v, u])
            if z == 0:
                out[v, u] = 0
                continue
            d = fb / z
            reach = np.float32(u) - d
            hidden = reach > frontier - np.float32(0.5)
            frontier = min(frontier, reach)
            if z < lo or z > hi or lost[(u + at[5]) & mask]:
                out[v, u] = 0
                continue
            if hidden:
                out[v, u] = 0
                continue
            limit = edge * z
            beside = np.float32(depth[v, min(u + 2, width - 1)])
            before = np.float32(depth[v, max(u - 2, 0)])
            over = np.float32(depth[max(v - 2, 0), u])
            under = np.float32(depth[min(v + 2, height - 1), u])
            jump = max(abs(beside - z), abs(before - z), abs(over - z), abs(under - z))
            if jump > limit and luck[(u + at[3]) & mask] < loss:
                out[v, u] = 0
                continue
            d += noise[(u + at[1]) & mask]
            d = max(grain, np.floor(d * inverse + np.float32(0.5)) * grain)
            seen = fb / d
            out[v, u] = np.uint16(seen + np.float32(0.5)) if seen <= hi else np.uint16(0)
