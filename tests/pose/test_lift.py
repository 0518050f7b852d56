import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError
from wigwag.pose.lift import STATISTICS, SURFACE_TO_JOINT_MM, LiftConfig, Lifted, Lifter, Statistic
from wigwag.pose.lift_kernels import lift_depths
from wigwag.skeleton import LANDMARKS, MIRROR, Landmark

CAMERA = Intrinsics()
NOSE, L_SHOULDER, R_SHOULDER, L_ELBOW, R_ELBOW, L_WRIST, R_WRIST, L_HIP, R_HIP = range(9)
SEEN = np.full(13, 0.9)
WINDOWED: tuple[Statistic, ...] = ("surface", "quartile", "median")


def person(z_m: float = 3.0) -> np.ndarray:
    """A person standing in the picture's middle, metres, camera optical frame."""
    half = np.array(
        [[0.18, -0.42], [0.3, -0.15], [0.42, 0.1], [0.1, 0.08], [0.12, 0.5], [0.12, 0.95]]
    )  # shoulder, elbow, wrist, hip, knee, heel
    xy = np.vstack([[[0.0, -0.65]], np.stack([half, half * [-1, 1]], axis=1).reshape(-1, 2)])
    return np.column_stack([xy, np.full(13, z_m)])


def plane(z_mm: int) -> np.ndarray:
    return np.full((CAMERA.height, CAMERA.width), z_mm, dtype=np.uint16)


def box(depth: np.ndarray, at: np.ndarray, side_mm: float, z_mm: int) -> None:
    """Put a square of depth ``z_mm`` around a point in space (metres)."""
    u, v = CAMERA.project(at)
    half = side_mm / 2 * CAMERA.fx / (at[2] * 1e3)
    low_u, high_u = max(int(u - half), 0), int(u + half) + 1
    depth[max(int(v - half), 0) : int(v + half) + 1, low_u:high_u] = z_mm


def lift(
    depth: np.ndarray,
    points: np.ndarray | None = None,
    statistic: Statistic = "surface",
    offsets: bool = False,
) -> Lifted:
    points = CAMERA.project(person()) if points is None else points
    lifted = Lifter(LiftConfig(statistic=statistic, surface_to_joint=offsets))(points, SEEN, depth, CAMERA)
    assert lifted is not None
    return lifted


@pytest.mark.parametrize("statistic", STATISTICS)
def test_a_plane_gives_back_the_points_exactly(statistic: Statistic) -> None:
    lifted = lift(plane(3000), statistic=statistic)
    np.testing.assert_allclose(lifted.points_m, person(), atol=1e-9)
    assert lifted.measured.all()
    assert lifted.distance_m == 3.0
    np.testing.assert_array_equal(lifted.visibility, SEEN)


@pytest.mark.parametrize("statistic", STATISTICS)
def test_the_joint_lies_behind_the_surface_on_the_ray_of_its_pixel(statistic: Statistic) -> None:
    lifted = lift(plane(3000), statistic=statistic, offsets=True)
    z = 3.0 + np.array(SURFACE_TO_JOINT_MM[statistic]) * 1e-3
    np.testing.assert_allclose(lifted.points_m[:, 2], z)
    np.testing.assert_allclose(CAMERA.project(lifted.points_m), CAMERA.project(person()), atol=1e-9)
    assert lifted.distance_m == 3.0, "the body's distance is that of its surface, as in the paper"


def test_offsets_are_alike_on_both_sides_and_all_behind() -> None:
    for table in SURFACE_TO_JOINT_MM.values():
        assert len(table) == 13
        assert min(table) > 0
        assert [table[i] for i in MIRROR] == list(table)


