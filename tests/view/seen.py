"""People and poses for views to show."""

import numpy as np

from wigwag.pose.body import N_POINTS, Body
from wigwag.pose.estimator import Person
from wigwag.skeleton import Pose


def somebody(
    number: int,
    body: Body | None = None,
    pose: Pose | None = None,
    *,
    is_operator: bool = False,
    engaging: float = 0.0,
    disengaging: float = 0.0,
) -> Person:
    at = np.array([0.5, 0.3, 4.0]) if pose is None else pose.hip_center
    return Person(number, is_operator, body, pose, at, 0, engaging, disengaging)


def standing(stamp_ns: int = 0, at_m: tuple[float, float, float] = (0.5, 0.3, 4.0)) -> Pose:
    heights = (-0.7, -0.5, -0.5, -0.2, -0.2, 0.0, 0.0, 0.0, 0.0, 0.4, 0.4, 0.8, 0.8)
    joints = np.zeros((13, 3))
    joints[:, 1] = heights
    joints[1::2, 0], joints[2::2, 0] = 0.2, -0.2
    visibility = np.ones(13)
    visibility[12] = 0.0
    return Pose(joints + at_m, visibility, stamp_ns, sigma_m=np.full(13, 0.02))


def body() -> Body:
    points = np.random.default_rng(0).uniform((200, 100), (400, 400), (N_POINTS, 2))
    return Body(points, np.ones(N_POINTS), np.zeros((N_POINTS, 3)), 0.9, 0.9)
