"""A clip is made comparable in time: resampled, smoothed, cut to where the person moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from wigwag.errors import InputError
from wigwag.skeleton import Clip


@dataclass(frozen=True, slots=True)
class Preparation:
    """How a clip is made comparable in time before anything is computed from it.

    The same steps run over recorded and live clips, whatever their rate, so that a recogniser trained on
    one camera meets the same kind of clip from another. Each step can be switched off;
    ``Preparation.none()`` is the paper's plain form.

    Raises:
        InputError: If a setting is out of range.
    """

    rate_hz: float | None = 15.0
    """Frames a second after linear resampling; ``None`` keeps the clip's own frames."""
    smooth_s: float = 0.1
    """Standard deviation of the Gaussian that smooths each coordinate over time, seconds; 0: none."""
    trim: float = 0.2
    """Rest at both ends is cut off: frames whose mean joint speed is below this fraction of the clip's
    highest; 0: none."""
    frames: int | None = 32
    """Resample to this many frames in all, whatever the duration; ``None``: keep the duration."""

    def __post_init__(self) -> None:
        """Check the settings."""
        if self.rate_hz is not None and not self.rate_hz > 0:
            raise InputError(f"Preparation.rate_hz must be positive or None, but got {self.rate_hz}.")
        if not self.smooth_s >= 0:
            raise InputError(f"Preparation.smooth_s must be 0 or more seconds, but got {self.smooth_s}.")
        if not 0 <= self.trim < 1:
            raise InputError(f"Preparation.trim must be within 0 and 1, but got {self.trim}.")
        if self.frames is not None and self.frames < 2:
            raise InputError(f"Preparation.frames must be at least 2 or None, but got {self.frames}.")

    @classmethod
    def none(cls) -> Preparation:
        """Return the paper's plain form: the clip's frames as they come."""
        return cls(rate_hz=None, smooth_s=0.0, trim=0.0, frames=None)

    def apply(self, clip: Clip) -> Clip:
        """Return the prepared clip; label, subject and name stay."""
        if self == Preparation.none():
            return clip
        times = clip.times_s
        # A grid at least as fine as the recording's own keeps the smoothing true to its seconds.
        rate = self.rate_hz or (len(clip) - 1) / times[-1]
        grid = _grid(0.0, float(times[-1]), rate)
        joints = _resample(clip.joints, times, grid)
        if self.smooth_s > 0:
            sigma = self.smooth_s * (len(grid) - 1) / times[-1]
            joints = gaussian_filter1d(joints, sigma, axis=0, mode="nearest")
        if self.trim > 0:
            moving = _moving(joints, self.trim)
            joints, grid = joints[moving], grid[moving]
        if self.frames is not None:
            even = np.linspace(grid[0], grid[-1], self.frames)
            joints, grid = _resample(joints, grid, even), even
        stamps = clip.stamps_ns[0] + np.round(grid * 1e9).astype(np.int64)
        return Clip(joints, stamps, clip.label, clip.subject, clip.name)


def _grid(start: float, stop: float, rate_hz: float) -> Float[np.ndarray, " frames"]:
    """Return even times from ``start`` to ``stop``, as near to the rate as both ends allow, 2 at least."""
    return np.linspace(start, stop, max(2, round((stop - start) * rate_hz) + 1))


def _resample(
    joints: Float[np.ndarray, "frames 13 3"],
    times: Float[np.ndarray, " frames"],
    grid: Float[np.ndarray, " samples"],
) -> Float[np.ndarray, "samples 13 3"]:
    """Interpolate linearly between the two frames around each time of the grid."""
    after = np.clip(np.searchsorted(times, grid, side="right"), 1, len(times) - 1)
    weight = (grid - times[after - 1]) / (times[after] - times[after - 1])
    before = joints[after - 1]
    return np.asarray(before + weight[:, None, None] * (joints[after] - before))


def _moving(joints: Float[np.ndarray, "frames 13 3"], fraction: float) -> slice:
    """Find the frames between the first and the last fast one; everything if nothing moves."""
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=2).mean(axis=1)
    fast = np.flatnonzero(speed > fraction * speed.max())
    if len(fast) == 0:
        return slice(0, len(joints))
    return slice(int(fast[0]), int(fast[-1]) + 2)
