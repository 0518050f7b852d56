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
    """World frame, ENU (x east, y north, z up), metres from where it was switched on; the height is counted
    from where it was armed."""
    velocity_m_s: Float[np.ndarray, 3]
    """World frame, ENU."""
    heading_rad: float
    """Anticlockwise from east; 0 looks along world +x."""
    stamp_ns: int
    """Monotonic nanoseconds; of the oldest part that is flown by (position, velocity, attitude)."""
    roll_rad: float = 0.0
    """Roll of the body, FLU: positive lifts the left side."""
    pitch_rad: float = 0.0
    """Pitch of the body, FLU: positive puts the nose down."""
    armed: bool = True
    """Whether the propellers may turn."""
    position_ns: int | None = None
    """When position and velocity were measured; a position that is repeated unchanged in flight grows old.
    ``None``: at ``stamp_ns``."""
    attitude_ns: int | None = None
    """When heading, roll and pitch were measured; ``None``: at ``stamp_ns``."""
    link_ns: int | None = None
    """When the vehicle was last heard of at all; ``None``: at ``stamp_ns``."""
    battery: float | None = None
    """Share of the charge that is left, 0 to 1; ``None``: not known."""
    battery_v: float | None = None
    """Volts; ``None``: not known."""
    healthy: bool = True
    """Whether the vehicle's own checks allow it to be armed, or to fly on."""
    trouble: str = ""
    """What its checks complain about, in its own words. For people to read."""
    denied: str = ""
    """The last request that it refused or never answered, and why; empty once a later one is accepted."""

    def position_age_s(self, now_ns: int) -> float:
        """Return how old position and velocity are, seconds."""
        return (now_ns - (self.stamp_ns if self.position_ns is None else self.position_ns)) * 1e-9

    def attitude_age_s(self, now_ns: int) -> float:
        """Return how old heading, roll and pitch are, seconds."""
        return (now_ns - (self.stamp_ns if self.attitude_ns is None else self.attitude_ns)) * 1e-9

    def link_age_s(self, now_ns: int) -> float:
        """Return how long nothing was heard of the vehicle, seconds."""
        return (now_ns - (self.stamp_ns if self.link_ns is None else self.link_ns)) * 1e-9
