"""From a frame with depth to a pose, with a stand-in for the network: geometry, identity, faults."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body, Point
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.pose.lift import LiftConfig
from wigwag.pose.operator import OperatorConfig
from wigwag.pose.sides import other_side
from wigwag.pose.steady import SteadyConfig
from wigwag.skeleton import Landmark, Pose

CAMERA = Intrinsics()
SURFACE = LiftConfig(surface_to_joint=False)
PERIOD_NS = 33_333_333


def standing(x_m: float, z_m: float) -> np.ndarray:
    """33 landmarks of a flat person facing the camera, metres, camera frame."""
    points = np.zeros((33, 3))
    points[:11] = (0.0, -0.65, 0.0)
    points[[7, 8], 0] = (0.08, -0.08)
    points[[7, 8], 1] = -0.7
    for left, side, down in ((11, 0.2, -0.45), (13, 0.3, -0.2), (15, 0.35, 0.05), (17, 0.36, 0.1),
                             (19, 0.36, 0.12), (21, 0.34, 0.1), (23, 0.12, 0.0), (25, 0.13, 0.4),
                             (27, 0.13, 0.8), (29, 0.13, 0.85), (31, 0.16, 0.86)):  # fmt: skip
        points[left] = (side, down, 0.0)
        points[left + 1] = (-side, down, 0.0)
    return points + np.array([x_m, 0.1, z_m])


def body_at(x_m: float, z_m: float) -> Body:
    points = standing(x_m, z_m)
    return Body(CAMERA.project(points), np.full(33, 0.9), points - points[[23, 24]].mean(axis=0), 1.0, 0.9)


def frame_at(z_m: float, k: int = 0) -> Frame:
    depth = np.full((480, 640), round(z_m * 1000), np.uint16)
    return Frame(np.zeros((480, 640, 3), np.uint8), depth, CAMERA, k * PERIOD_NS)


class Actor:
    """Gives out bodies in turn instead of looking for them."""

    def __init__(self, *bodies: Body | None) -> None:
        self.bodies, self.resets = list(bodies), 0

    def track(self, rgb: np.ndarray) -> Body | None:
        return self.bodies.pop(0) if self.bodies else None

    def reset(self) -> None:
        self.resets += 1


def estimator(*bodies: Body | None, **changes: object) -> PoseEstimator:
    alone = PoseConfig(lift=SURFACE, operator=OperatorConfig(engage="first"))
    return PoseEstimator(replace(alone, **changes), Actor(*bodies))


def why_not(estimate: PoseEstimator, frame: Frame) -> str:
    assert estimate(frame) is None
    return estimate.why


@pytest.mark.parametrize(("x_m", "z_m"), [(0.0, 3.0), (-0.8, 4.0), (1.2, 6.0)])
def test_the_pose_stands_where_the_person_stands(x_m: float, z_m: float) -> None:
    pose = estimator(body_at(x_m, z_m))(frame_at(z_m))
    assert isinstance(pose, Pose)
    truth = standing(x_m, z_m)
    np.testing.assert_allclose(pose.joints[Landmark.LEFT_WRIST], truth[15], atol=2e-3)
    np.testing.assert_allclose(pose.joints[Landmark.RIGHT_HEEL], truth[30], atol=2e-3)
    np.testing.assert_allclose(pose.hip_center, truth[[23, 24]].mean(axis=0), atol=2e-3)
    np.testing.assert_allclose(pose.visibility, 0.9)


def test_the_head_is_the_middle_of_the_ears_or_the_nose() -> None:
    truth = standing(0.5, 4.0)
    for head, point in (("ears", truth[[7, 8]].mean(axis=0)), ("nose", truth[0])):
        pose = estimator(body_at(0.5, 4.0), head=head)(frame_at(4.0))
        assert pose is not None
        np.testing.assert_allclose(pose.joints[Landmark.NOSE], point, atol=2e-3)


def test_nobody_and_no_depth_under_the_person_are_none() -> None:
    estimate = estimator(None, body_at(0.0, 4.0))
    assert why_not(estimate, frame_at(4.0, 0)) == "nobody is seen"
    assert estimate.body is None
    assert why_not(estimate, frame_at(0.0, 1)) == "the depth of who is there cannot be told"
    assert estimate.body is not None


def test_what_is_not_finite_never_leaves() -> None:
    body = body_at(0.0, 4.0)
    broken = replace(body, points_px=np.where(np.arange(33)[:, None] == 15, np.nan, body.points_px))
    assert estimator(broken)(frame_at(4.0)) is None


def test_a_frame_without_depth_is_an_error_that_says_so() -> None:
    frame = Frame(np.zeros((480, 640, 3), np.uint8), None, CAMERA, 0)
    with pytest.raises(InputError, match=r"depth_mm is None.*aligned to the colour"):
        estimator(body_at(0.0, 4.0))(frame)


@pytest.mark.parametrize("k", [3, 2])
def test_time_that_does_not_run_forward_is_an_error(k: int) -> None:
    estimate = estimator(*[body_at(0.0, 4.0)] * 3)
    estimate(frame_at(4.0, 3))
    with pytest.raises(InputError, match="stamp_ns must grow"):
        estimate(frame_at(4.0, k))
    estimate.reset()
    assert estimate(frame_at(4.0, k)) is not None


def test_a_passer_by_does_not_take_the_track_over() -> None:
    """In the picture the track slides over smoothly; in space it jumps two metres nearer."""
    walk = [body_at(0.02 * k, 4.0) for k in range(5)]
    actor = Actor(*walk, body_at(0.1, 2.0), body_at(0.1, 2.0), *[body_at(0.1, 4.0)] * 4)
    config = PoseConfig(lift=SURFACE, operator=OperatorConfig(engage="first"))
    estimate = PoseEstimator(config, actor)
    for k in range(5):
        assert estimate(frame_at(4.0, k)) is not None
    before = actor.resets
    assert why_not(estimate, frame_at(2.0, 5)) == "somebody or something stands before the operator"
    assert actor.resets == before, "one bad frame may be a hole in the depth"
    assert estimate(frame_at(2.0, 6)) is None
    assert actor.resets == before + 1, "two are another person"
    for k in (7, 8):
        assert why_not(estimate, frame_at(4.0, k)) == "in doubt whether this is the operator"
    assert estimate(frame_at(4.0, 9)) is not None, "the operator is believed after three frames"
    assert [person.is_operator for person in estimate.people] == [True, False]


def test_after_a_while_whoever_is_there_is_believed() -> None:
    estimate = estimator(body_at(0.0, 5.0), body_at(0.0, 2.0))
    assert estimate(frame_at(5.0, 0)) is not None
    assert estimate(frame_at(2.0, 31)) is not None


def test_running_is_no_jump() -> None:
    xs = np.arange(0.0, 1.5, 4.0 / 30)  # 4 m/s across the picture
    estimate = estimator(*[body_at(x - 0.7, 4.0) for x in xs])
    assert all(estimate(frame_at(4.0, k)) is not None for k in range(len(xs)))


def test_the_real_network_on_a_real_photo(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    estimate = PoseEstimator(PoseConfig(lift=SURFACE, operator=OperatorConfig(engage="first")), blazepose)
    depth = np.full((480, 640), 3500, np.uint16)
    pose = estimate(Frame(photos["land"], depth, CAMERA, 0))
    assert pose is not None
    span = np.linalg.norm(pose.joints[Landmark.LEFT_WRIST] - pose.joints[Landmark.RIGHT_WRIST])
    shoulders = np.linalg.norm(pose.joints[Landmark.LEFT_SHOULDER] - pose.joints[Landmark.RIGHT_SHOULDER])
    assert span > 3 * shoulders, "both arms stretched to the sides"


def test_landmarks_well_seen_stay_as_measured() -> None:
    """Whatever the body does, full visibility means no filter and no delay."""
    moving = [body_at(0.0, 4.0) for _ in range(12)]
    random = np.random.default_rng(0)
    moving = [replace(b, points_px=b.points_px + random.normal(0, 4, (33, 2))) for b in moving]
    estimate = estimator(*moving)
    for k, body in enumerate(moving):
        pose = estimate(frame_at(4.0, k))
        assert pose is not None
        wrist = CAMERA.deproject(body.points_px[15], np.array(4.0))
        np.testing.assert_allclose(pose.joints[Landmark.LEFT_WRIST], wrist, atol=2e-3)


def test_feet_that_are_not_seen_hardly_move_and_still_go_where_the_body_goes() -> None:
    """The network guesses heels below the picture's edge anew in every frame, a decimetre apart."""
    unseen, random, bodies = [29, 30], np.random.default_rng(1), []
    for k in range(60):
        body = body_at(0.015 * k - 0.4, 4.0)
        points, visibility = body.points_px.copy(), body.visibility.copy()
        points[unseen] += random.normal(0, 15, (2, 2))
        visibility[unseen] = 0.05
        bodies.append(replace(body, points_px=points, visibility=visibility))
    trusting = SteadyConfig(smooth="never", trusted=(-2.0, -1.0))
    estimate, raw = estimator(*bodies), estimator(*bodies, steady=trusting)
    steadied, measured = [], []
    for k in range(60):
        for seen, into in ((estimate, steadied), (raw, measured)):
            pose = seen(frame_at(4.0, k))
            assert pose is not None
            into.append(pose.joints[Landmark.LEFT_HEEL] - pose.hip_center)
    jumps = [np.median(np.linalg.norm(np.diff(heels, axis=0), axis=1)) for heels in (steadied, measured)]
    assert jumps[1] > 0.05
    assert jumps[0] < 0.2 * jumps[1]
    truth = standing(0.0, 4.0)[29] - standing(0.0, 4.0)[[23, 24]].mean(axis=0)
    np.testing.assert_allclose(np.mean(steadied[20:], axis=0)[:2], truth[:2], atol=0.06)


