"""How far off people are who are placed without depth: simulated ones, beside the same by depth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.filter import PoseFilter
from wigwag.pose.monocular import MonocularConfig
from wigwag.pose.sides import SideKeeper
from wigwag.pose.space import InSpace
from wigwag.sim.camera import SimulatedCameraConfig, SimulatedSource
from wigwag.sim.clips import LANDMARK_BIAS
from wigwag.sim.person import Person
from wigwag.skeleton import Landmark, Pose, from_kinect20

_HIPS = [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]
_WAYS = ("depth", "stature stated", "stature unknown")


@dataclass(frozen=True, slots=True)
class MonocularBenchmarkConfig:
    """Who is seen, and from where.

    Raises:
        InputError: If there is nobody to be seen, or no time.
    """

    people: int = 4
    distances_m: tuple[float, ...] = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
    seconds: float = 6.0
    """For each person and distance."""
    seed: int = 0
    """The first person; no training person has a seed this low."""

    def __post_init__(self) -> None:
        """Check that something is measured."""
        if self.people < 1 or not self.seconds > 0 or not self.distances_m:
            raise InputError("The benchmark needs people, distances and seconds, each at least one.")


def measure_monocular(
    config: MonocularBenchmarkConfig | None = None, progress: Callable[[int], None] | None = None
) -> list[dict[str, Any]]:
    """Return one flat record a distance and way of placing, over all people.

    Each frame is looked at once by the network; its body is put into space by depth, by a stated stature and
    by that of an unknown adult, and each is filtered. ``distance_error_*`` is of the middle of the hips along
    the optical axis, as a share of the true one; ``landmark_mm_median`` is of all landmarks, seen from the
    hips; ``within_*_sigma`` is the share of landmarks whose depth lies within what was stated.

    Raises:
        ModelError: If the pose networks are not there and cannot be fetched.
    """
    config = config or MonocularBenchmarkConfig()
    network, rows, done = BlazePose(), [], 0
    for distance_m in config.distances_m:
        pairs: dict[str, list[tuple[Pose, np.ndarray]]] = {way: [] for way in _WAYS}
        frames = 0
        for number in range(config.people):
            frames += _watch(network, config, config.seed + number, distance_m, pairs)
            done += 1
            if progress is not None:
                progress(done)
        rows += [
            {"distance_m": distance_m, "way": way, "people": config.people, "frames": frames}
            | _figures(found, frames)
            for way, found in pairs.items()
        ]
    return rows


def _watch(
    network: BlazePose,
    config: MonocularBenchmarkConfig,
    seed: int,
    distance_m: float,
    pairs: dict[str, list[tuple[Pose, np.ndarray]]],
) -> int:
    """Add the poses of one person beside the truth; return how many frames there were."""
    stature = Person.random(seed).height_m
    by_depth, stated, unknown = InSpace(), InSpace(monocular=MonocularConfig(stature_m=stature)), InSpace()
    filters = {way: PoseFilter() for way in _WAYS}
    sides, frames = SideKeeper(), 0
    network.reset()
    source = SimulatedSource(
        SimulatedCameraConfig(seed=seed, distance_m=distance_m, duration_s=config.seconds)
    )
    source.open()
    while (frame := source.read()) is not None and source.world is not None:
        frames += 1
        body = network.track(frame.rgb)
        if body is None:
            continue
        body = sides(body, frame.stamp_ns)
        truth = source.world.truth
        # Kinect axes and back: the one place that knows which joint stands in for which landmark.
        joints = from_kinect20(truth.camera.to_camera(truth.joints_m) * np.array([-1.0, -1.0, 1.0]))
        joints = joints + LANDMARK_BIAS * stature
        without = type(frame)(frame.rgb, None, frame.intrinsics, frame.stamp_ns)
        for way, place, picture in zip(
            _WAYS, (by_depth, stated, unknown), (frame, without, without), strict=True
        ):
            pose = place(body, picture)
            if pose is not None:
                pairs[way].append((filters[way](pose), joints))
    source.close()
    return frames


def _figures(found: Sequence[tuple[Pose, np.ndarray]], frames: int) -> dict[str, float | None]:
    names = (
        "distance_error_median", "distance_error_p95", "distance_bias", "landmark_mm_median",
        "within_1_sigma", "within_2_sigma",
    )  # fmt: skip
    if not found:
        return {"found": 0.0} | dict.fromkeys(names)
    joints = np.array([pose.joints for pose, _ in found])
    true = np.array([truth for _, truth in found])
    sigma = np.array([pose.sigma_m for pose, _ in found])
    hips, true_hips = (x[:, _HIPS].mean(axis=1, keepdims=True) for x in (joints, true))
    off = hips[:, 0, 2] / true_hips[:, 0, 2] - 1.0
    apart = 1e3 * np.linalg.norm((joints - hips) - (true - true_hips), axis=-1)
    deviations = np.abs(joints - true)[..., 2] / sigma
    values = (
        np.median(np.abs(off)), np.quantile(np.abs(off), 0.95), np.median(off), np.median(apart),
        (deviations <= 1.0).mean(), (deviations <= 2.0).mean(),
    )  # fmt: skip
    figures: dict[str, float | None] = {"found": round(len(found) / frames, 4)}
    return figures | {name: round(float(value), 4) for name, value in zip(names, values, strict=True)}


__all__ = ["MonocularBenchmarkConfig", "measure_monocular"]
