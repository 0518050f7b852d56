"""The follow law: keep the operator centred and at a set distance, while either of them moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.fly.operator import OperatorTrack
from wigwag.fly.values import Setpoint, VehicleState


@dataclass(frozen=True, slots=True)
class Goal:
    """What the follow law keeps, besides the operator in the middle of the picture."""

    distance_m: float = 4.5
    """Horizontal distance from drone to the operator's hips."""
    altitude_m: float = 1.2
    """Height above the point of take-off."""
    tangential_m_s: float = 0.0
    """Speed around the operator; positive moves the drone to its own left."""


@dataclass(frozen=True, slots=True)
class FollowConfig:
    """Gains of the follow law. The defaults fly the simulated quadrotor."""

    bearing_gain_1_s: float = 3.0
    distance_gain_1_s: float = 1.2
    altitude_gain_1_s: float = 1.0
    max_acceleration_m_s2: float = 1.2
    """The velocity asked for changes no faster than this. To accelerate is to tilt, and to tilt a camera that
    is fixed to the drone: answering an operator's lunge with 2.5 m/s2 puts them out of the picture."""


class FollowLaw:
    """Velocity and yaw rate that keep the operator centred at the goal's distance.

    Proportional control alone trails a walking person; the operator's own velocity and the rotation of
    the line of sight are therefore fed forward (paper section 5; gains: see ``FollowConfig``).

    Args:
        config: Gains.
    """

    def __init__(self, config: FollowConfig | None = None) -> None:
        self.config = config or FollowConfig()
        self._last_velocity: Float[np.ndarray, " 3"] | None = None
        self._last_ns = 0

    def reset(self) -> None:
        """Forget the velocity asked for last, as after holding or landing."""
        self._last_velocity = None

    def setpoint(self, track: OperatorTrack, state: VehicleState, goal: Goal, now_ns: int) -> Setpoint:
        """Return the set-point for now.

        Args:
            track: The operator's track, seen at least once.
            state: The drone's newest state.
            goal: What to keep.
            now_ns: Monotonic nanoseconds.
        """
        to_operator = (track.position_m(now_ns) - state.position_m)[:2]
        distance = max(float(np.linalg.norm(to_operator)), 0.3)
        ahead = to_operator / distance
        left = np.array([-ahead[1], ahead[0]])
        operator_velocity = track.velocity_m_s[:2]
        # eq. follow distance: v = v_operator + k (d - d_goal) along the line of sight, + v_tangential across
        wanted = (
            operator_velocity
            + self.config.distance_gain_1_s * (distance - goal.distance_m) * ahead
            + goal.tangential_m_s * left
        )
        climb = self.config.altitude_gain_1_s * (goal.altitude_m - float(state.position_m[2]))
        velocity = self._limited(np.array([wanted[0], wanted[1], climb]), now_ns)
        # eq. follow bearing: yaw rate = k bearing + rotation of the line of sight
        bearing = wrap(float(np.arctan2(ahead[1], ahead[0])) - state.heading_rad)
        relative = operator_velocity - state.velocity_m_s[:2]
        sight_rate = float(left @ relative) / distance
        yaw_rate = self.config.bearing_gain_1_s * bearing + sight_rate
        cos, sin = np.cos(state.heading_rad), np.sin(state.heading_rad)
        forward = cos * velocity[0] + sin * velocity[1]
        leftward = -sin * velocity[0] + cos * velocity[1]
        return Setpoint((float(forward), float(leftward), float(velocity[2])), yaw_rate)

    def _limited(self, wanted: Float[np.ndarray, " 3"], now_ns: int) -> Float[np.ndarray, " 3"]:
        if self._last_velocity is not None:
            step_s = min(max((now_ns - self._last_ns) * 1e-9, 0.0), 0.2)
            change = wanted - self._last_velocity
            allowed = self.config.max_acceleration_m_s2 * step_s
            size = float(np.linalg.norm(change))
            if size > allowed:
                wanted = self._last_velocity + change * (allowed / size)
        self._last_velocity, self._last_ns = wanted, now_ns
        return wanted


def wrap(angle_rad: float) -> float:
    """Bring an angle into (-pi, pi].

    Example:
        >>> round(wrap(3 * 3.141592653589793), 6)
        3.141593
    """
    return -((-angle_rad + np.pi) % (2 * np.pi) - np.pi)