def test_quartile_is_the_papers() -> None:
    """Of the trunk's depths and of each window's, the mean of the nearest quarter."""
    rng = np.random.default_rng(5)
    depth = rng.integers(2800, 3300, size=(CAMERA.height, CAMERA.width)).astype(np.uint16)
    points = CAMERA.project(person())
    lifted = lift(depth, points, "quartile")

    def nearest_quarter(u0: float, u1: float, v0: float, v1: float) -> float:
        window = depth[int(np.ceil(v0)) : int(v1) + 1, int(np.ceil(u0)) : int(u1) + 1]
        ascending = np.sort(window[window > 0])
        return float(ascending[: -(-ascending.size // 4)].mean())

    (u_right, v_top), (u_left, v_bottom) = points[R_SHOULDER], points[L_HIP]
    assert lifted.distance_m * 1e3 == pytest.approx(nearest_quarter(u_right, u_left, v_top, v_bottom), abs=5)
    half = 45 * CAMERA.fx / (lifted.distance_m * 1e3)
    expected = [nearest_quarter(u - half, u + half, v - half, v + half) for u, v in points]
    np.testing.assert_allclose(lifted.points_m[:, 2] * 1e3, expected)


def test_window_covers_90_mm_at_the_bodys_distance() -> None:
    """A patch counts as soon as the window, 90 mm x f / Z wide, reaches it, and not before."""
    for z_mm in (1500, 3000, 6000):
        at = person(z_mm / 1000)
        points = CAMERA.project(at)
        for offset_mm, reached in ((30.0, True), (60.0, False)):
            depth = plane(z_mm)
            u = points[L_WRIST, 0] + offset_mm * CAMERA.fx / z_mm
            depth[:, int(np.ceil(u)) :] = z_mm - 200
            found = lift(depth, points, "quartile").points_m[L_WRIST, 2]
            assert (found < z_mm / 1000 - 1e-6) == reached, (z_mm, offset_mm)


@settings(max_examples=40, deadline=None)
@given(
    z_mm=st.integers(1000, 8000),
    shift=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.2, 0.2)),
    statistic=st.sampled_from(STATISTICS),
)
def test_any_distance_any_place(z_mm: int, shift: tuple[float, float], statistic: Statistic) -> None:
    at = person(z_mm / 1000) + np.array([*shift, 0.0])
    points = CAMERA.project(at)
    inside = (
        (points > -0.49).all(axis=1)
        & (points[:, 0] < CAMERA.width - 0.51)
        & (points[:, 1] < CAMERA.height - 0.51)
    )
    lifted = lift(plane(z_mm), points, statistic)
    np.testing.assert_array_equal(lifted.measured, inside)
    np.testing.assert_allclose(lifted.points_m, at, atol=1e-9)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), farther_mm=st.integers(1, 2000), statistic=st.sampled_from(STATISTICS))
def test_depths_farther_by_a_step_lift_farther_by_it(
    seed: int, farther_mm: int, statistic: Statistic
) -> None:
    """Landmarks and windows scale with distance; with every depth near one plane the step comes through."""
    rng = np.random.default_rng(seed)
    noise = rng.integers(-15, 16, size=(CAMERA.height, CAMERA.width))
    near, far = (np.uint16(2500 + noise + step) for step in (0, farther_mm))
    a = lift(near, CAMERA.project(person(2.5)), statistic)
    b = lift(far, CAMERA.project(person(2.5 + farther_mm / 1000)), statistic)
    np.testing.assert_allclose((b.points_m - a.points_m)[:, 2], farther_mm / 1000, atol=0.031)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), statistic=st.sampled_from(STATISTICS))
def test_whatever_the_depth_the_answer_is_finite_and_in_reach(seed: int, statistic: Statistic) -> None:
    rng = np.random.default_rng(seed)
    depth = rng.integers(0, 65536, size=(CAMERA.height, CAMERA.width)).astype(np.uint16)
    depth[rng.random(depth.shape) < 0.3] = 0
    points = rng.uniform(-100, 740, size=(13, 2))
    lifted = Lifter(LiftConfig(statistic=statistic))(points, SEEN, depth, CAMERA)
    if lifted is not None:
        assert np.isfinite(lifted.points_m).all()
        assert (np.abs(lifted.points_m[:, 2] - lifted.distance_m) <= 1.0 + 0.13).all()
        assert (lifted.visibility[~lifted.measured] == 0).all()
        assert (lifted.visibility[lifted.measured] == 0.9).all()
        assert (lifted.sigma_m >= 0.012).all() and np.isfinite(lifted.sigma_m).all()
        assert (lifted.sigma_m[~lifted.measured] >= 0.045).all()
        assert ((lifted.fill >= 0) & (lifted.fill <= 1)).all()


def test_no_depth_at_the_person_is_none() -> None:
    assert Lifter()(CAMERA.project(person()), SEEN, plane(0), CAMERA) is None
    depth = plane(0)
    depth[:, :100] = 3000  # a wall beside the person
    assert Lifter()(CAMERA.project(person()), SEEN, depth, CAMERA) is None


def test_person_outside_the_picture_is_none() -> None:
    assert Lifter()(CAMERA.project(person()) + 1000, SEEN, plane(3000), CAMERA) is None


def test_trunk_seen_from_the_side_still_has_a_distance() -> None:
    at = person()
    at[[L_SHOULDER, R_SHOULDER, L_HIP, R_HIP], 0] = 0.0
    assert lift(plane(3000), CAMERA.project(at)).distance_m == 3.0


