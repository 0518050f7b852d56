"""The mapping into hri_msgs with stand-ins for its messages; the topics themselves with a real rclpy."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.vehicles.test_ros2 import rclpy, until  # noqa: F401  the fixture that skips
from wigwag.camera.frame import Intrinsics
from wigwag.gesture import Gesture
from wigwag.skeleton import Landmark, Pose
from wigwag.vehicles.hri import PeopleTopics, gesture_message, skeleton_message


class HriGesture:
    OTHER, WAVING = 0, 6

    def __init__(self):
        self.gesture = None


HRI = SimpleNamespace(
    Gesture=HriGesture,
    Skeleton2D=lambda: SimpleNamespace(skeleton=[]),
    NormalizedPointOfInterest2D=lambda: SimpleNamespace(x=None, y=None, c=None),
)


def pose():
    joints = np.tile([0.0, 0.0, 4.0], (13, 1))
    joints[Landmark.LEFT_SHOULDER] = [0.2, -0.4, 4.0]
    joints[Landmark.RIGHT_SHOULDER] = [-0.2, -0.4, 4.0]
    joints[Landmark.LEFT_HEEL] = [0.1, 0.9, -1.0]  # behind the camera
    return Pose(joints, np.full(13, 0.8), 1)


def test_a_skeleton_lies_in_the_picture():
    camera = Intrinsics()
    points = skeleton_message(HRI, pose(), camera).skeleton
    assert len(points) == 18
    nose, neck, right, left = points[0], points[1], points[2], points[5]
    assert (nose.x, nose.y, nose.c) == (camera.cx / camera.width, camera.cy / camera.height, 0.8)
    assert left.x > neck.x > right.x  # the operator's left is right in the picture
    assert neck.y == left.y < nose.y
    assert points[13].c == 0.0
    assert all(point.c == 0.0 for point in points[14:])


def test_a_gesture_is_one_of_theirs_or_other():
    assert gesture_message(HRI, "waving").gesture == 6
    assert gesture_message(HRI, "land").gesture == 0
    assert gesture_message(HRI, "__init__").gesture == 0


@pytest.mark.usefixtures("rclpy")
def test_pose_and_gesture_reach_another_node():
    from geometry_msgs.msg import PoseArray
    from std_msgs.msg import String

    from wigwag.vehicles.rclnode import RclNode

    other, people = RclNode("test_listener"), PeopleTopics(frame="optical")
    poses, labels = [], []
    other.node.create_subscription(PoseArray, "/wigwag_people/joints", poses.append, 10)
    other.node.create_subscription(String, "/wigwag_people/gesture", labels.append, 10)
    try:
        until(lambda: poses and labels, turn=lambda: people.publish(pose(), Gesture("land", 0.9)))
        count = len(poses)
        people.publish(None, Gesture(None, 0.2))
    finally:
        people.close()
        other.close()
    assert labels[0].data == "land"
    assert len(poses) <= count + 1
    message = poses[0]
    assert message.header.frame_id == "optical"
    assert len(message.poses) == 13
    assert message.poses[Landmark.LEFT_SHOULDER].position.x == pytest.approx(0.2)
