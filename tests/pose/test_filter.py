"""Laws of the filter: what stands stays, what moves is followed, what jumps or is missing does not enter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.pose.filter import FilterConfig, Jumps, Limbs, PoseFilter
from wigwag.skeleton import Landmark, Pose

WRIST = Landmark.RIGHT_WRIST
SEEN = np.ones(13)
STANDING = np.array([
    [0.0, -0.7, 0.0], [0.18, -0.45, 0.0], [-0.18, -0.45, 0.0], [0.3, -0.2, 0.0], [-0.3, -0.2, 0.0],
    [0.33, 0.05, 0.0], [-0.33, 0.05, 0.0], [0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.11, 0.4, 0.0],
    [-0.11, 0.4, 0.0], [0.12, 0.8, 0.0], [-0.12, 0.8, 0.0],
]) + np.array([0.2, 0.1, 4.0])  # fmt: skip
rates = st.sampled_from([18.0, 25.0, 30.0, 60.0])
sigmas = st.sampled_from([0.0, 0.012, 0.03, 0.1])


def run(
    joints: np.ndarray,
    rate_hz: float = 30.0,
    sigma_m: float = 0.012,
    config: FilterConfig | None = None,
    **fields: object,
) -> list[Pose]:
    smooth = PoseFilter(config)
    stamps = np.round(np.arange(len(joints)) * 1e9 / rate_hz).astype(np.int64)
    pose = Pose(STANDING, SEEN, 0, np.full(13, sigma_m))
    return [
        smooth(replace(pose, joints=j, stamp_ns=int(t), **fields))
        for j, t in zip(joints, stamps, strict=True)
    ]


def places(poses: list[Pose]) -> np.ndarray:
    return np.array([pose.joints for pose in poses])


def swung(rate_hz: float, seconds: float = 2.0, hertz: float = 1.0, seed: int = 0) -> np.ndarray:
    """Somebody who swings both arms in all directions, and sways."""
    t = np.arange(int(seconds * rate_hz))[:, None, None] / rate_hz
    rng = np.random.default_rng(seed)
    arms = np.zeros((1, 13, 3))
    arms[0, 3:7] = rng.uniform(-0.4, 0.4, (4, 3))
    return STANDING + arms * np.sin(2 * np.pi * hertz * t) + [0.05, 0.0, 0.1] * np.sin(2 * np.pi * 0.3 * t)


@settings(max_examples=25, deadline=None)
@given(rate_hz=rates, sigma_m=sigmas, distance_m=st.floats(0.5, 12.0), monocular=st.booleans())
def test_what_stands_still_comes_out_as_it_went_in(
    rate_hz: float, sigma_m: float, distance_m: float, monocular: bool
) -> None:
    still = np.repeat((STANDING + np.array([0, 0, distance_m - 4]))[None], 40, axis=0)
    poses = run(still, rate_hz, sigma_m, monocular=monocular)
    np.testing.assert_allclose(places(poses), still, atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(rate_hz=rates, sigma_m=sigmas, seed=st.integers(0, 10**6), angles=st.tuples(*[st.floats(-3, 3)] * 3))
def test_turning_the_camera_turns_what_comes_out(
    rate_hz: float, sigma_m: float, seed: int, angles: tuple[float, float, float]
) -> None:
    a, b, c = angles
    about_y = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    turn = about_y @ about_x @ about_z
    joints = swung(rate_hz, seed=seed) + np.random.default_rng(seed).normal(0, 0.02, (1, 13, 3))
    straight, turned = run(joints, rate_hz, sigma_m), run(joints @ turn.T, rate_hz, sigma_m)
    np.testing.assert_allclose(places(turned), places(straight) @ turn.T, atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(rate_hz=rates, seed=st.integers(0, 10**6), step=st.tuples(*[st.floats(-3, 3)] * 3))
def test_standing_elsewhere_stands_elsewhere(
    rate_hz: float, seed: int, step: tuple[float, float, float]
) -> None:
    """Where both directions are equally sure; elsewhere the line of sight makes a difference, and should."""
    joints = swung(rate_hz, seed=seed)
    here, there = run(joints, rate_hz), run(joints + np.array(step) + [0, 0, 4], rate_hz)
    np.testing.assert_allclose(places(there), places(here) + np.array(step) + [0, 0, 4], atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(
    rate_hz=rates,
    sigma_m=sigmas,
    velocity=st.tuples(*[st.floats(-1.5, 1.5)] * 3),
)
def test_who_walks_is_followed_without_lag(
    rate_hz: float, sigma_m: float, velocity: tuple[float, float, float]
) -> None:
    t = np.arange(int(2.5 * rate_hz))[:, None, None] / rate_hz
    joints = STANDING + [0, 0, 3] + t * np.array(velocity)
    found = places(run(joints, rate_hz, sigma_m))
    late = int(1.5 * rate_hz)
    np.testing.assert_allclose(found[late:], joints[late:], atol=0.01)


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
@pytest.mark.parametrize("speed_m_s", [0.5, 1.0, 3.0])
def test_an_arm_at_constant_speed_lags_by_less_than_25_ms(rate_hz: float, speed_m_s: float) -> None:
    joints = np.repeat(STANDING[None], int(rate_hz), axis=0)
    joints[:, WRIST, 1] -= speed_m_s * np.arange(len(joints)) / rate_hz
    behind = np.linalg.norm(places(run(joints, rate_hz))[-5:, WRIST] - joints[-5:, WRIST], axis=1)
    assert behind.max() / speed_m_s < 0.025


@settings(max_examples=25, deadline=None)
@given(
    rate_hz=rates,
    sigma_m=sigmas,
    height_m=st.floats(0.05, 0.9),
    ramp_s=st.floats(0.05, 0.5),
    direction=st.sampled_from([0, 1, 2]),
)
def test_an_arm_that_stops_is_not_overshot(
    rate_hz: float, sigma_m: float, height_m: float, ramp_s: float, direction: int
) -> None:
    """However hard it stops: at most 1 % of the way, and it arrives."""
    t = np.arange(int(3 * rate_hz)) / rate_hz
    way = height_m * np.clip((t - 0.5) / ramp_s, 0, 1)
    joints = np.repeat(STANDING[None], len(t), axis=0)
    joints[:, WRIST, direction] += way
    found = places(run(joints, rate_hz, sigma_m))[:, WRIST, direction] - STANDING[WRIST, direction]
    assert found.max() <= 1.01 * height_m + 1e-6
    assert found.min() >= -0.01 * height_m - 1e-6
    assert found[-1] == pytest.approx(height_m, abs=0.03 + 0.5 * sigma_m)


def test_swings_are_neither_late_nor_smaller() -> None:
    joints = swung(30.0, 4.0, hertz=1.5)
    found = places(run(joints))
    wrist, true = found[:, WRIST] - found[:, 7], joints[:, WRIST] - joints[:, 7]
    shifts = range(-3, 4)
    fits = [float((wrist[5 + s : len(wrist) - 5 + s] * true[5:-5]).sum()) for s in shifts]
    assert shifts[int(np.argmax(fits))] == 0
    assert np.ptp(wrist, axis=0) == pytest.approx(np.ptp(true, axis=0), rel=0.05)


@pytest.mark.parametrize(("sigma_m", "left"), [(0.012, 0.85), (0.05, 0.6), (0.1, 0.5)])
def test_noise_at_rest_shrinks_the_more_the_less_sure(sigma_m: float, left: float) -> None:
    rng = np.random.default_rng(3)
    rays = STANDING / np.linalg.norm(STANDING, axis=1, keepdims=True)
    noise = rng.normal(0, sigma_m, (300, 13, 1)) * rays + rng.normal(0, 0.004, (300, 13, 3))
    found = places(run(STANDING + noise, sigma_m=sigma_m)) - STANDING
    depth = (found * rays).sum(axis=-1)[30:]
    assert depth.std() < left * sigma_m
    assert np.diff(depth, axis=0).std() < left * np.diff((noise * rays).sum(axis=-1), axis=0).std()


@settings(max_examples=30, deadline=None)
@given(
    rate_hz=st.sampled_from([25.0, 30.0, 60.0]),
    jump=st.tuples(*[st.floats(-1.5, 1.5)] * 3).filter(lambda j: np.linalg.norm(j) > 0.6),
    landmark=st.integers(0, 12),
)
def test_a_landmark_that_jumps_for_one_frame_does_not_move(
    rate_hz: float, jump: tuple[float, float, float], landmark: int
) -> None:
    joints = np.repeat(STANDING[None], 30, axis=0)
    joints[20, landmark] += jump
    if landmark in (Landmark.LEFT_HIP, Landmark.RIGHT_HIP):
        joints[20, Landmark.LEFT_HIP] = joints[20, Landmark.RIGHT_HIP] = joints[20, landmark]
    poses = run(joints, rate_hz)
    np.testing.assert_allclose(places(poses)[20:], STANDING[None].repeat(10, axis=0), atol=0.02)


def test_a_landmark_that_stays_where_it_jumped_to_is_believed_after_two_frames() -> None:
    joints = np.repeat(STANDING[None], 30, axis=0)
    joints[20:, WRIST, 1] -= 0.8
    off = np.linalg.norm(places(run(joints))[:, WRIST] - joints[:, WRIST], axis=1)
    assert off[20] == pytest.approx(0.8)
    assert off[22:].max() < 0.01


def test_uncertainty_is_kept_with_a_landmark_and_bounded() -> None:
    sure, unsure = np.full(13, 0.02), np.full(13, 0.02)
    unsure[WRIST] = 0.15
    smooth = PoseFilter()
    for k in range(90):
        sigma = unsure if 30 <= k < 60 else sure
        pose = smooth(Pose(STANDING, SEEN, k * 33_000_000, sigma))
        assert np.isfinite(pose.sigma_m).all()
        assert pose.sigma_m.min() >= 0.02 - 1e-9 and pose.sigma_m.max() <= 0.15
    np.testing.assert_allclose(pose.sigma_m, 0.02, atol=0.02)


def test_the_distance_without_depth_is_smoothed_and_the_direction_is_not() -> None:
    """The whole body's distance jitters by 2 %: placed by its size, the body grows and shrinks with it."""
    rng = np.random.default_rng(5)
    scale = 1 + rng.normal(0, 0.02, (200, 1, 1))
    t = np.arange(200)[:, None, None] / 30.0
    true = STANDING + t * [0.3, 0.0, 0.2]
    poses = run(true * scale, sigma_m=0.4, distance_sigma_m=0.3, monocular=True)
    found = places(poses)
    hips = found[:, [7, 8]].mean(axis=1)
    raw = (true * scale)[:, [7, 8]].mean(axis=1)
    jitter = [np.diff(np.linalg.norm(h, axis=1)).std() for h in (hips, raw)]
    assert jitter[0] < 0.25 * jitter[1]
    error = (hips - true[:, [7, 8]].mean(axis=1))[30:]
    assert abs(error[:, 2].mean()) < 0.02
    bearing = hips[30:, 0] / hips[30:, 2] - raw[30:, 0] / raw[30:, 2]
    assert np.abs(bearing).max() < 0.002
    size = np.linalg.norm(found[:, 0] - hips, axis=1)[30:]
    assert size.std() < 0.01
    for pose in poses:
        assert pose.monocular and pose.distance_sigma_m == 0.3
        assert (pose.sigma_m >= 0.3).all()


