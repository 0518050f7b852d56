"""How well landmarks are lifted: UTD-MHAD's depth against its skeletons."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, UInt16

from wigwag.camera.frame import Intrinsics
from wigwag.datasets.utd_mhad import DEPTH_DELAY_FRAMES, DEPTH_INTRINSICS, load_depth, load_skeletons
from wigwag.errors import DataError, InputError
from wigwag.pose.lift import STATISTICS, SURFACE_TO_JOINT_MM, LiftConfig, Lifter, Statistic
from wigwag.skeleton import LANDMARKS

FITTED_ON: tuple[str, ...] = ("s1", "s3", "s5", "s7")
"""On these people the statistic and the surface offsets were chosen; figures are given for the others."""

JOINTS: dict[str, tuple[int, ...]] = {"nose": (0,)} | {
    joint: tuple(i for i, name in enumerate(LANDMARKS) if name.endswith(joint))
    for joint in ("shoulder", "elbow", "wrist", "hip", "knee", "heel")
}
"""Joint type to its landmarks, left and right together."""

_TIMED_EVERY = 10
"""One in so many frames is timed as well."""

BEYOND_MM = 150.0
"""An error beyond this is no noise: another surface was measured."""


@dataclass(slots=True)
class LiftErrors:
    """Lifted depth less the skeleton's, frame by frame, for one statistic."""

    error_mm: Float[np.ndarray, "frames 13"]
    """Along the optical axis, the shipped surface offset applied."""
    measured: Bool[np.ndarray, "frames 13"]
    """False: no depth; the error is that of the filled-in landmark and counts for the coverage only."""
    sigma_mm: Float[np.ndarray, "frames 13"]
    """One standard deviation as the lifter states it."""
    subjects: np.ndarray
    """Who, a frame."""


@dataclass(slots=True)
class LiftMeasurement:
    """All statistics over all frames."""

    errors: dict[Statistic, LiftErrors]
    left_out: list[tuple[str, str]] = field(default_factory=list)
    knock_out: float = 0.0
    """Share of the depth pixels that were taken away."""
    ms_39_landmarks: float | None = None
    """Median processor time of lifting 39 landmarks; see :func:`time_lift`."""

    def rows(self, statistic: Statistic) -> list[dict[str, Any]]:
        """Return one flat record a landmark (and a joint type), for the people not fitted on and for all.

        ``median_abs_mm`` and ``beyond_150_mm`` (a share, 0 to 1) are over measured landmarks with the
        shipped offset ``offset_mm`` applied; ``bias_mm`` is the signed median that is left;
        ``refit_offset_mm`` is what fitting the offset on ``FITTED_ON`` gives now; ``missing`` is the
        share of frames in which the landmark was not measured. ``within_1_sigma`` and ``within_2_sigma`` are
        the shares of all errors, filled-in landmarks' too, within one and two of the stated standard
        deviations (of Gaussian errors 0.68 and 0.95 are), ``sigma_mm`` is their median.
        """
        errors = self.errors[statistic]
        fitted = np.isin(errors.subjects, FITTED_ON)
        groups = {
            "s2 s4 s6 s8 (not fitted on)": ~fitted,
            "all": np.ones_like(fitted),
        }
        names: dict[str, tuple[int, ...]] = JOINTS | {name: (i,) for i, name in enumerate(LANDMARKS)}
        rows = []
        for group, chosen in groups.items():
            if not chosen.any():
                continue
            for name, indices in names.items():
                rows.append(
                    {"landmark": name}
                    | _row(errors, chosen, indices)
                    | {
                        "offset_mm": float(SURFACE_TO_JOINT_MM[statistic][indices[0]]),
                        "refit_offset_mm": _refit(errors, fitted, statistic, indices),
                        "subjects": group,
                        "statistic": statistic,
                        "knock_out": self.knock_out,
                        "ms_39_landmarks": self.ms_39_landmarks,
                    }
                )
        return rows


