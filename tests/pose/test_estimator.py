"""From a frame with depth to a pose, with a stand-in for the network: geometry, identity, faults."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.pose.lift import LiftConfig
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
    return PoseEstimator(replace(PoseConfig(lift=SURFACE), **changes), Actor(*bodies))


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
    assert estimate(frame_at(4.0, 0)) is None
    assert estimate.body is None
    assert estimate(frame_at(0.0, 1)) is None
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
    estimate = estimator(*walk, body_at(0.1, 2.0), body_at(0.1, 2.0), body_at(0.1, 4.0))
    for k in range(5):
        assert estimate(frame_at(4.0, k)) is not None
    actor = estimate._tracker
    assert isinstance(actor, Actor)
    before = actor.resets
    assert estimate(frame_at(2.0, 5)) is None
    assert actor.resets == before, "one bad frame may be a hole in the depth"
    assert estimate(frame_at(2.0, 6)) is None
    assert actor.resets == before + 1, "two are another person"
    assert estimate(frame_at(4.0, 7)) is not None, "the operator is believed at once"


def test_after_a_while_whoever_is_there_is_believed() -> None:
    estimate = estimator(body_at(0.0, 5.0), body_at(0.0, 2.0))
    assert estimate(frame_at(5.0, 0)) is not None
    assert estimate(frame_at(2.0, 31)) is not None


def test_running_is_no_jump() -> None:
    xs = np.arange(0.0, 1.5, 4.0 / 30)  # 4 m/s across the picture
    estimate = estimator(*[body_at(x - 0.7, 4.0) for x in xs])
    assert all(estimate(frame_at(4.0, k)) is not None for k in range(len(xs)))


def test_the_real_network_on_a_real_photo(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    estimate = PoseEstimator(PoseConfig(lift=SURFACE), blazepose)
    depth = np.full((480, 640), 3500, np.uint16)
    pose = estimate(Frame(photos["land"], depth, CAMERA, 0))
    assert pose is not None
    span = np.linalg.norm(pose.joints[Landmark.LEFT_WRIST] - pose.joints[Landmark.RIGHT_WRIST])
    shoulders = np.linalg.norm(pose.joints[Landmark.LEFT_SHOULDER] - pose.joints[Landmark.RIGHT_SHOULDER])
    assert span > 3 * shoulders, "both arms stretched to the sides"