def test_gaps_and_other_people() -> None:
    low, high = STANDING.copy(), STANDING.copy()
    high[WRIST, 2] -= 0.1
    smooth = PoseFilter()
    first = smooth(Pose(low, SEEN, 0, np.full(13, 0.1)))
    np.testing.assert_array_equal(first.joints, low)
    near = smooth(Pose(high, SEEN, 33_000_000, np.full(13, 0.1)))
    assert 0.0 < np.linalg.norm(near.joints[WRIST] - low[WRIST]) < 0.06
    far = smooth(Pose(high, SEEN, 700_000_000, np.full(13, 0.1)))
    np.testing.assert_allclose(far.joints, high)
    smooth.reset()
    again = smooth(Pose(low, SEEN, 0, np.full(13, 0.1)))
    np.testing.assert_allclose(again.joints, low)


def test_what_is_not_newer_changes_nothing() -> None:
    smooth, other = PoseFilter(), PoseFilter()
    for k, joints in enumerate(swung(30.0, 1.0)):
        pose = Pose(joints, SEEN, k * 33_000_000)
        a, b = smooth(pose), other(pose)
        late = Pose(joints + 1.0, SEEN, (k - 1) * 33_000_000)
        assert other(late) is late
        np.testing.assert_array_equal(a.joints, b.joints)


