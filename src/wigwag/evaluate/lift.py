"""How well landmarks are lifted: UTD-MHAD's depth against its skeletons."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from wigwag.datasets.utd_mhad import DEPTH_DELAY_FRAMES, DEPTH_INTRINSICS, load_depth, load_skeletons
from wigwag.errors import DataError
from wigwag.pose.lift import STATISTICS, SURFACE_TO_JOINT_MM, LiftConfig, Lifter, Statistic
from wigwag.skeleton import LANDMARKS

FITTED_ON: tuple[str, ...] = ("s1", "s3", "s5", "s7")
"""On these people the statistic and the surface offsets were chosen; figures are given for the others."""

JOINTS: dict[str, tuple[int, ...]] = {"nose": (0,)} | {
    joint: tuple(i for i, name in enumerate(LANDMARKS) if name.endswith(joint))
    for joint in ("shoulder", "elbow", "wrist", "hip", "knee", "heel")
}
"""Joint type to its landmarks, left and right together."""

BEYOND_MM = 150.0
"""An error beyond this is no noise: another surface was measured."""


@dataclass(slots=True)
class LiftErrors:
    """Lifted depth less the skeleton's, frame by frame, for one statistic."""

    error_mm: Float[np.ndarray, "frames 13"]
    """Along the optical axis, the shipped surface offset applied."""
    measured: Bool[np.ndarray, "frames 13"]
    """False: no depth; the error is that of the filled-in landmark and does not count."""
    subjects: np.ndarray
    """Who, a frame."""


@dataclass(slots=True)
class LiftMeasurement:
    """All statistics over all frames."""

    errors: dict[Statistic, LiftErrors]
    left_out: list[tuple[str, str]] = field(default_factory=list)

    def rows(self, statistic: Statistic) -> list[dict[str, Any]]:
        """Return one flat record a landmark (and a joint type), for the people not fitted on and for all.

        ``median_abs_mm`` and ``beyond_150_mm`` (a share, 0 to 1) are over measured landmarks with the
        shipped offset ``offset_mm`` applied; ``bias_mm`` is the signed median that is left;
        ``refit_offset_mm`` is what fitting the offset on ``FITTED_ON`` gives now; ``missing`` is the
        share of frames in which the landmark was not measured.
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
                    }
                )
        return rows


def measure_lift(
    path: str | Path,
    statistics: Sequence[Statistic] = STATISTICS,
    progress: Callable[[int], None] | None = None,
) -> LiftMeasurement:
    """Lift the skeleton's landmarks through every depth recording and compare the depths.

    Depth frame t stands beside skeleton frame t - 2, projected into the picture. The landmarks' places in
    the picture are thus right up to the two streams' jitter, and what is measured is lifting alone.

    Args:
        path: The folder of ``Skeleton.zip`` and ``Depth_56_clips.zip``.
        statistics: Which to compare.
        progress: Called with the number of recordings done.

    Raises:
        DataError: If skeletons or depth are not there, or no recording has both.
    """
    errors: dict[Statistic, list[np.ndarray]] = {s: [] for s in statistics}
    measured: dict[Statistic, list[np.ndarray]] = {s: [] for s in statistics}
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
            for statistic, lifter in lifters.items():
                lifted = lifter(points, np.ones(len(points)), picture, DEPTH_INTRINSICS)
                if lifted is None:
                    errors[statistic].append(np.full(len(points), np.nan))
                    measured[statistic].append(np.zeros(len(points), dtype=bool))
                    continue
                errors[statistic].append((lifted.points_m[:, 2] - truth[:, 2]) * 1e3)
                measured[statistic].append(lifted.measured)
            subjects.append(depth.subject)
        if progress is not None:
            progress(done)
    if not subjects:
        raise DataError(f"{path}: no recording has both depth and skeleton; {len(left_out)} left out.")
    who = np.array(subjects)
    return LiftMeasurement(
        {s: LiftErrors(np.array(errors[s]), np.array(measured[s]), who) for s in statistics}, left_out
    )


def _row(errors: LiftErrors, chosen: Bool[np.ndarray, " frames"], indices: tuple[int, ...]) -> dict[str, Any]:
    measured = errors.measured[chosen][:, indices]
    values = errors.error_mm[chosen][:, indices][measured]
    some = len(values) > 0
    return {
        "median_abs_mm": round(float(np.median(np.abs(values))), 2) if some else None,
        "bias_mm": round(float(np.median(values)), 2) if some else None,
        "beyond_150_mm": round(float(np.mean(np.abs(values) > BEYOND_MM)), 5) if some else None,
        "missing": round(float(1.0 - measured.mean()), 5),
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


__all__ = ["BEYOND_MM", "FITTED_ON", "JOINTS", "LiftErrors", "LiftMeasurement", "measure_lift"]