@pytest.mark.parametrize("statistic", WINDOWED)
def test_a_hole_smaller_than_twice_the_window_is_looked_around(statistic: Statistic) -> None:
    depth = plane(3000)
    box(depth, person()[L_WRIST], 110, 0)
    lifted = lift(depth, statistic=statistic)
    assert lifted.measured[L_WRIST]
    assert lifted.points_m[L_WRIST, 2] == pytest.approx(3.0)


@pytest.mark.parametrize("statistic", STATISTICS)
def test_a_landmark_in_a_large_hole_takes_its_neighbours_depth(statistic: Statistic) -> None:
    depth = plane(3000)
    box(depth, person()[L_WRIST], 320, 0)
    box(depth, person()[L_ELBOW], 60, 2900)
    lifted = lift(depth, statistic=statistic)
    assert lifted.measured.sum() == 12
    assert not lifted.measured[L_WRIST]
    assert lifted.visibility[L_WRIST] == 0
    assert lifted.points_m[L_WRIST, 2] == lifted.points_m[L_ELBOW, 2]
    np.testing.assert_allclose(
        CAMERA.project(lifted.points_m)[L_WRIST], CAMERA.project(person())[L_WRIST], atol=1e-9
    )


def test_a_whole_arm_without_depth_takes_the_shoulders() -> None:
    depth = plane(3000)
    for joint in (L_ELBOW, L_WRIST):
        box(depth, person()[joint], 330, 0)
    box(depth, person()[L_SHOULDER], 200, 3000)
    lifted = lift(depth)
    assert not lifted.measured[[L_ELBOW, L_WRIST]].any()
    np.testing.assert_allclose(lifted.points_m[[L_ELBOW, L_WRIST], 2], lifted.points_m[L_SHOULDER, 2])


def test_a_landmark_outside_the_picture_is_filled() -> None:
    points = CAMERA.project(person())
    points[R_WRIST] = [-40.0, 200.0]
    points[L_WRIST] = [CAMERA.width - 0.4, 200.0]
    lifted = lift(plane(3000), points)
    assert not lifted.measured[[L_WRIST, R_WRIST]].any()
    assert lifted.visibility[R_WRIST] == 0
    np.testing.assert_allclose(CAMERA.project(lifted.points_m), points, atol=1e-9)


def test_a_wrist_before_a_far_wall_is_the_wrist() -> None:
    """The window catches more wall than wrist; the wall is out of the body's reach."""
    depth = plane(5000)
    for joint in range(13):
        box(depth, person()[joint], 130, 3000)
    u, v = CAMERA.project(person()[[L_SHOULDER, R_SHOULDER, L_HIP, R_HIP]]).astype(int).T
    depth[v.min() : v.max(), u.min() : u.max()] = 3000
    box(depth, person()[L_WRIST], 90, 5000)
    box(depth, person()[L_WRIST], 30, 2800)
    for statistic in STATISTICS:
        assert lift(depth, statistic=statistic).points_m[L_WRIST, 2] == pytest.approx(2.8), statistic


def test_a_wrist_that_shows_only_a_near_wall_is_not_measured() -> None:
    """A wall 0.8 m behind the body is within its reach, but no forearm is so long."""
    depth = plane(3800)
    u, v = CAMERA.project(person()[[L_SHOULDER, R_SHOULDER, L_HIP, R_HIP]]).astype(int).T
    depth[v.min() - 60 : v.max() + 180, u.min() - 10 : u.max() + 10] = 3000
    for joint in (L_ELBOW, R_ELBOW, R_WRIST):
        box(depth, person()[joint], 130, 3000)
    lifted = lift(depth)
    assert not lifted.measured[L_WRIST]
    assert lifted.points_m[L_WRIST, 2] == pytest.approx(3.0)
    assert lifted.measured[[L_ELBOW, R_ELBOW, R_WRIST, L_SHOULDER]].all()


def test_an_arm_before_the_chest_leaves_shoulder_and_hip_alone() -> None:
    """Half of the shoulder's window shows a forearm 0.25 m before it."""
    depth = plane(3000)
    for joint in (L_SHOULDER, R_HIP):
        u, v = CAMERA.project(person()[joint]).astype(int)
        depth[v - 8 : v + 4, u - 60 : u + 61] = 2750
    surface, paper = lift(depth), lift(depth, statistic="quartile")
    np.testing.assert_allclose(surface.points_m[[L_SHOULDER, R_HIP], 2], 3.0)
    assert (paper.points_m[[L_SHOULDER, R_HIP], 2] < 2.8).all(), "what the paper's statistic does"