def test_visibility_that_is_no_number_is_no_measurement_of_anything() -> None:
    seen = SEEN.copy()
    seen[WRIST] = np.nan
    smooth = PoseFilter()
    for k, joints in enumerate(swung(30.0, 1.0)):
        assert np.isfinite(smooth(Pose(joints, seen, k * 33_000_000)).joints).all()


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    rate_hz=rates,
    holes=st.floats(0.0, 0.9),
    broken=st.sampled_from([np.nan, np.inf, -np.inf]),
)
def test_nothing_that_is_not_finite_ever_enters(
    seed: int, rate_hz: float, holes: float, broken: float
) -> None:
    """Whatever is measured, and however little of it: finite places, and a bounded uncertainty."""
    rng = np.random.default_rng(seed)
    config = FilterConfig()
    limbs = Limbs(config)
    sights = np.tile([0.0, 0.0, 1.0], (13, 1))
    joints = swung(rate_hz, 2.0, seed=seed) - [0.2, 0.1, 4.0]
    for points in joints:
        broken_points = points.copy()
        broken_points[rng.random(13) < holes, rng.integers(0, 3)] = broken
        found = limbs.update(broken_points, sights, np.full((2, 13), 0.02), 1 / rate_hz)
        assert np.isfinite(found).all()
        assert np.abs(found).max() < 3.0
        assert (limbs.sigma_m >= 0.019).all() and (limbs.sigma_m <= config.most_sigma_m).all()


