"""The follow law: keep the operator centred and at a set distance, while either of them moves."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.fly.operator import OperatorTrack
from wigwag.fly.smooth import Smoother
from wigwag.fly.values import Setpoint, VehicleState


@dataclass(frozen=True, slots=True)
class Goal:
    """What the follow law keeps, besides the operator in the middle of the picture."""

    distance_m: float = 4.5
    """Horizontal distance from drone to the operator's hips."""
    altitude_m: float = 1.2
    """Height above the point of take-off; it rises and sinks with the operator's hips."""
    angle_rad: float | None = None
    """Where the drone is, seen from the operator, anticlockwise from east; ``None``: wherever it is."""
    tangential_m_s: float = 0.0
    """How fast the angle changes, as a speed; positive moves the drone to its own left, clockwise."""
    receding_m_s: float = 0.0
    """How fast ``distance_m`` changes."""
    climbing_m_s: float = 0.0
    """How fast ``altitude_m`` changes."""


@dataclass(frozen=True, slots=True)
class FollowConfig:
    """Gains of the follow law. One set flies PX4, ArduCopter and the simulated quadrotor."""

    bearing_gain_1_s: float = 5.0
    distance_gain_1_s: float = 1.5
    angle_gain_1_s: float = 0.6
    """Of the way back to the goal's angle."""
    max_return_m_s: float = 0.4
    """That way is flown no faster."""
    altitude_gain_1_s: float = 2.0
    """Quick, for the drone's idea of its own height drifts, and the operator's hips tell."""
    velocity_delay_s: float = 0.30
    """From a velocity set-point to the motion (0.25 s on both autopilots, and its transport). The law answers
    where drone and operator will be after so long: which damps the distance."""
    yaw_delay_s: float = 0.15
    """From a yaw-rate set-point to the turn."""
    max_speed_m_s: float = 1.5
    """Horizontal."""
    max_acceleration_m_s2: float = 1.2
    """The velocity asked for changes no faster than this. To accelerate is to tilt, and to tilt a camera that
    is fixed to the drone: answering an operator's lunge with 2.5 m/s2 puts them out of the picture."""
    max_jerk_m_s3: float = 10.0
    """Nor does its change begin or end more suddenly."""
    max_yaw_acceleration_rad_s2: float = 5.0