def measure_lift(
    path: str | Path,
    statistics: Sequence[Statistic] = STATISTICS,
    progress: Callable[[int], None] | None = None,
    *,
    knock_out: float = 0.0,
    seed: int = 0,
) -> LiftMeasurement:
    """Lift the skeleton's landmarks through every depth recording and compare the depths.

    Depth frame t stands beside skeleton frame t - 2, projected into the picture. The landmarks' places in
    the picture are thus right up to the two streams' jitter, and what is measured is lifting alone.

    Args:
        path: The folder of ``Skeleton.zip`` and ``Depth_56_clips.zip``.
        statistics: Which to compare.
        progress: Called with the number of recordings done.
        knock_out: Share of the depth pixels that are set to 0 at random, 0 to 1 (exclusive).
        seed: Chooses them.

    Raises:
        InputError: If ``knock_out`` is out of range.
        DataError: If skeletons or depth are not there, or no recording has both.
    """
    if not 0.0 <= knock_out < 1.0:
        raise InputError(f"knock_out must be a share from 0 to below 1, but got {knock_out}.")
    rng = np.random.default_rng([0x0D27, seed])
    lifted_ms: list[float] = []
    found: dict[Statistic, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {s: [] for s in statistics}
    lifters = {s: Lifter(LiftConfig(statistic=s)) for s in statistics}
    subjects: list[str] = []
    left_out: list[tuple[str, str]] = []
    skeletons = load_skeletons(path)
    joints = {clip.name: clip.joints for clip in skeletons.clips}
    reasons = {name.removesuffix("_skeleton.mat"): (name, why) for name, why in skeletons.left_out}
    for done, depth in enumerate(load_depth(path, left_out=left_out), start=1):
        if depth.name not in joints:
            left_out.append(reasons.get(depth.name, (f"{depth.name}_skeleton.mat", "missing")))
            continue
        pairs = min(len(depth) - DEPTH_DELAY_FRAMES, len(joints[depth.name]))
        for t in range(pairs):
            truth = joints[depth.name][t]
            points = DEPTH_INTRINSICS.project(truth)
            picture = depth.depth_mm[t + DEPTH_DELAY_FRAMES]
            if knock_out > 0.0:
                picture = np.where(rng.random(picture.shape) < knock_out, 0, picture).astype(np.uint16)
            for statistic, lifter in lifters.items():
                found[statistic].append(_compared(lifter, points, picture, truth))
            if t % _TIMED_EVERY == 0:
                lifted_ms.append(time_lift(points, picture))
            subjects.append(depth.subject)
        if progress is not None:
            progress(done)
    if not subjects:
        raise DataError(f"{path}: no recording has both depth and skeleton; {len(left_out)} left out.")
    who = np.array(subjects)
    errors = {}
    for statistic, rows in found.items():
        error_mm, measured, sigma_mm = (np.array(column) for column in zip(*rows, strict=True))
        errors[statistic] = LiftErrors(error_mm, measured, sigma_mm, who)
    return LiftMeasurement(errors, left_out, knock_out, round(float(np.median(lifted_ms)), 4))


def time_lift(points_px: Float[np.ndarray, "13 2"], depth_mm: UInt16[np.ndarray, "240 320"]) -> float:
    """Return the processor time of lifting 39 landmarks in a picture of 640x480, milliseconds.

    BlazePose has 33, wigwag lifts 13: three times these bound the time for all 33 from above. UTD-MHAD's
    pictures are doubled in size, so that windows hold as many pixels as a drone's camera gives.
    """
    depth = depth_mm.repeat(2, axis=0).repeat(2, axis=1)
    k = DEPTH_INTRINSICS
    doubled = Intrinsics(2 * k.fx, 2 * k.fy, 2 * k.cx + 0.5, 2 * k.cy + 0.5, 2 * k.width, 2 * k.height)
    points, seen, lifter = 2 * points_px + 0.5, np.ones(len(points_px)), Lifter()
    lifter(points, seen, depth, doubled)
    began = time.thread_time()
    for _ in range(3):
        lifter(points, seen, depth, doubled)
    return 1e3 * (time.thread_time() - began)


def _compared(
    lifter: Lifter,
    points: Float[np.ndarray, "13 2"],
    picture: UInt16[np.ndarray, "height width"],
    truth: Float[np.ndarray, "13 3"],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return error, whether measured, and stated deviation of each landmark, millimetres."""
    lifted = lifter(points, np.ones(len(points)), picture, DEPTH_INTRINSICS)
    if lifted is None:
        nothing = np.full(len(points), np.nan)
        return nothing, np.zeros(len(points), dtype=bool), nothing
    return (lifted.points_m[:, 2] - truth[:, 2]) * 1e3, lifted.measured, lifted.sigma_m * 1e3


def _row(errors: LiftErrors, chosen: Bool[np.ndarray, " frames"], indices: tuple[int, ...]) -> dict[str, Any]:
    measured = errors.measured[chosen][:, indices]
    values = errors.error_mm[chosen][:, indices][measured]
    some = len(values) > 0
    error, sigma = (column[chosen][:, indices].ravel() for column in (errors.error_mm, errors.sigma_mm))
    stated = np.isfinite(error)
    off = np.abs(error[stated]) / sigma[stated]
    return {
        "median_abs_mm": round(float(np.median(np.abs(values))), 2) if some else None,
        "bias_mm": round(float(np.median(values)), 2) if some else None,
        "beyond_150_mm": round(float(np.mean(np.abs(values) > BEYOND_MM)), 5) if some else None,
        "missing": round(float(1.0 - measured.mean()), 5),
        "sigma_mm": round(float(np.median(sigma[stated])), 2) if len(off) else None,
        "within_1_sigma": round(float(np.mean(off <= 1.0)), 4) if len(off) else None,
        "within_2_sigma": round(float(np.mean(off <= 2.0)), 4) if len(off) else None,
        "frames": int(chosen.sum()),
    }


def _refit(
    errors: LiftErrors,
    fitted: Bool[np.ndarray, " frames"],
    statistic: Statistic,
    indices: tuple[int, ...],
) -> float | None:
    """Fit the constant offset of a joint type, both sides together, on the people meant for that."""
    joint = next(group for group in JOINTS.values() if indices[0] in group)
    values = errors.error_mm[fitted][:, joint][errors.measured[fitted][:, joint]]
    if not len(values):
        return None
    return round(SURFACE_TO_JOINT_MM[statistic][joint[0]] - float(np.median(values)), 1)


__all__ = ["BEYOND_MM", "FITTED_ON", "JOINTS", "LiftErrors", "LiftMeasurement", "measure_lift", "time_lift"]