def test_an_arm_that_covers_the_shoulder_is_looked_around() -> None:
    """A forearm 0.3 m before the shoulder hides its whole window; the chest shows beside it."""
    depth = plane(3000)
    u, v = CAMERA.project(person()[L_SHOULDER]).astype(int)
    depth[v - 16 : v + 17, u - 100 : u + 101] = 2700
    lifted = lift(depth)
    assert lifted.points_m[L_SHOULDER, 2] == pytest.approx(3.0)
    assert lift(depth, statistic="median").points_m[L_SHOULDER, 2] == pytest.approx(2.7)


def test_a_person_who_bends_forward_is_believed() -> None:
    """Shoulders and head 0.45 m before the hips, without a gap between: no arm, but a bow."""
    depth = plane(3000)
    top, bottom = CAMERA.project(person())[[NOSE, L_HIP], 1]
    rows = np.arange(CAMERA.height)
    depth[:] = (3000 - 450 * np.clip((bottom - rows) / (bottom - top), 0, 1.2))[:, None].astype(np.uint16)
    expected = depth[CAMERA.project(person())[:, 1].astype(int), 0] / 1000
    np.testing.assert_allclose(lift(depth).points_m[:, 2], expected, atol=0.05)


def test_a_wrist_before_the_chest_is_the_wrist() -> None:
    at = person()
    at[L_WRIST, :2] = [0.0, -0.2]
    depth = plane(3000)
    box(depth, at[L_WRIST], 50, 2650)
    assert lift(depth, CAMERA.project(at)).points_m[L_WRIST, 2] == pytest.approx(2.65)


def test_flying_pixels_are_no_surface() -> None:
    """Three stray pixels before the wrist do not draw it forward."""
    depth = plane(3000)
    u, v = CAMERA.project(person()[L_WRIST]).astype(int)
    depth[v, u - 3 : u] = 2500
    assert lift(depth).points_m[L_WRIST, 2] == pytest.approx(3.0)


def test_stereo_noise_far_away_does_not_tear_a_surface_apart() -> None:
    rng = np.random.default_rng(7)
    depth = np.uint16(6000 + rng.normal(0, 60, size=(CAMERA.height, CAMERA.width)))
    lifted = lift(depth, CAMERA.project(person(6.0)))
    assert np.abs(lifted.points_m[:, 2] - 6.0).max() < 0.05


