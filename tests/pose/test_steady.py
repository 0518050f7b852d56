"""Which poses are smoothed, which are only steadied, and when that begins anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.pose.filter import PoseFilter
from wigwag.pose.steady import Steadier, SteadyConfig
from wigwag.skeleton import Landmark, Pose

RAY = np.array([0.1, 0.0, 1.0]) / np.linalg.norm([0.1, 0.0, 1.0])


def jittering(monocular: bool, frames: int = 90, seed: int = 0) -> list[Pose]:
    """Somebody who stands still 4 m away, whose distance jitters by 2 % of itself."""
    rng = np.random.default_rng(seed)
    body = rng.uniform(-0.4, 0.4, (13, 3)) + 4.0 * RAY
    return [
        Pose(
            body * (1 + rng.normal(0, 0.02)), np.ones(13), k * 33_333_333, np.full(13, 0.4),
            monocular=monocular, distance_sigma_m=0.3,
        )
        for k in range(frames)
    ]  # fmt: skip


def jitter_m(poses: list[Pose]) -> float:
    return float(np.diff([np.linalg.norm(pose.hip_center) for pose in poses[20:]]).std())


def test_without_depth_the_distance_is_smoothed_and_with_depth_nothing_is_delayed() -> None:
    for monocular in (True, False):
        poses, steadier = jittering(monocular), Steadier()
        out = [steadier(pose, 1) for pose in poses]
        if monocular:
            assert jitter_m(out) < 0.3 * jitter_m(poses)
        else:
            for pose, given in zip(out, poses, strict=True):
                np.testing.assert_allclose(pose.joints, given.joints, atol=1e-12)


@pytest.mark.parametrize(("smooth", "smoothed"), [("never", False), ("monocular", True), ("always", True)])
def test_what_is_asked_for_is_done(smooth: str, smoothed: bool) -> None:
    poses, steadier = jittering(True), Steadier(SteadyConfig(smooth=smooth))  # type: ignore[arg-type]
    out = [steadier(pose, 1) for pose in poses]
    assert (jitter_m(out) < 0.5 * jitter_m(poses)) is smoothed


def test_always_is_the_filter_itself() -> None:
    poses, steadier, smooth = jittering(False), Steadier(SteadyConfig(smooth="always")), PoseFilter()
    for pose in poses:
        np.testing.assert_array_equal(steadier(pose, 1).joints, smooth(pose).joints)


@pytest.mark.parametrize("smooth", ["never", "always"])
def test_another_person_a_reset_and_a_gap_begin_anew(smooth: str) -> None:
    low = replace(jittering(False)[0], visibility=np.full(13, 0.1))
    high = low.joints.copy()
    high[Landmark.RIGHT_WRIST, 1] -= 0.8

    def later(number: int, gap_s: float = 0.03, reset: bool = False) -> float:
        steadier = Steadier(SteadyConfig(smooth=smooth))  # type: ignore[arg-type]
        steadier(low, 1)
        if reset:
            steadier.reset()
        pose = steadier(replace(low, joints=high, stamp_ns=low.stamp_ns + round(gap_s * 1e9)), number)
        return float(np.linalg.norm(pose.joints[Landmark.RIGHT_WRIST] - high[Landmark.RIGHT_WRIST]))

    assert later(1) > 0.5
    assert later(2) == pytest.approx(0.0, abs=1e-12)
    assert later(1, gap_s=0.6) == pytest.approx(0.0, abs=1e-12)
    assert later(1, reset=True) == pytest.approx(0.0, abs=1e-12)


def test_depth_that_comes_and_goes_does_not_mix_the_two_ways() -> None:
    steadier, without, with_depth = Steadier(), jittering(True), jittering(False, seed=1)
    for k in range(20):
        steadier(without[k], 1)
    aside = without[20].joints + np.array([0.5, 0.0, 0.0])
    found = steadier(replace(with_depth[20], joints=aside), 1)
    np.testing.assert_allclose(found.joints, aside, atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"smooth": "sometimes"}, "smooth must be one of never, monocular, always, but got 'sometimes'"),
        ({"trusted": (0.8, 0.3)}, "trusted must rise"),
        ({"least_trust": 0.0}, "least_trust must be above 0"),
    ],
)
def test_configuration_faults(changes: dict[str, object], what: str) -> None:
    with pytest.raises(InputError, match=what):
        SteadyConfig(**changes)  # type: ignore[arg-type]
