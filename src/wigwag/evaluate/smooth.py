"""What smoothing costs and gains: UTD-MHAD's fast swings and people at rest, with measured noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

from wigwag.datasets.utd_mhad import RATE_HZ, load_skeletons
from wigwag.errors import InputError
from wigwag.pose.filter import PoseFilter
from wigwag.sim.clips import SensorConfig, landmark_noise
from wigwag.skeleton import Landmark, Pose

SWINGS: tuple[str, ...] = ("a1", "a2", "a3", "a5", "a7", "a13", "a14", "a15", "a17", "a18")
"""Swipes, waving, throws, punches and strokes: the fastest wrists of the set."""

JUDGED_ON: tuple[str, ...] = ("s2", "s4", "s6", "s8")
"""The filter's settings were chosen on the other four."""

Smoother = Callable[[Pose], Pose]

_SMOOTH_S = 0.03
"""The Gaussian that takes the Kinect's own jitter out of what counts as the truth."""
_UNSEEN, _GUESS_M = 0.05, 0.06
"""Visibility of heels that are below the picture, and the deviation of the network's guess of them."""
_HEELS = [Landmark.LEFT_HEEL, Landmark.RIGHT_HEEL]
_STILL_S, _SETTLE_S = 3.0, 0.5
_SHIFTS = 8


def unsmoothed() -> Smoother:
    """Return the filter that does nothing."""
    return lambda pose: pose


def by_visibility() -> Smoother:
    """Return wigwag's former rule: what is hardly seen follows slowly, relative to the hips."""
    kept: list[np.ndarray] = []

    def smooth(pose: Pose) -> Pose:
        relative = pose.joints - pose.hip_center
        if kept:
            trust = np.clip((pose.visibility - 0.3) / 0.5, 0.08, 1.0)
            relative = kept[0] + trust[:, None] * (relative - kept[0])
        kept[:] = [relative]
        return Pose(relative + pose.hip_center, pose.visibility, pose.stamp_ns)

    return smooth


FILTERS: dict[str, Callable[[], Smoother]] = {
    "none": unsmoothed,
    "by visibility": by_visibility,
    "PoseFilter": PoseFilter,
}
"""What is compared, by name."""


@dataclass(frozen=True, slots=True)
class SmoothConfig:
    """What is measured.

    Raises:
        InputError: If the distance or a rate is not positive.
    """

    subjects: tuple[str, ...] = JUDGED_ON
    labels: tuple[str, ...] = SWINGS
    rates_hz: tuple[float, ...] = (30.0,)
    distance_m: float = 5.0
    """Where the people are put: depth noise grows with its square."""
    seed: int = 0

    def __post_init__(self) -> None:
        """Check what would otherwise surface far from here."""
        if not self.distance_m > 0 or not all(rate > 0 for rate in self.rates_hz):
            raise InputError(
                "SmoothConfig needs distance_m and rates_hz above 0, but got "
                f"{self.distance_m} and {self.rates_hz}."
            )


def measure_smooth(path: str | Path, config: SmoothConfig | None = None) -> list[dict[str, Any]]:
    """Return one flat record a filter and rate.

    Lag and overshoot are of the faster wrist, seen from the hips, without noise: ``lag_ms_*`` is where the
    cross-correlation of velocities peaks, ``overshoot_*`` how far it swings beyond the true extremes along
    its main direction, as a share of the range, ``speed_overshoot_*`` by what share its greatest speed
    exceeds the true one (0 if it does not). With the noise of ``SensorConfig``, and heels that are guessed:
    ``rms_mm`` against the truth over all landmarks but the heels, ``heel_rms_mm``, and of a person who
    stands still ``rest_rms_mm`` and ``rest_jitter_mm`` (from frame to frame).

    Args:
        path: Folder of ``Skeleton.zip``.
        config: Who, what and how fast.

    Raises:
        DataError: If the skeletons are not there.
    """
    config = config or SmoothConfig()
    loaded = load_skeletons(path, labels=config.labels, subjects=config.subjects)
    rows = []
    for rate_hz in config.rates_hz:
        clips = [_resampled(clip.joints, rate_hz, config.distance_m) for clip in loaded.clips]
        for name, make in FILTERS.items():
            figures = _clean(clips, make, rate_hz) | _noisy(clips, make, rate_hz, config.seed)
            rows.append({"filter": name, "rate_hz": rate_hz, "clips": len(clips)} | figures)
    return rows


