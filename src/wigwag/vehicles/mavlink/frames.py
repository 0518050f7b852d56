"""Between wigwag's frames (body FLU, world ENU) and MAVLink's (body FRD, local NED).

NED ends here: nothing outside this folder knows of it.
"""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float


def body_to_ned(velocity_m_s: tuple[float, float, float], heading_rad: float) -> tuple[float, float, float]:
    """Turn a level body velocity (forward, left, up) into north, east, down.

    Args:
        velocity_m_s: Level with the ground, whatever the tilt.
        heading_rad: Anticlockwise from east.

    Example:
        >>> north, east, down = body_to_ned((1.0, 0.0, 0.2), 0.0)  # looks east
        >>> round(north, 6), round(east, 6), round(down, 6)
        (0.0, 1.0, -0.2)
    """
    forward, left, up = velocity_m_s
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    return sin * forward + cos * left, cos * forward - sin * left, -up


def ned_to_body(velocity_m_s: tuple[float, float, float], heading_rad: float) -> tuple[float, float, float]:
    """Turn north, east, down into a level body velocity (forward, left, up)."""
    north, east, down = velocity_m_s
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    return sin * north + cos * east, cos * north - sin * east, -down


def flip(forward: float, left: float, up: float) -> tuple[float, float, float]:
    """Turn forward, left, up into forward, right, down; or back."""
    return forward, -left, -up


def ned_to_enu(north: float, east: float, down: float) -> Float[np.ndarray, " 3"]:
    """Turn north, east, down into east, north, up."""
    return np.array([east, north, -down])


def heading_of(yaw_rad: float) -> float:
    """Turn a yaw (clockwise from north) into a heading (anticlockwise from east) within (-pi, pi]; or back.

    Example:
        >>> heading_of(0.0) == math.pi / 2  # north
        True
    """
    return -((yaw_rad + math.pi / 2) % (2 * math.pi) - math.pi)


def attitude_of(roll_rad: float, pitch_rad: float, yaw_rad: float) -> tuple[float, float, float]:
    """Turn MAVLink's roll, pitch, yaw (FRD to NED) into roll, pitch, heading (FLU to ENU); or back.

    Forward is one axis for both, so roll keeps its sign; left is not right, so pitch changes it.
    """
    return roll_rad, -pitch_rad, heading_of(yaw_rad)
