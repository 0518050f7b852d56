"""What a stereo depth camera adds to a perfect picture: noise, steps of disparity, and holes."""

# ruff: noqa: PLR0917 - compiled code takes flat arrays

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import scipy.fft
from jaxtyping import Float32, Int8, UInt8, UInt16
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
        # Tables are small numbers, and one row long enough to be read from anywhere without a break.
        self._grain_px = 4 * c.subpixel / 127
        self._disparity = self._wrapped(_whole(_smooth(rng, self._side, c.patch_px) * (127 / 4)), k.width)
        colour = np.float32(c.colour) * rng.standard_normal(1 << 20, dtype=np.float32)
        colour = np.clip(np.round(colour), -40, 40).astype(np.int16)
        self._lighter = np.maximum(colour, 0).astype(np.uint8)
        self._darker = np.maximum(-colour, 0).astype(np.uint8)
        self._chance = self._wrapped(rng.integers(0, 256, (self._side, self._side), dtype=np.uint8), k.width)
        level = _smooth(rng, self._side, 9)
        self._blob = self._wrapped((level < np.quantile(level, c.blobs)).astype(np.uint8), k.width)
        self._focal_baseline = k.fx * c.baseline_m

    @staticmethod
    def _wrapped(table: np.ndarray, width: int) -> np.ndarray:
        """Let rows go on from their beginning for another ``width`` places."""
        return np.pad(table, ((0, 0), (0, width)), mode="wrap")

    def apply(
        self, rgb: UInt8[np.ndarray, "height width 3"], depth_mm: UInt16[np.ndarray, "height width"]
    ) -> tuple[UInt8[np.ndarray, "height width 3"], UInt16[np.ndarray, "height width"]]:
        """Return the picture and the depth as the sensor would give them; the inputs stay as they are."""
        c = self.config
        at = self._rng.integers(0, self._side, 6)
        out, depth = np.empty_like(rgb), np.empty_like(depth_mm)
        self._roughen_colour(rgb.reshape(1, -1), out.reshape(1, -1))
        _roughen_depth(
            depth_mm, depth, self._disparity, self._chance, self._blob, at, self._grain_px,
            self._focal_baseline, c.disparity_step, c.range_m[0], c.range_m[1], c.edge_step,
            round(256 * c.edge_loss),
        )  # fmt: skip
        return out, depth

    def _roughen_colour(self, rgb: UInt8[np.ndarray, "1 n"], out: UInt8[np.ndarray, "1 n"]) -> None:
        """Add the tables' values, from anywhere on and round again, and keep within display values."""
        lighter, darker = self._lighter[None], self._darker[None]
        at, done = int(self._rng.integers(0, lighter.size)), 0
        while done < rgb.size:
            run = min(lighter.size - at, rgb.size - done)
            part = slice(done, done + run)
            cv2.add(rgb[:, part], lighter[:, at : at + run], dst=out[:, part])
            cv2.subtract(out[:, part], darker[:, at : at + run], dst=out[:, part])
            done, at = done + run, 0


def _smooth(rng: np.random.Generator, side: int, width: int) -> Float32[np.ndarray, "side side"]:
    """Seamless Gaussian noise with unit deviation whose pixels go together over ``width`` pixels."""
    fy, fx = np.fft.fftfreq(side)[:, None], np.fft.rfftfreq(side)[None, :]
    kernel = np.exp(-2 * (np.pi * width / 2.355) ** 2 * (fy**2 + fx**2)).astype(np.float32)
    spectrum = scipy.fft.rfft2(rng.standard_normal((side, side), dtype=np.float32)) * kernel
    field = scipy.fft.irfft2(spectrum, s=(side, side))
    return np.asarray(field / field.std(), dtype=np.float32)


def _whole(field: Float32[np.ndarray, "side side"]) -> Int8[np.ndarray, "side side"]:
    """Round to whole numbers of eight bits."""
    return np.asarray(np.clip(np.round(field), -127, 127), dtype=np.int8)


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _roughen_depth(
    depth: np.ndarray, out: np.ndarray, disparity_noise: np.ndarray, chance: np.ndarray, blob: np.ndarray,
    at: np.ndarray, grain_px: float, focal_baseline: float, step: float, nearest: float, farthest: float,
    edge_step: float, edge_loss: int,
) -> None:  # fmt: skip
    """Noise in disparity, its steps, range, edges, blobs, and the shadow of the second imager.

    The second imager sits to the right, so beside the left edge of a near thing it cannot see the
    background: there, disparity jumps up to the right by more pixels than the ray needs to pass.
    Short passes over a row, which the compiler does many pixels at a time.
    """
    height, width = depth.shape
    mask = disparity_noise.shape[0] - 1
    fb, per_noise = np.float32(focal_baseline * 1000.0), np.float32(grain_px)
    inverse, grain = np.float32(1.0 / step), np.float32(step)
    lo, hi, edge = np.float32(nearest * 1000.0), np.float32(farthest * 1000.0), np.float32(edge_step)
    half, loss = np.float32(0.5), np.uint8(min(edge_loss, 255))
    far = np.empty(width + 4, np.float32)  # this row, its ends repeated
    disparity, reach = np.empty(width, np.float32), np.empty(width, np.float32)
    seen, gone = np.empty(width, np.float32), np.empty(width, np.uint8)
    for v in range(height):
        row, over, under = depth[v], depth[max(v - 2, 0)], depth[min(v + 2, height - 1)]
        for u in range(width):
            far[u + 2] = np.float32(row[u])
        far[0] = far[1] = far[2]
        far[width + 2] = far[width + 3] = far[width + 1]
        for u in range(width):
            z = far[u + 2]
            disparity[u] = fb / max(z, np.float32(1.0))
            reach[u] = np.float32(u) - disparity[u] if z > 0 else np.float32(1e9)
        _hide(reach, gone)
        luck = chance[(v + at[2]) & mask, at[3] : at[3] + width]
        for u in range(width):
            z, limit = far[u + 2], edge * far[u + 2]
            beside, before = abs(far[u + 4] - z), abs(far[u] - z)
            above, below = abs(np.float32(over[u]) - z), abs(np.float32(under[u]) - z)
            jumps = (beside > limit) | (before > limit) | (above > limit) | (below > limit)
            gone[u] |= np.uint8(jumps & (luck[u] < loss))
        noise = disparity_noise[(v + at[0]) & mask, at[1] : at[1] + width]
        for u in range(width):
            d = disparity[u] + per_noise * np.float32(noise[u])
            seen[u] = fb / max(grain, np.floor(d * inverse + half) * grain)
        lost = blob[(v + at[4]) & mask, at[5] : at[5] + width]
        line = out[v]
        for u in range(width):
            z = far[u + 2]
            bad = (z < lo) | (z > hi) | (seen[u] > hi) | ((lost[u] | gone[u]) != 0)
            line[u] = np.uint16(0 if bad else np.int32(seen[u] + half))


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _hide(reach: np.ndarray, hidden: np.ndarray) -> None:
    """Mark what the second imager cannot see of a row; ``reach`` is where each pixel lies in its picture.

    Going left, the nearest thing passed so far hides all whose ray to the second imager crosses it.
    """
    width, half = reach.shape[0], np.float32(0.5)
    crossings = 0
    for u in range(width - 1):
        crossings += reach[u] > reach[u + 1] - half
    hidden[:] = 0
    if crossings == 0:
        return
    frontier = np.float32(1e9)
    for u in range(width - 1, -1, -1):
        hidden[u] = reach[u] > frontier - half
        frontier = min(frontier, reach[u])