def test_a_landmark_in_a_hole_goes_on_a_little_and_becomes_less_sure() -> None:
    limbs = Limbs(FilterConfig())
    sights, sigma = np.tile([0.0, 0.0, 1.0], (13, 1)), np.full((2, 13), 0.012)
    for k in range(30):
        points = np.zeros((13, 3))
        points[WRIST, 0] = k / 30.0  # 1 m/s
        found = limbs.update(points, sights, sigma, 1 / 30)
    at, sure = found[WRIST, 0], limbs.sigma_m[WRIST]
    points[WRIST] = np.nan
    unsure = []
    for _ in range(90):
        found = limbs.update(points, sights, sigma, 1 / 30)
        unsure.append(limbs.sigma_m[WRIST])
    assert 0.05 < found[WRIST, 0] - at < 0.12, "a tenth of a second's way, not three seconds'"
    assert (np.diff([sure, *unsure])[:50] > 0).all()
    assert unsure[-1] == FilterConfig().most_sigma_m
    points[WRIST] = [2.0, 0.0, 0.0]
    limbs.update(points, sights, sigma, 1 / 30)
    found = limbs.update(points, sights, sigma, 1 / 30)
    np.testing.assert_allclose(found[WRIST], points[WRIST], atol=0.02)
    assert limbs.sigma_m[WRIST] < 0.1


def test_a_jump_is_told_from_a_swing_by_its_acceleration() -> None:
    jumps, doubtful = Jumps(1, FilterConfig()), np.array([True])
    swing = 0.5 * np.sin(2 * np.pi * 2.0 * np.arange(60) / 30.0)  # 6 m/s, 79 m/s2
    for x in swing:
        counts, _ = jumps.judge(np.array([[x, 0.0, 0.0]]), doubtful, 1 / 30)
        assert counts[0]
    there = np.array([[swing[-1], 0.0, 0.0]])
    for _ in range(3):
        jumps.judge(there, doubtful, 1 / 30)
    away = there + np.array([0.6, 0.0, 0.0])
    assert not jumps.judge(away, doubtful, 1 / 30)[0][0]
    assert jumps.judge(there, doubtful, 1 / 30)[0][0], "it came back"
    assert not jumps.judge(away, doubtful, 1 / 30)[0][0]
    counts, anew = jumps.judge(away, doubtful, 1 / 30)
    assert counts[0] and anew[0], "it stayed"
    assert jumps.judge(away, ~doubtful, 1 / 30)[0][0], "what may be noise has not jumped"


@pytest.mark.parametrize("name", ["rest_hz", "forget_s", "most_sigma_m"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_configuration_faults(name: str, value: float) -> None:
    with pytest.raises(InputError, match=f"FilterConfig.{name} must be above 0"):
        FilterConfig(**{name: value})