class FollowLaw:
    """Velocity and yaw rate that keep the operator centred at the goal's distance.

    Proportional control alone trails a walking person, and oscillates when the vehicle answers late. The
    operator's own velocity and the rotation of the line of sight are therefore fed forward, and both errors
    are those of the moment at which the vehicle will answer (a predictor of the dead time, after Smith 1957).

    Args:
        config: Gains.
    """

    def __init__(self, config: FollowConfig | None = None) -> None:
        self.config = c = config or FollowConfig()
        self._velocity = Smoother(c.max_acceleration_m_s2, c.max_jerk_m_s3)
        self._yaw_rate: float | None = None
        self._turned: deque[tuple[int, float]] = deque()
        """Turns asked for of late, that the heading may not show yet."""
        self._flown: deque[tuple[int, Float[np.ndarray, " 3"]]] = deque()
        """Ways asked for of late, world ENU, that the position may not show yet."""
        self._last_ns = 0
        self.level_m: float | None = None
        """Height of the operator's hips that goes with the goal's altitude."""

    def reset(self) -> None:
        """Forget what was asked for last, as after holding or landing."""
        self._velocity.reset()
        self._yaw_rate = None
        self._turned.clear()
        self._flown.clear()

    def level(self, hips_m: float) -> None:
        """Take the goal's altitude as meant for an operator whose hips are at this height."""
        self.level_m = hips_m

    def setpoint(self, track: OperatorTrack, state: VehicleState, goal: Goal, now_ns: int) -> Setpoint:
        """Return the set-point for now.

        Args:
            track: The operator's track, seen at least once.
            state: The drone's newest state.
            goal: What to keep.
            now_ns: Monotonic nanoseconds.
        """
        step_s = self._step_s(now_ns)
        velocity = self._wanted_velocity(track, state, goal, now_ns, step_s)
        yaw_rate = self._wanted_yaw_rate(track, state, now_ns, step_s)
        cos, sin = math.cos(state.heading_rad), math.sin(state.heading_rad)
        forward = cos * velocity[0] + sin * velocity[1]
        leftward = -sin * velocity[0] + cos * velocity[1]
        return Setpoint((float(forward), float(leftward), float(velocity[2])), yaw_rate)

    def turn(self, track: OperatorTrack, state: VehicleState, now_ns: int) -> Setpoint:
        """Return the set-point that turns to the operator and stays in place. Arguments: see ``setpoint``."""
        self._velocity.reset()
        return Setpoint((0.0, 0.0, 0.0), self._wanted_yaw_rate(track, state, now_ns, self._step_s(now_ns)))

    def places(
        self, track: OperatorTrack, state: VehicleState, now_ns: int
    ) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
        """Return where drone and operator will be when the vehicle answers, world ENU.

        The drone will have flown all that has been asked of it.
        """
        drone = state.position_m + _coming(self._flown, state.stamp_ns, self.config.velocity_delay_s)
        operator = track.position_m(now_ns) + track.velocity_m_s * self.config.velocity_delay_s
        return np.asarray(drone), np.asarray(operator)

    def _step_s(self, now_ns: int) -> float:
        """Return the time since the last set-point, as far as it is believed."""
        step_s = (now_ns - self._last_ns) * 1e-9
        self._last_ns = now_ns
        return min(step_s, 0.2) if step_s > 0 else 0.0

    def _after(
        self, track: OperatorTrack, state: VehicleState, now_ns: int, delay_s: float
    ) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
        old_s = min(max((now_ns - state.stamp_ns) * 1e-9, 0.0), 0.3)
        drone = state.position_m + state.velocity_m_s * (old_s + delay_s)
        operator = track.position_m(now_ns) + track.velocity_m_s * delay_s
        return np.asarray(drone), np.asarray(operator)

    def _wanted_velocity(
        self, track: OperatorTrack, state: VehicleState, goal: Goal, now_ns: int, step_s: float
    ) -> Float[np.ndarray, " 3"]:
        config = self.config
        drone, operator = self.places(track, state, now_ns)
        ahead, distance = _sight(drone, operator)
        left = np.array([-ahead[1], ahead[0]])
        # eq. follow distance: v = v_operator + k (d - d_goal) - d_goal' along the line of sight, across it
        # v_t + k (angle - angle_goal) d; all as it will be once the vehicle answers
        along = config.distance_gain_1_s * (distance - goal.distance_m) - goal.receding_m_s
        across = goal.tangential_m_s
        if goal.angle_rad is not None:
            behind = wrap(math.atan2(-ahead[1], -ahead[0]) - goal.angle_rad) * distance
            most = config.max_return_m_s
            across += min(max(config.angle_gain_1_s * behind, -most), most)
        level = track.velocity_m_s[:2] + along * ahead + across * left
        speed = math.hypot(level[0], level[1])
        if speed > config.max_speed_m_s:
            level = level * (config.max_speed_m_s / speed)
        # eq. follow altitude: as high over the operator's hips as the goal is over the level they began at
        error = goal.altitude_m + self.rise(track) - float(drone[2])
        climb = config.altitude_gain_1_s * error + goal.climbing_m_s
        velocity = self._velocity(np.array([level[0], level[1], climb]), step_s)
        self._flown.append((now_ns, velocity * step_s))
        return velocity

    def _wanted_yaw_rate(
        self, track: OperatorTrack, state: VehicleState, now_ns: int, step_s: float
    ) -> float:
        config = self.config
        drone, operator = self._after(track, state, now_ns, config.yaw_delay_s)
        ahead, distance = _sight(drone, operator)
        coming = _coming(self._turned, state.stamp_ns, config.yaw_delay_s)
        # eq. follow bearing: yaw rate = k bearing + rotation of the line of sight; the bearing as it will be
        # once all is turned that has been asked for
        bearing = wrap(math.atan2(ahead[1], ahead[0]) - state.heading_rad - coming)
        relative = (track.velocity_m_s - state.velocity_m_s)[:2]
        sight_rate = float(relative[1] * ahead[0] - relative[0] * ahead[1]) / distance
        wanted = config.bearing_gain_1_s * bearing + sight_rate
        if self._yaw_rate is not None:
            most = config.max_yaw_acceleration_rad_s2 * step_s
            wanted = min(max(wanted, self._yaw_rate - most), self._yaw_rate + most)
        self._yaw_rate = wanted
        self._turned.append((now_ns, wanted * (step_s or 1 / 30)))
        return wanted

    def rise(self, track: OperatorTrack) -> float:
        """Return how far the operator has risen above the level they began at, metres."""
        return 0.0 if self.level_m is None else track.height_m - self.level_m


def _coming(asked: deque[tuple[int, Any]], stamp_ns: int, delay_s: float) -> Any:
    """Add up what was asked for and cannot be seen yet in a state of this stamp; forget what can."""
    seen_ns = stamp_ns - round(delay_s * 1e9)
    while asked and asked[0][0] < seen_ns:
        asked.popleft()
    return sum((part for _, part in asked), 0.0)


def _sight(
    drone_m: Float[np.ndarray, " 3"], operator_m: Float[np.ndarray, " 3"]
) -> tuple[Float[np.ndarray, " 2"], float]:
    """Return the unit vector from drone to operator, seen from above, and the distance (0.3 m at least)."""
    east, north = float(operator_m[0] - drone_m[0]), float(operator_m[1] - drone_m[1])
    distance = max(math.hypot(east, north), 0.3)
    return np.array([east / distance, north / distance]), distance


def wrap(angle_rad: float) -> float:
    """Bring an angle into (-pi, pi].

    Example:
        >>> round(wrap(3 * 3.141592653589793), 6)
        3.141593
    """
    return -((-angle_rad + np.pi) % (2 * np.pi) - np.pi)
