"""Where things are in the world's frame (ENU, metres), for every view in 3-D."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from wigwag.fly.fence import Cylinder, Fence, Polygon
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState

_CIRCLE = 48


def to_world(
    joints_m: Float[np.ndarray, "joints 3"], at: VehicleState, mount: Mount
) -> Float[np.ndarray, "joints 3"]:
    """Turn points in the camera's optical frame into the world's, seen from a drone.

    Example:
        >>> at = VehicleState(np.array([0.0, 0.0, 1.2]), np.zeros(3), 0.0, 0)
        >>> ahead = to_world(np.array([[0.0, 0.0, 4.0]]), at, Mount())
        >>> ahead.round(3).tolist()
        [[4.1, 0.0, 1.2]]
    """
    body = np.stack([mount.to_body(joint) for joint in joints_m])
    return np.asarray(body @ rotation(at).T + at.position_m)


def circle(center_m: tuple[float, float], radius_m: float, up_m: float) -> Float[np.ndarray, "lines 2 3"]:
    """Return a level circle as lines."""
    angles = np.linspace(0.0, 2 * np.pi, _CIRCLE + 1)
    points = np.stack(
        [
            center_m[0] + radius_m * np.cos(angles),
            center_m[1] + radius_m * np.sin(angles),
            np.full(_CIRCLE + 1, up_m),
        ],
        axis=1,
    )
    return np.stack([points[:-1], points[1:]], axis=1)


def fence_lines(fence: Fence, ceiling_m: float) -> Float[np.ndarray, "lines 2 3"]:
    """Return the fence from the ground to the ceiling as lines: two outlines and the posts between them."""
    if isinstance(fence, Cylinder):
        low = circle(fence.center_m, fence.radius_m, 0.0)
        corners = low[:: _CIRCLE // 16, 0]
    elif isinstance(fence, Polygon):
        corners = np.array([(east, north, 0.0) for east, north in fence.corners_m])
        low = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    else:
        return np.zeros((0, 2, 3))
    high = np.array([0.0, 0.0, ceiling_m])
    return np.concatenate([low, low + high, np.stack([corners, corners + high], axis=1)])


__all__ = ["circle", "fence_lines", "to_world"]
