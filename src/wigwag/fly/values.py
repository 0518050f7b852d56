"""What is asked of the drone, what it is told, and what it says of itself."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float


class Command(StrEnum):
    """What a gesture asks of the drone. Left and right are the operator's own, facing the drone."""

    TAKE_OFF = "take_off"
    LAND = "land"
    STOP = "stop"
    LEFT = "left"
    RIGHT = "right"
    UP = "up"
    DOWN = "down"
    CLOSER = "closer"
    FARTHER = "farther"
    ORBIT = "orbit"


@dataclass(frozen=True, slots=True)
class Setpoint:
    """A velocity for the drone, body FLU frame (x forward, y left, z up), as in ROS REP 103."""

    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Forward, left, up; level with the ground whatever the drone's tilt."""
    yaw_rate_rad_s: float = 0.0
    """Positive turns left (anticlockwise seen from above)."""


HOVER = Setpoint()
"""Stay where you are, as you are turned."""


@dataclass(frozen=True, slots=True)
class VehicleState:
    """What the drone says of itself."""

    position_m: Float[np.ndarray, 3]
    """World frame, ENU (x east, y north, z up), metres from where it was switched on."""
    velocity_m_s: Float[np.ndarray, 3]
    """World frame, ENU."""
    heading_rad: float
    """Anticlockwise from east; 0 looks along world +x."""
    stamp_ns: int
    """Monotonic nanoseconds."""
    roll_rad: float = 0.0
    """Roll of the body, FLU: positive lifts the left side."""
    pitch_rad: float = 0.0
    """Pitch of the body, FLU: positive puts the nose down."""
    armed: bool = True
    """Whether the propellers may turn."""