@pytest.mark.parametrize(
    ("points", "visibility", "depth", "message"),
    [
        (np.zeros((33, 2)), SEEN, plane(3000), r"points_px must have shape \(13, 2\), but got \(33, 2\)"),
        (np.full((13, 2), np.nan), SEEN, plane(3000), "points_px holds NaN or infinity, first at nose"),
        (np.zeros((13, 2)), np.ones(33), plane(3000), r"visibility must have shape \(13,\)"),
        (np.zeros((13, 2)), SEEN, None, "A frame without depth cannot be lifted"),
        (np.zeros((13, 2)), SEEN, np.zeros((480, 640)), r"uint16 .* but got float64 \(480, 640\)"),
        (np.zeros((13, 2)), SEEN, np.zeros((480, 640, 1), np.uint16), r"but got uint16 \(480, 640, 1\)"),
    ],
)
def test_faults(points: np.ndarray, visibility: np.ndarray, depth: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Lifter()(points, visibility, depth, CAMERA)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"statistic": "mean"}, "LiftConfig.statistic must be one of"),
        ({"window_mm": 0.0}, "LiftConfig.window_mm must be above 0"),
        ({"reach_mm": float("nan")}, "LiftConfig.reach_mm must be above 0"),
    ],
)
def test_configuration_faults(fields: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        LiftConfig(**fields)


def test_depth_is_left_as_it_was_and_any_layout_will_do_without_compiling_anew() -> None:
    rng = np.random.default_rng(3)
    depth = rng.integers(2900, 3100, size=(480, 640)).astype(np.uint16)
    before = depth.copy()
    a = lift(depth)
    np.testing.assert_array_equal(depth, before)
    b = lift(np.asfortranarray(depth))
    np.testing.assert_array_equal(a.points_m, b.points_m)
    readonly = depth.copy()
    readonly.flags.writeable = False
    np.testing.assert_array_equal(lift(readonly).points_m, a.points_m)
    whole = Intrinsics(fx=615, fy=615, cx=320, cy=240)
    assert Lifter(LiftConfig(window_mm=90))(CAMERA.project(person()), SEEN, depth[:], whole) is not None
    assert len(lift_depths.signatures) == 1


def test_39_landmarks_cost_under_a_millisecond() -> None:
    """Three times the 13, which is more than BlazePose's 33; near by, where windows are large."""
    rng = np.random.default_rng(0)
    depth = rng.integers(1950, 2050, size=(480, 640)).astype(np.uint16)
    points, lifter = CAMERA.project(person(2.0)), Lifter()
    lifter(points, SEEN, depth, CAMERA)
    times = []
    for _ in range(50):
        start = time.thread_time()
        for _ in range(3):
            lifter(points, SEEN, depth, CAMERA)
        times.append(time.thread_time() - start)
    assert min(times) < 1e-3, "the fastest of 50, so that a busy machine does not fail it"


def noisy_wall(z_mm: int, sd_mm: float, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(0, sd_mm, size=(CAMERA.height, CAMERA.width))
    return np.uint16(z_mm + noise)


def test_spread_is_that_of_the_surface_and_nothing_elses() -> None:
    depth = noisy_wall(3000, 25.0)
    u, v = CAMERA.project(person()[L_SHOULDER]).astype(int)
    depth[v - 8 : v + 4, u - 60 : u + 61] = 2750
    lifted = lift(depth)
    np.testing.assert_allclose(lifted.spread_m, 0.025, rtol=0.35)
    assert lifted.fill[R_SHOULDER] > 0.95
    assert 0.3 < lifted.fill[L_SHOULDER] < 0.8
    assert not lifted.widened.any()


def test_sigma_grows_with_all_that_makes_a_depth_unsure() -> None:
    clean = lift(plane(3000)).sigma_m
    assert (clean >= 0.012).all() and (clean < 0.03).all()
    assert (lift(noisy_wall(3000, 40.0)).sigma_m > clean).all(), "spread"
    far = Lifter()(CAMERA.project(person(6.0)), SEEN, plane(6000), CAMERA)
    assert far is not None
    assert (far.sigma_m > clean).all(), "distance"
    hardly = Lifter()(CAMERA.project(person()), np.full(13, 0.1), plane(3000), CAMERA)
    assert hardly is not None
    assert (hardly.sigma_m > 0.06).all(), "visibility"
    depth = plane(3000)
    box(depth, person()[L_WRIST], 60, 0)
    holed = lift(depth)
    assert holed.measured[L_WRIST] and not holed.widened[L_WRIST]
    assert holed.sigma_m[L_WRIST] > clean[L_WRIST], "a hole"
    box(depth, person()[L_WRIST], 110, 0)
    wide = lift(depth)
    assert wide.widened[L_WRIST]
    assert wide.sigma_m[L_WRIST] > holed.sigma_m[L_WRIST], "a wider window"
    box(depth, person()[L_WRIST], 320, 0)
    filled = lift(depth)
    assert not filled.measured[L_WRIST]
    assert filled.sigma_m[L_WRIST] > wide.sigma_m[L_WRIST], "a neighbour's depth"
    others = [i for i in range(13) if i not in (L_WRIST, L_ELBOW, L_HIP)]
    np.testing.assert_array_equal(filled.sigma_m[others], clean[others])


@pytest.mark.parametrize("share", [0.1, 0.5])
def test_pixels_knocked_out_leave_landmarks_where_they_are(share: float) -> None:
    rng = np.random.default_rng(4)
    depth = noisy_wall(4000, 12.0)
    whole = lift(depth, CAMERA.project(person(4.0)))
    depth[rng.random(depth.shape) < share] = 0
    lifted = lift(depth, CAMERA.project(person(4.0)))
    assert lifted.measured.all()
    np.testing.assert_allclose(lifted.points_m[:, 2], whole.points_m[:, 2], atol=0.006)
    np.testing.assert_allclose(lifted.fill, 1.0 - share, atol=0.15)


def test_a_visibility_that_is_no_number_counts_as_unseen() -> None:
    seen = SEEN.copy()
    seen[L_WRIST] = np.nan
    lifted = Lifter()(CAMERA.project(person()), seen, plane(3000), CAMERA)
    assert lifted is not None
    assert lifted.visibility[L_WRIST] == 0.0
    assert np.isfinite(lifted.sigma_m).all()


def test_landmark_order_is_the_houses() -> None:
    assert LANDMARKS[L_WRIST] == "left_wrist"
    assert Landmark.RIGHT_HIP == R_HIP
