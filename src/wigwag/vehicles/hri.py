"""The person and their gestures on ROS 2 topics, as ROS4HRI (REP 155) names them."""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import Any

import numpy as np

from wigwag.camera.frame import Intrinsics
from wigwag.extras import load
from wigwag.gesture import Gesture
from wigwag.skeleton import Landmark, Pose
from wigwag.vehicles.rclnode import RclNode

_WHAT = "Telling ROS 2 about people"
_ORDER = (
    Landmark.NOSE, None, Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST,
    Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST, Landmark.RIGHT_HIP, Landmark.RIGHT_KNEE,
    Landmark.RIGHT_HEEL, Landmark.LEFT_HIP, Landmark.LEFT_KNEE, Landmark.LEFT_HEEL,
)  # fmt: skip
"""``hri_msgs/Skeleton2D`` up to the left ankle; the second is the neck. Eyes and ears follow, not known."""
_POINTS = 18


class PeopleTopics:
    """Publishes the operator's pose and gestures.

    Always: ``~/gesture`` (``std_msgs/String``, the label) and ``~/joints`` (``geometry_msgs/PoseArray``, the
    13 landmarks in the camera's optical frame). Where ``hri_msgs`` is installed as well:
    ``/humans/bodies/tracked``, and below ``/humans/bodies/<id>/`` ``skeleton2d`` and ``gesture``.

    Args:
        node: The node that publishes; by default one of its own, closed with this.
        frame: Name of the camera's optical frame.
        intrinsics: Of the camera; without them there is no ``skeleton2d``.
        body: Identifier of the operator's body.

    Raises:
        MissingExtraError: If rclpy is not installed.
    """

    def __init__(
        self, node: RclNode | None = None, *, frame: str = "camera_color_optical_frame",
        intrinsics: Intrinsics | None = None, body: str = "operator",
    ) -> None:  # fmt: skip
        self._ros, self._owned = node or RclNode("wigwag_people"), node is None
        self._frame, self._intrinsics, self._body = frame, intrinsics, body
        self._geometry = load("geometry_msgs.msg", "ros2", _WHAT)
        self._std = load("std_msgs.msg", "ros2", _WHAT)
        create = self._ros.node.create_publisher
        self._label = create(self._std.String, "~/gesture", 10)
        self._joints = create(self._geometry.PoseArray, "~/joints", 1)
        self._hri: ModuleType | None = None
        try:
            self._hri = hri = importlib.import_module("hri_msgs.msg")
        except ImportError:
            return
        below = f"/humans/bodies/{body}"
        self._tracked = create(hri.IdsList, "/humans/bodies/tracked", 1)
        self._skeleton = create(hri.Skeleton2D, f"{below}/skeleton2d", 1)
        self._gesture = create(hri.Gesture, f"{below}/gesture", 10)

    def publish(self, pose: Pose | None, gesture: Gesture | None = None) -> None:
        """Publish what one turn of the loop saw.

        Args:
            pose: The operator's, or None if nobody is seen.
            gesture: What was recognised in this turn, if anything; unsure is not published.
        """
        label = None if gesture is None else gesture.label
        if pose is not None:
            self._joints.publish(self._stamped(joints_message(self._geometry, pose)))
        if label is not None:
            self._label.publish(self._std.String(data=label))
        if self._hri is None:
            return
        ids = self._stamped(self._hri.IdsList())
        ids.ids = [] if pose is None else [self._body]
        self._tracked.publish(ids)
        if pose is not None and self._intrinsics is not None:
            self._skeleton.publish(self._stamped(skeleton_message(self._hri, pose, self._intrinsics)))
        if label is not None:
            self._gesture.publish(self._stamped(gesture_message(self._hri, label)))

    def close(self) -> None:
        """Take the node down, if it is its own."""
        if self._owned:
            self._ros.close()

    def _stamped(self, message: Any) -> Any:
        message.header.stamp, message.header.frame_id = self._ros.now(), self._frame
        return message


def joints_message(geometry: Any, pose: Pose) -> Any:
    """Return a ``PoseArray`` of the landmarks, in the order of ``wigwag.skeleton.LANDMARKS``; no turns."""
    message = geometry.PoseArray()
    for x, y, z in pose.joints:
        point = geometry.Pose()
        point.position.x, point.position.y, point.position.z = float(x), float(y), float(z)
        point.orientation.w = 1.0
        message.poses.append(point)
    return message


def skeleton_message(hri: Any, pose: Pose, intrinsics: Intrinsics) -> Any:
    """Return a ``Skeleton2D``: where the landmarks are in the picture, 0 to 1 from its upper left corner.

    What is behind the camera, or not known (eyes, ears), has confidence 0.
    """
    message = hri.Skeleton2D()
    points = [_point(hri, None, 0.0, intrinsics) for _ in range(_POINTS)]
    for index, landmark in enumerate(_ORDER):
        if landmark is None:
            sides = [Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER]
            where, seen = pose.joints[sides].mean(axis=0), pose.visibility[sides].min()
        else:
            where, seen = pose.joints[landmark], pose.visibility[landmark]
        points[index] = _point(hri, where, float(seen), intrinsics)
    message.skeleton = points
    return message


def _point(hri: Any, where: np.ndarray | None, seen: float, intrinsics: Intrinsics) -> Any:
    point = hri.NormalizedPointOfInterest2D()
    point.x = point.y = point.c = 0.0
    if where is not None and where[2] > 0.05:
        x, y, z = (float(v) for v in where)
        point.x = (intrinsics.cx + intrinsics.fx * x / z) / intrinsics.width
        point.y = (intrinsics.cy + intrinsics.fy * y / z) / intrinsics.height
        point.c = seen
    return point


def gesture_message(hri: Any, label: str) -> Any:
    """Return a ``Gesture``; a label that bears the name of one of its constants is that one, else OTHER."""
    message = hri.Gesture()
    number = getattr(hri.Gesture, label.upper(), hri.Gesture.OTHER)
    message.gesture = number if isinstance(number, int) else hri.Gesture.OTHER
    return message
