"""A clip is made comparable in time: resampled, smoothed, cut to where the person moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Landmark

_DRIFT_S = 1 / 3
"""Standard deviation of the Gaussian that tells drift from movement, seconds."""

_FASTEST = 3
"""Joints that say how fast a frame is."""

_FLOOR_PERCENTILE = 10
"""Percentile of a clip's speeds that is taken for noise."""


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
    """Rest at both ends is cut off: frames whose fastest joints stay below this fraction of the way from
    the clip's noise floor to its highest speed; 0: none."""
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
        rate = self.rate_hz or (len(clip) - 1) / times[-1]
        grid = np.linspace(0.0, times[-1], max(2, round(times[-1] * rate) + 1))
        rate = (len(grid) - 1) / float(times[-1])  # both ends are kept, so the rate gives a little
        joints = _resample(clip.joints, times, grid)
        if self.smooth_s > 0:
            joints = gaussian_filter1d(joints, self.smooth_s * rate, axis=0, mode="nearest")
        if self.trim > 0:
            moving = _moving(joints, rate, self.trim)
            joints, grid = joints[moving], grid[moving]
        if self.frames is not None:
            even = np.linspace(grid[0], grid[-1], self.frames)
            joints, grid = _resample(joints, grid, even), even
        stamps = clip.stamps_ns[0] + np.round(grid * 1e9).astype(np.int64)
        return Clip(joints, stamps, clip.label, clip.subject, clip.name)


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


def _moving(joints: Float[np.ndarray, "frames 13 3"], rate_hz: float, fraction: float) -> slice:
    """Find the frames between the first and the last fast one; everything if nothing moves.

    What a frame's speed is must survive a drifting camera and noisy depth: the body's slow horizontal
    motion is taken out first (the slow part alone, since the hips' own noise would enter every joint),
    the three fastest joints count, for averaged over all 13 a moving wrist drowns in noise, and speeds
    are measured from the noise floor up.
    """
    hips = (joints[:, Landmark.LEFT_HIP] + joints[:, Landmark.RIGHT_HIP]) / 2
    drift = gaussian_filter1d(hips, _DRIFT_S * rate_hz, axis=0, mode="nearest") * [1.0, 0.0, 1.0]
    speeds = np.linalg.norm(np.diff(joints - drift[:, None, :], axis=0), axis=2)
    speed = np.sort(speeds, axis=1)[:, -_FASTEST:].mean(axis=1)
    floor = np.percentile(speed, _FLOOR_PERCENTILE)
    fast = np.flatnonzero(speed > floor + fraction * (speed.max() - floor))
    if len(fast) == 0:
        return slice(0, len(joints))
    return slice(int(fast[0]), int(fast[-1]) + 2)