def test_steadying_begins_anew_after_a_reset_and_after_another_person() -> None:
    low = replace(body_at(0.0, 4.0), visibility=np.full(33, 0.1))
    raised = low.points_px.copy()
    raised[15, 1] -= 100
    other = replace(low, points_px=raised)
    estimate = estimator(low, other)
    first, second = estimate(frame_at(4.0, 0)), estimate(frame_at(4.0, 1))
    assert first is not None and second is not None
    wrist = Landmark.LEFT_WRIST
    moved = np.linalg.norm(second.joints[wrist] - first.joints[wrist])
    assert 0 < moved < 0.1
    estimate = estimator(low, other)
    estimate(frame_at(4.0, 0))
    estimate.reset()
    fresh = estimate(frame_at(4.0, 1))
    assert fresh is not None
    assert np.linalg.norm(fresh.joints[wrist] - first.joints[wrist]) > 0.5


def test_sides_crossed_for_a_moment_are_put_right_before_the_pose() -> None:
    """The network took the front for the back."""
    front = body_at(0.0, 4.0)
    swapped = np.array([point if point is Point.NOSE else other_side(point) for point in Point])
    back = replace(front, points_px=front.points_px[swapped])
    estimate = estimator(*[front] * 5, *[back] * 3, *[front] * 2)
    for k in range(10):
        pose = estimate(frame_at(4.0, k))
        assert pose is not None
        assert pose.joints[Landmark.LEFT_WRIST, 0] > 0.2
        assert pose.joints[Landmark.RIGHT_HEEL, 0] < -0.05
