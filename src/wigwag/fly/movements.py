"""Commands as bounded movements on top of the follow law."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from wigwag.fly.follow import Goal, wrap
from wigwag.fly.values import Command


@dataclass(frozen=True, slots=True)
class MovementConfig:
    """How far and how fast each command moves the drone, and the bounds it stays within."""

    sideways_m: float = 1.0
    """Length of the arc flown on left and right."""
    sideways_m_s: float = 0.5
    altitude_step_m: float = 0.3
    climb_m_s: float = 0.4
    distance_step_m: float = 0.6
    distance_m_s: float = 0.4
    orbit_rad: float = 2 * np.pi
    """Angle flown around the operator on orbit; any other command ends it sooner."""
    orbit_m_s: float = 0.6
    slowing_1_s: float = 1.6
    """Speed for each metre that is left of the way: every movement ends gently."""
    near_m: float = 0.03
    """So near its end a movement has ended."""
    patience_s: float = 4.0
    """Longer than it should take, by this and half as much again, a movement gives up."""
    min_distance_m: float = 2.8
    max_distance_m: float = 5.5
    min_altitude_m: float = 0.8
    max_altitude_m: float = 2.0


class Movement:
    """The movement in progress, if any: it moves the follow law's goal until its end is reached.

    Args:
        config: Sizes, speeds and bounds.
        goal: Where to start.
    """

    def __init__(self, config: MovementConfig | None = None, goal: Goal | None = None) -> None:
        self.config = config or MovementConfig()
        self.goal = goal or Goal()
        self.command: Command | None = None
        """What is under way."""
        self._target = self.goal
        self._side, self._arc_left_rad = 0.0, 0.0
        self._angle_rad: float | None = None
        self._left_s = 0.0

    def start(self, command: Command) -> None:
        """Begin a movement; it replaces the one in progress.

        The operator faces the drone, so the operator's left is the drone's right.
        """
        config = self.config
        self.goal = self._target = replace(self.goal, tangential_m_s=0.0, receding_m_s=0.0, climbing_m_s=0.0)
        self._angle_rad, self._arc_left_rad = None, 0.0
        self.command = command
        sideways_rad = config.sideways_m / self.goal.distance_m
        match command:
            case Command.LEFT:
                self._arc(sideways_rad, -config.sideways_m_s)
            case Command.RIGHT:
                self._arc(sideways_rad, config.sideways_m_s)
            case Command.ORBIT:
                self._arc(config.orbit_rad, config.orbit_m_s)
            case Command.UP:
                self._climb(config.altitude_step_m)
            case Command.DOWN:
                self._climb(-config.altitude_step_m)
            case Command.CLOSER:
                self._approach(-config.distance_step_m)
            case Command.FARTHER:
                self._approach(config.distance_step_m)
            case _:
                self.command = None  # stop, take off and land are the supervisor's

    def cancel(self, distance_m: float, altitude_m: float) -> None:
        """End the movement where the drone is; what it has there becomes the goal, within bounds."""
        config = self.config
        self.goal = self._target = Goal(
            float(np.clip(distance_m, config.min_distance_m, config.max_distance_m)),
            float(np.clip(altitude_m, config.min_altitude_m, config.max_altitude_m)),
        )
        self.command = None

    def approach(self, distance_m: float, altitude_m: float, wanted: Goal) -> None:
        """Begin where the drone is and move smoothly to what is wanted."""
        self.goal = replace(wanted, distance_m=distance_m, altitude_m=altitude_m)
        self._target = wanted
        self.command = Command.TAKE_OFF
        self._give(
            abs(distance_m - wanted.distance_m) / self.config.distance_m_s
            + abs(altitude_m - wanted.altitude_m) / self.config.climb_m_s
        )

    def update(
        self,
        dt_s: float,
        drone_m: Float[np.ndarray, " 3"],
        operator_m: Float[np.ndarray, " 3"],
        altitude_m: float | None = None,
    ) -> Goal:
        """Move the goal on by ``dt_s`` and return it.

        Args:
            dt_s: Seconds since the last call.
            drone_m: Where the drone will be when the vehicle answers, world ENU.
            operator_m: Where the operator will be then, world ENU.
            altitude_m: The drone's height then, counted as the goal's is; its own if ``None``.
        """
        if self.command is None:
            return self.goal
        self._left_s -= dt_s
        if self._left_s < 0:
            offset = (drone_m - operator_m)[:2]
            height = float(drone_m[2]) if altitude_m is None else altitude_m
            self.cancel(float(np.hypot(offset[0], offset[1])), height)
        elif self._side:
            self._go_around(drone_m, operator_m)
        else:
            self._go_straight(dt_s)
        return self.goal

    def _go_around(self, drone_m: Float[np.ndarray, " 3"], operator_m: Float[np.ndarray, " 3"]) -> None:
        """Fly on along the arc, slower towards its end."""
        config, offset = self.config, (drone_m - operator_m)[:2]
        angle = math.atan2(offset[1], offset[0])
        if self._angle_rad is not None:
            # The drone looks at the operator: moving to its own left takes it clockwise around them.
            self._arc_left_rad += wrap(angle - self._angle_rad) * math.copysign(1.0, self._side)
        self._angle_rad = angle
        left_m = self._arc_left_rad * self.goal.distance_m
        if left_m <= config.near_m:
            self.goal, self.command, self._side = replace(self.goal, tangential_m_s=0.0), None, 0.0
            return
        speed = min(abs(self._side), config.slowing_1_s * left_m)
        self.goal = replace(self.goal, tangential_m_s=math.copysign(speed, self._side))

    def _go_straight(self, dt_s: float) -> None:
        """Move distance and altitude on towards the target, slower towards their end."""
        config = self.config
        distance, receding = self._on(
            self.goal.distance_m, self._target.distance_m, config.distance_m_s, dt_s
        )
        altitude, climbing = self._on(self.goal.altitude_m, self._target.altitude_m, config.climb_m_s, dt_s)
        self.goal = Goal(distance, altitude, 0.0, receding, climbing)
        if self.goal == self._target:
            self.command = None

    def _on(self, value: float, target: float, speed: float, dt_s: float) -> tuple[float, float]:
        """Return a value moved on towards its target, and its speed."""
        left = target - value
        if abs(left) <= self.config.near_m / 3:
            return target, 0.0
        rate = math.copysign(min(speed, self.config.slowing_1_s * abs(left)), left)
        return value + rate * dt_s, rate

    def _arc(self, angle_rad: float, tangential_m_s: float) -> None:
        self._arc_left_rad, self._side = angle_rad, tangential_m_s
        self.goal = replace(self.goal, tangential_m_s=tangential_m_s)
        self._give(angle_rad * self.goal.distance_m / abs(tangential_m_s))

    def _climb(self, step_m: float) -> None:
        config, self._side = self.config, 0.0
        altitude = float(np.clip(self.goal.altitude_m + step_m, config.min_altitude_m, config.max_altitude_m))
        self._target = replace(self.goal, altitude_m=altitude)
        self._give(abs(step_m) / config.climb_m_s)

    def _approach(self, step_m: float) -> None:
        config, self._side = self.config, 0.0
        distance = float(np.clip(self.goal.distance_m + step_m, config.min_distance_m, config.max_distance_m))
        self._target = replace(self.goal, distance_m=distance)
        self._give(abs(step_m) / config.distance_m_s)

    def _give(self, needed_s: float) -> None:
        """Set the time after which the movement gives up."""
        self._left_s = 1.5 * needed_s + self.config.patience_s