def lag_ms(
    true: Float[np.ndarray, "frames 3"], found: Float[np.ndarray, "frames 3"], rate_hz: float
) -> float:
    """Return by how much ``found`` is later than ``true``: the peak of their velocities' correlation.

    Between the frames the peak is that of a parabola through the three highest values.
    """
    a, b = np.diff(true, axis=0), np.diff(found, axis=0)
    m = min(_SHIFTS, (len(a) - 3) // 2)
    middle = a[m : len(a) - m]
    fits = []
    for shift in range(-m, m + 1):
        part = b[m + shift : len(b) - m + shift]
        fits.append(float((middle * part).sum()) / (float(np.linalg.norm(part)) + 1e-12))
    top = int(np.argmax(fits))
    between = 0.0
    if 0 < top < 2 * m:
        low, peak, high = fits[top - 1 : top + 2]
        between = 0.5 * (low - high) / min(low - 2 * peak + high, -1e-15)
    return 1e3 * (top - m + between) / rate_hz


def overshoot(true: Float[np.ndarray, "frames 3"], found: Float[np.ndarray, "frames 3"]) -> float:
    """Return how far ``found`` leaves the range of ``true`` along its main direction, over that range."""
    axis = np.linalg.svd(true - true.mean(axis=0), full_matrices=False)[2][0]
    a, b = true @ axis, found @ axis
    return float(max(b.max() - a.max(), a.min() - b.min(), 0.0) / np.ptp(a))


def _resampled(
    joints: Float[np.ndarray, "frames 13 3"], rate_hz: float, distance_m: float
) -> Float[np.ndarray, "frames 13 3"]:
    smooth = gaussian_filter1d(joints, _SMOOTH_S * RATE_HZ, axis=0, mode="nearest")
    times = np.arange(len(smooth)) / RATE_HZ
    out = np.asarray(CubicSpline(times, smooth, axis=0)(np.arange(0.0, times[-1], 1.0 / rate_hz)))
    out[..., 2] += distance_m - out[0, [Landmark.LEFT_HIP, Landmark.RIGHT_HIP], 2].mean()
    return out


def _run(
    make: Callable[[], Smoother],
    joints: Float[np.ndarray, "frames 13 3"],
    visibility: Float[np.ndarray, 13],
    rate_hz: float,
) -> Float[np.ndarray, "frames 13 3"]:
    """Send a recording through a new filter, each landmark with the deviation that a lifter would state."""
    smooth, out = make(), []
    unseen = 0.075 * (1.0 - visibility)
    for k, place in enumerate(joints):
        sigma = np.sqrt(0.012**2 + (0.00075 * place[:, 2] ** 2) ** 2 + unseen**2)
        out.append(smooth(Pose(place, visibility, round(k * 1e9 / rate_hz), sigma)).joints)
    return np.array(out)


def _clean(clips: Sequence[np.ndarray], make: Callable[[], Smoother], rate_hz: float) -> dict[str, float]:
    lags, overs, speeds = [], [], []
    for true in clips:
        found = _run(make, true, np.ones(13), rate_hz)
        wrists = [_from_hips(true)[:, w] for w in (Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST)]
        side = int(np.argmax([np.ptp(w, axis=0).max() for w in wrists]))
        a, b = wrists[side], _from_hips(found)[:, Landmark.LEFT_WRIST + side]
        lags.append(lag_ms(a, b, rate_hz))
        overs.append(overshoot(a, b))
        fastest = [float(np.linalg.norm(np.diff(w, axis=0), axis=1).max()) for w in (a, b)]
        speeds.append(max(fastest[1] / fastest[0] - 1.0, 0.0))
    return _spread("lag_ms", lags) | _spread("overshoot", overs) | _spread("speed_overshoot", speeds)


def _noisy(
    clips: Sequence[np.ndarray], make: Callable[[], Smoother], rate_hz: float, seed: int
) -> dict[str, float]:
    rng = np.random.default_rng([0x5300, seed])
    sensor = SensorConfig(rate_hz=rate_hz)
    seen = np.ones(13)
    seen[_HEELS] = _UNSEEN
    moving, heels, rest, jitter = [], [], [], []
    for true in clips:
        still = np.repeat(true[:1], round(_STILL_S * rate_hz), axis=0)
        for place in (true, still):
            noise = landmark_noise(rng, place[..., 2], sensor)
            noise[:, _HEELS] += rng.normal(0.0, _GUESS_M, (len(place), 2, 3))
            error = _run(make, place + noise, seen, rate_hz) - place
            own = np.delete(error, _HEELS, axis=1)
            if place is still:
                own = own[round(_SETTLE_S * rate_hz) :]
                rest.append(np.square(own).sum(axis=-1).ravel())
                jitter.append(np.square(np.diff(own, axis=0)).sum(axis=-1).ravel())
            else:
                moving.append(np.square(own).sum(axis=-1).ravel())
                heels.append(np.square(error[:, _HEELS]).sum(axis=-1).ravel())
    parts = {"rms_mm": moving, "heel_rms_mm": heels, "rest_rms_mm": rest, "rest_jitter_mm": jitter}
    return {
        name: round(1e3 * float(np.sqrt(np.concatenate(squares).mean())), 2)
        for name, squares in parts.items()
    }


def _from_hips(joints: Float[np.ndarray, "frames 13 3"]) -> Float[np.ndarray, "frames 13 3"]:
    hips = joints[:, [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean(axis=1, keepdims=True)
    return np.asarray(joints - hips)


def _spread(name: str, values: Sequence[float]) -> dict[str, float]:
    return {
        f"{name}_median": round(float(np.median(values)), 4),
        f"{name}_p95": round(float(np.quantile(values, 0.95)), 4),
        f"{name}_max": round(float(np.max(values)), 4),
    }


__all__ = ["FILTERS", "JUDGED_ON", "SWINGS", "SmoothConfig", "lag_ms", "measure_smooth", "overshoot"]
