"""Commands as bounded movements on top of the follow law."""

from __future__ import annotations

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
    coast_s: float = 0.3
    """A drone told to stop travels on for about this long; arcs end that much sooner."""
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
        self._target = self.goal
        self._arc_left_rad = 0.0
        self._angle_rad: float | None = None

    def start(self, command: Command) -> None:
        """Begin a movement; it replaces the one in progress.

        The operator faces the drone, so the operator's left is the drone's right.
        """
        config, goal = self.config, replace(self.goal, tangential_m_s=0.0)
        self.goal, self._target, self._angle_rad, self._arc_left_rad = goal, goal, None, 0.0
        self.command = command
        sideways_rad = config.sideways_m / goal.distance_m
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

    def approach(self, distance_m: float, wanted: Goal) -> None:
        """Begin where the drone is, at ``distance_m``, and move smoothly to what is wanted."""
        self.goal = replace(wanted, distance_m=distance_m)
        self._target = wanted
        self.command = Command.TAKE_OFF

    def update(
        self, dt_s: float, drone_m: Float[np.ndarray, " 3"], operator_m: Float[np.ndarray, " 3"]
    ) -> Goal:
        """Move the goal on by ``dt_s`` and return it.

        Args:
            dt_s: Seconds since the last call.
            drone_m: World ENU.
            operator_m: World ENU.
        """
        if self.command is None:
            return self.goal
        config = self.config
        if self.goal.tangential_m_s:
            offset = (drone_m - operator_m)[:2]
            angle = float(np.arctan2(offset[1], offset[0]))
            if self._angle_rad is not None:
                # The drone looks at the operator: moving to its own left takes it clockwise around them.
                flown = -wrap(angle - self._angle_rad) * np.sign(self.goal.tangential_m_s)
                self._arc_left_rad -= flown
            self._angle_rad = angle
            coast_m = abs(self.goal.tangential_m_s) * config.coast_s
            if self._arc_left_rad * self.goal.distance_m <= coast_m:
                self.goal = replace(self.goal, tangential_m_s=0.0)
                self.command = None
            return self.goal
        self.goal = Goal(
            _toward(self.goal.distance_m, self._target.distance_m, config.distance_m_s * dt_s),
            _toward(self.goal.altitude_m, self._target.altitude_m, config.climb_m_s * dt_s),
        )
        if self.goal == self._target:
            self.command = None
        return self.goal

    def _arc(self, angle_rad: float, tangential_m_s: float) -> None:
        self._arc_left_rad = angle_rad
        self.goal = replace(self.goal, tangential_m_s=tangential_m_s)

    def _climb(self, step_m: float) -> None:
        altitude = float(
            np.clip(self.goal.altitude_m + step_m, self.config.min_altitude_m, self.config.max_altitude_m)
        )
        self._target = replace(self.goal, altitude_m=altitude)

    def _approach(self, step_m: float) -> None:
        distance = float(
            np.clip(self.goal.distance_m + step_m, self.config.min_distance_m, self.config.max_distance_m)
        )
        self._target = replace(self.goal, distance_m=distance)


def _toward(value: float, target: float, step: float) -> float:
    return target if abs(target - value) <= step else value + float(np.copysign(step, target - value))
