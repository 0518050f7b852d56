"""Without depth: geometry that is exact when the network is right, and honest when it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.playback import Playback
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body, Point
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.pose.monocular import NETWORK_STATURE_M, MonocularConfig, MonocularPlacer, Placed, towards
from wigwag.pose.space import InSpace
from wigwag.sim.camera import SimulatedCameraConfig, SimulatedSource
from wigwag.sim.person import Person
from wigwag.skeleton import Landmark, from_blazepose33

CAMERA = Intrinsics()
LIKE_THE_NETWORK = MonocularConfig(stature_m=NETWORK_STATURE_M)
LEAN = 0.2


def standing(seed: int = 0) -> np.ndarray:
    """33 landmarks around the middle of the hips, metres, facing the camera, in some pose of the arms."""
    points = np.zeros((33, 3))
    points[:11] = (0.0, -0.62, -0.08)
    points[[7, 8], 0] = (0.08, -0.08)
    for left, side, down in ((11, 0.17, -0.46), (13, 0.3, -0.2), (15, 0.35, 0.05), (17, 0.36, 0.1),
                             (19, 0.36, 0.12), (21, 0.34, 0.1), (23, 0.11, 0.0), (25, 0.12, 0.4),
                             (27, 0.12, 0.78), (29, 0.12, 0.82), (31, 0.15, 0.83)):  # fmt: skip
        points[left] = (side, down, 0.0)
        points[left + 1] = (-side, down, 0.0)
    rng = np.random.default_rng(seed)
    points[13:23] += rng.uniform(-0.25, 0.25, (10, 3))
    points[25:] += rng.uniform(-0.05, 0.05, (8, 3))
    return points


def seen(
    points: np.ndarray, hips_m: tuple[float, float, float], scale: float = 1.0, **fields: object
) -> Body:
    """What a perfect network says: pixels of the scaled body, metres of its own size, and its usual lean."""
    at = np.array(hips_m)
    true = scale * points + at
    world = points @ towards(at)
    trunk = world[[11, 12]].mean(axis=0)
    # Taking the lean out lengthens the trunk a little: find the leaning trunk that becomes this one.
    length = np.linalg.norm(trunk)
    for _ in range(60):
        length = np.linalg.norm(trunk - [0.0, 0.0, LEAN * length])
    world = world.copy()
    world[:23, 2] -= LEAN * length
    body = Body(CAMERA.project(true), np.ones(33), world, 1.0, 0.9)
    return replace(body, **fields)


def place(body: Body, config: MonocularConfig = LIKE_THE_NETWORK) -> Placed:
    placed = MonocularPlacer(config)(body, CAMERA)
    assert placed is not None
    return placed


places = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.2, 0.3), st.floats(1.5, 10.0)).map(
    lambda at: (at[0] * at[2], at[1] * at[2], at[2])
)


@settings(max_examples=50, deadline=None)
@given(at=places, seed=st.integers(0, 10**6), scale=st.floats(0.8, 1.25))
def test_a_right_network_gives_the_right_place_for_any_stature(
    at: tuple[float, float, float], seed: int, scale: float
) -> None:
    points = standing(seed)
    body = seen(points, at, scale)
    placed = place(body, MonocularConfig(stature_m=scale * NETWORK_STATURE_M))
    np.testing.assert_allclose(placed.points_m, from_blazepose33(scale * points + np.array(at)), atol=1e-6)
    assert placed.distance_m == pytest.approx(at[2])


@settings(max_examples=20, deadline=None)
@given(at=places, stature_m=st.floats(1.0, 2.0))
def test_twice_the_stature_is_twice_as_far(at: tuple[float, float, float], stature_m: float) -> None:
    body = seen(standing(), at)
    once, twice = (place(body, MonocularConfig(stature_m=s)) for s in (stature_m, 1.25 * stature_m))
    np.testing.assert_allclose(twice.points_m, 1.25 * once.points_m, rtol=1e-9)


@settings(max_examples=20, deadline=None)
@given(at=places, seed=st.integers(0, 10**6))
def test_every_landmark_stays_on_the_ray_of_its_pixel(at: tuple[float, float, float], seed: int) -> None:
    rng = np.random.default_rng(seed)
    body = seen(standing(seed), at)
    body = replace(body, points_px=body.points_px + rng.normal(0, 3, (33, 2)))
    placed = place(body)
    np.testing.assert_allclose(CAMERA.project(placed.points_m), from_blazepose33(body.points_px), atol=1e-6)


def test_landmarks_out_of_the_picture_hardly_count() -> None:
    """At 1.6 m the legs are below the edge, and the network guesses them a quarter too short."""
    points, at = standing(), (0.1, 0.25, 1.6)
    body = seen(points, at)
    below = body.points_px[:, 1] >= CAMERA.height
    assert below[25:].all()
    pixels, world = body.points_px.copy(), body.world_m.copy()
    hips = pixels[[23, 24]].mean(axis=0)
    pixels[25:] = hips + 0.75 * (pixels[25:] - hips)
    pixels[25:, 1] = np.maximum(pixels[25:, 1], CAMERA.height)
    world[25:] *= 0.9
    guessed = replace(
        body, points_px=pixels, world_m=world, visibility=np.where(np.arange(33) >= 25, 0.2, 1.0)
    )
    assert place(guessed).distance_m == pytest.approx(1.6, rel=0.01)


@pytest.mark.parametrize("wrong", [[15], [15, 16, 19, 20], [7, 8, 0, 1, 2, 3, 4, 5, 6]])
def test_some_wrong_landmarks_pull_little(wrong: list[int]) -> None:
    body = seen(standing(), (0.0, 0.1, 4.0))
    pixels = body.points_px.copy()
    pixels[wrong] += [80.0, -60.0]
    assert place(replace(body, points_px=pixels)).distance_m == pytest.approx(4.0, rel=0.04)


def test_the_same_person_at_the_edge_is_as_far() -> None:
    """What the network sees is turned towards the person: at 25 degrees that is several per cent."""
    middle, edge = (0.0, 0.1, 4.0), (1.9, 0.1, 4.0)
    assert place(seen(standing(), edge)).distance_m == pytest.approx(4.0, rel=1e-6)
    flat = replace(seen(standing(), edge), world_m=seen(standing(), middle).world_m)
    assert abs(place(flat).distance_m - 4.0) > 0.0


def test_uncertainty_is_stated_and_smaller_for_a_stated_stature() -> None:
    body = seen(standing(), (0.0, 0.1, 4.0))
    unknown, known = place(body, MonocularConfig()), place(body, MonocularConfig(stature_m=1.7))
    assert unknown.distance_sigma_m / unknown.distance_m == pytest.approx(0.077, abs=0.005)
    assert known.distance_sigma_m / known.distance_m == pytest.approx(0.05)
    np.testing.assert_allclose(unknown.points_m, known.points_m)
    for placed in (unknown, known):
        assert (placed.sigma_m > placed.distance_sigma_m).all()
        assert placed.sigma_m[Landmark.LEFT_WRIST] > placed.sigma_m[Landmark.LEFT_HIP]
    hidden = np.where(np.arange(33) == Point.LEFT_WRIST, 0.1, 1.0)
    unseen = place(replace(body, visibility=hidden))
    assert unseen.sigma_m[Landmark.LEFT_WRIST] > unseen.sigma_m[Landmark.RIGHT_WRIST]
    assert unseen.visibility[Landmark.LEFT_WRIST] == 0.1


@pytest.mark.parametrize(
    "spoilt",
    [
        {"world_m": np.full((33, 3), np.nan)},
        {"points_px": np.full((33, 2), np.inf)},
        {"visibility": np.zeros(33)},
        {"visibility": np.full(33, np.nan)},
        {"world_m": np.zeros((33, 3))},
        {"points_px": np.full((33, 2), 300.0)},
        {"points_px": np.full((33, 2), -500.0)},
    ],
)
def test_what_does_not_say_where_somebody_stands_is_none(spoilt: dict[str, np.ndarray]) -> None:
    body = replace(seen(standing(), (0.0, 0.1, 4.0)), **spoilt)
    assert MonocularPlacer()(body, CAMERA) is None


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_whatever_the_network_says_what_comes_out_is_finite_and_before_the_camera(seed: int) -> None:
    rng = np.random.default_rng(seed)
    body = Body(
        rng.uniform(-200, 800, (33, 2)),
        rng.random(33),
        rng.normal(0, rng.uniform(0.01, 2.0), (33, 3)),
        1.0,
        0.9,
    )
    placed = MonocularPlacer()(body, CAMERA)
    if placed is not None:
        assert np.isfinite(placed.points_m).all() and (placed.points_m[:, 2] > 0).all()
        assert np.isfinite(placed.sigma_m).all() and (placed.sigma_m > 0).all()


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"stature_m": 17.0}, "MonocularConfig.stature_m must lie within 0.5 and 2.5 m, but got 17.0"),
        ({"stature_m": float("nan")}, "MonocularConfig.stature_m must lie within"),
        ({"average_m": 0.0}, "MonocularConfig.average_m must lie within"),
        ({"average_spread_m": -0.1}, "MonocularConfig.average_spread_m must lie within 0 and 1"),
        ({"placing_spread": 1.0}, "MonocularConfig.placing_spread must lie within 0 and 1"),
    ],
)
def test_configuration_faults(fields: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        MonocularConfig(**fields)


def frame(depth_mm: int | None, k: int = 0) -> Frame:
    depth = None if depth_mm is None else np.full((480, 640), depth_mm, np.uint16)
    return Frame(np.zeros((480, 640, 3), np.uint8), depth, CAMERA, k * 33_000_000)


def test_a_camera_without_depth_gives_marked_poses_and_one_with_depth_does_not() -> None:
    body = seen(standing(), (0.0, 0.1, 4.0))
    space = InSpace(monocular=LIKE_THE_NETWORK)
    without, with_depth = space(body, frame(None, 7)), space(body, frame(4000, 7))
    assert without is not None and with_depth is not None
    assert (without.monocular, with_depth.monocular) == (True, False)
    assert without.stamp_ns == with_depth.stamp_ns == 7 * 33_000_000
    assert without.distance_sigma_m == pytest.approx(0.2, rel=0.01) and with_depth.distance_sigma_m == 0.0
    assert (without.sigma_m > 3 * with_depth.sigma_m).all()


def test_depth_that_shows_nothing_is_a_fault_and_no_reason_to_guess() -> None:
    body = seen(standing(), (0.0, 0.1, 4.0))
    assert InSpace()(body, frame(0)) is None
    asked = InSpace(monocular=MonocularConfig(when_depth_fails=True))(body, frame(0))
    assert asked is not None and asked.monocular


class Same:
    """Gives out the same body for ever."""

    def __init__(self, body: Body) -> None:
        self.body = body

    def track(self, rgb: np.ndarray) -> Body | None:
        return self.body

    def reset(self) -> None:
        pass


def alone(monocular: MonocularConfig) -> PoseConfig:
    return replace(PoseConfig.alone(), monocular=monocular)


def test_the_estimator_follows_without_depth() -> None:
    estimate = PoseEstimator(
        alone(LIKE_THE_NETWORK),
        Same(seen(standing(), (0.0, 0.1, 4.0))),
    )
    for k in range(5):
        pose = estimate(frame(None, k))
        assert pose is not None and pose.monocular
        assert pose.hip_center[2] == pytest.approx(4.0, abs=1e-3)
    assert estimate(frame(0, 5)) is None, "depth of zeros in between is a fault"


@pytest.mark.parametrize("distance_m", [3.0, 6.0])
def test_simulated_people_stand_where_they_stand(blazepose: BlazePose, distance_m: float) -> None:
    """From pixels, without depth, stature stated: never off by 3 stated deviations, and steady.

    One person's errors last (this one seems 9 % too near for half a second), so that two seconds cannot say
    whether two deviations hold 95 %.
    """
    stature = MonocularConfig(stature_m=Person.random(4).height_m)
    estimate = PoseEstimator(alone(stature), blazepose)
    found, true = [], []
    source = SimulatedSource(SimulatedCameraConfig(seed=4, distance_m=distance_m, duration_s=2.0))
    with Playback(source) as camera:
        for picture in camera:
            pose = estimate(replace(picture, depth_mm=None))
            if pose is not None and source.world is not None:
                found.append(pose)
                true.append(source.world.truth.hip_center_camera_m)
    assert len(found) >= 55
    off = np.array([p.hip_center[2] - t[2] for p, t in zip(found, true, strict=True)])
    sigma = np.array([p.distance_sigma_m for p in found])
    assert (np.abs(off) < 3 * sigma).all()
    assert np.diff(off).std() < 0.01 * distance_m
