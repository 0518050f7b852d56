"""Where in a recording the movement is: the truth about onset and end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline, PchipInterpolator

from wigwag.errors import InputError
from wigwag.evaluate.stream.body import activity
from wigwag.skeleton import Clip

MOVING_M_S = 0.20
"""Slower than this is no movement, whatever the recording's peak."""

MOVING_SHARE = 0.10
"""Nor is what is slower than this share of the recording's top speed (its 95th percentile)."""

LULL_S = 0.35
"""A lull this long parts a movement from what comes before or after it ..."""

STRAY_SHARE = 0.05
"""... if that is shorter in path than this share of all: somebody shifts their weight before they begin."""


def movement(clip: Clip) -> tuple[float, float]:
    """Return when a recorded movement begins and ends, seconds since the clip's first frame.

    It begins in the first frame in which the three fastest landmarks (relative to the hips sideways and in
    depth, smoothed by 0.08 s) are faster on average than 0.2 m/s and than a tenth of the recording's top
    speed, and ends in the last. Short stray movements before and after a lull are left off.

    Raises:
        InputError: If nobody moves in the clip.
    """
    rate_hz = (len(clip) - 1) / clip.duration_s
    times = np.arange(len(clip)) / rate_hz
    speed = activity(resampled(clip, times), rate_hz)
    limit = max(MOVING_M_S, MOVING_SHARE * float(np.percentile(speed, 95)))
    runs = _runs(speed > limit, round(LULL_S * rate_hz))
    if not runs:
        raise InputError(f"{clip.name}: nobody moves; no landmark gets faster than {limit:.2f} m/s.")
    paths = [float(speed[first : last + 1].sum()) for first, last in runs]
    least = STRAY_SHARE * sum(paths)
    while len(runs) > 1 and min(paths[0], paths[-1]) < least:
        end = 0 if paths[0] < paths[-1] else -1
        del runs[end], paths[end]
    return float(times[runs[0][0]]), float(times[runs[-1][1]])


def moves(clip: Clip) -> bool:
    """Say whether anybody moves in a clip."""
    try:
        movement(clip)
    except InputError:
        return False
    return True


def cut_to_movement(clip: Clip, margin_s: float = 0.05) -> Clip:
    """Return a recording without the rest before and after its movement.

    Raises:
        InputError: If nobody moves in it.
    """
    onset_s, end_s = movement(clip)
    inside = (clip.times_s >= onset_s - margin_s) & (clip.times_s <= end_s + margin_s)
    stamps = clip.stamps_ns[inside]
    return replace(clip, joints=clip.joints[inside], stamps_ns=stamps - stamps[0])


def resampled(clip: Clip, times_s: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 13 3"]:
    """Return a clip's joints at other times by a cubic spline; without overshoot where time is irregular.

    Args:
        clip: Metres.
        times_s: Seconds since its first frame; what lies outside takes the nearest end.
    """
    own = clip.times_s
    steps = np.diff(own)
    at = np.clip(times_s, own[0], own[-1])
    if len(own) > 3 and float(steps.max()) < 1.5 * float(np.median(steps)):
        return np.asarray(CubicSpline(own, clip.joints, axis=0)(at))
    return np.asarray(PchipInterpolator(own, clip.joints, axis=0)(at))


def _runs(active: np.ndarray, gap: int) -> list[tuple[int, int]]:
    """Return the first and last index of each run of true values; runs closer than ``gap`` are one."""
    runs: list[tuple[int, int]] = []
    for index in np.flatnonzero(active):
        if runs and index - runs[-1][1] <= gap:
            runs[-1] = (runs[-1][0], int(index))
        else:
            runs.append((int(index), int(index)))
    return runs


__all__ = [
    "LULL_S", "MOVING_M_S", "MOVING_SHARE", "STRAY_SHARE", "cut_to_movement", "movement", "moves",
    "resampled",
]  # fmt: skip
