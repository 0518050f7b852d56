"""``nav_msgs/Odometry`` becomes a vehicle's state."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from wigwag.fly.values import VehicleState


def state_of(odometry: Any, stamp_ns: int) -> VehicleState | None:
    """Return the state that an odometry message tells, ENU and FLU as in REP 103.

    The twist is given in the child frame (the body's), unless that is the pose's own frame.

    Args:
        odometry: A message of ROS 1 or ROS 2; only its fields are looked at.
        stamp_ns: When it came, monotonic nanoseconds: two computers' clocks are not compared.

    Returns:
        The state, or None if a number in it is not finite or its attitude is no rotation.
    """
    pose, twist = odometry.pose.pose, odometry.twist.twist.linear
    position = np.array([pose.position.x, pose.position.y, pose.position.z], float)
    velocity = np.array([twist.x, twist.y, twist.z], float)
    q = np.array([pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w], float)
    norm = float(np.linalg.norm(q))
    if not np.isfinite([*position, *velocity, norm]).all() or not 0.9 < norm < 1.1:
        return None
    x, y, z, w = (float(c) for c in q / norm)
    matrix = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    if odometry.child_frame_id and odometry.child_frame_id != odometry.header.frame_id:
        velocity = matrix @ velocity
    roll = math.atan2(matrix[2, 1], matrix[2, 2])
    pitch = -math.asin(float(np.clip(matrix[2, 0], -1.0, 1.0)))
    heading = math.atan2(matrix[1, 0], matrix[0, 0])
    return VehicleState(position, velocity, heading, stamp_ns, roll, pitch)
