"""Commands as bounded movements on top of the follow law."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from wigwag.fly.follow import Goal, wrap
from wigwag.fly.values import Command
from wigwag.fly.view import View


@dataclass(frozen=True, slots=True)
class MovementConfig:
    """How far and how fast each command moves the drone, and the bounds it stays within."""

    sideways_m: float = 1.0
    """Length of the arc flown on left and right."""
    sideways_m_s: float = 0.5
    """Speed of that."""
    altitude_step_m: float = 0.4
    """How far up and down go: from the usual height once to the lower bound, twice to the upper."""
    climb_m_s: float = 0.4
    """Speed of that."""
    distance_step_m: float = 0.6
    """How far closer and farther go."""
    distance_m_s: float = 0.4
    """Speed of that."""
    orbit_rad: float = 2 * np.pi
    """Angle flown around the operator on orbit; any other command ends it sooner."""
    orbit_m_s: float = 0.6
    """Speed of that."""
    slowing_1_s: float = 1.6
    """Speed for each metre that is left of the way: every movement ends gently."""
    near_m: float = 0.01
    """So near its end a movement has ended."""
    lead_m: float = 0.5
    """A drone that is held up is waited for: the goal is no farther ahead of it than this."""
    patience_s: float = 4.0
    """Longer than it should take, by this and half as much again, a movement gives up."""
    min_distance_m: float = 2.8
    """No command leads closer."""
    max_distance_m: float = 5.5
    """No command leads farther away."""
    min_altitude_m: float = 0.8
    """No command leads lower."""
    max_altitude_m: float = 2.0
    """No command leads higher."""
    above_hips_m: float = 1.25
    """So much of the operator above their hips stays in a level camera's picture: raised hands. No command
    leads to where it would not; closer brings the height along."""
    below_hips_m: float = 0.5
    """So much below them: the knees."""
    view_margin_rad: float = 0.06
    """And so far from the picture's upper and lower edge, for a drone tilts to accelerate and in gusts."""


_TOLD_M = 0.05
"""A movement that differs by less is as asked for."""


class Movement:
    """The movement in progress, if any: it moves the follow law's goal until its end is reached.

    Distance, height and the angle around the operator are moved alike: at a set speed, gently at the end, and
    no farther ahead of the drone than ``lead_m``.

    Args:
        config: Sizes, speeds and bounds.
        goal: Where to start.
    """

    def __init__(self, config: MovementConfig | None = None, goal: Goal | None = None) -> None:
        self.config = config or MovementConfig()
        self.goal = goal or Goal()
        self.command: Command | None = None
        """What is under way."""
        self.told = ""
        """How the newest command differs from what was asked, and why; empty if it does not. For people."""
        self._view: View | None = None
        self._hips_m: float | None = None
        """Height of the operator's hips that goes with the goal's."""
        self._distance_m, self._altitude_m = self.goal.distance_m, self.goal.altitude_m
        self._arc_left_m, self._around_m_s = 0.0, 0.0
        self._left_s = 0.0

    def start(self, command: Command) -> None:
        """Begin a movement; it replaces the one in progress.

        The operator faces the drone, so the operator's left is the drone's right.
        """
        config = self.config
        self._stop()
        self.command, self.told = command, ""
        match command:
            case Command.LEFT:
                self._arc(config.sideways_m, -config.sideways_m_s)
            case Command.RIGHT:
                self._arc(config.sideways_m, config.sideways_m_s)
            case Command.ORBIT:
                self._arc(config.orbit_rad * self.goal.distance_m, config.orbit_m_s)
            case Command.UP:
                self._climb(command, config.altitude_step_m)
            case Command.DOWN:
                self._climb(command, -config.altitude_step_m)
            case Command.CLOSER:
                self._approach(command, -config.distance_step_m)
            case Command.FARTHER:
                self._approach(command, config.distance_step_m)
            case _:
                self.command = None  # stop, take off and land are the supervisor's

    def cancel(self, distance_m: float, altitude_m: float) -> None:
        """End the movement where the drone is; what it has there becomes the goal, within bounds."""
        self.goal = self.bounded(Goal(distance_m, altitude_m))
        self.command = None
        self._stop()

    def bound(self, config: MovementConfig) -> None:
        """Go on within other bounds: the goal, and where a movement leads, are brought inside them."""
        self.config = config
        self.goal = self.bounded(self.goal)
        end = self.bounded(Goal(self._distance_m, self._altitude_m))
        self._distance_m, self._altitude_m = end.distance_m, end.altitude_m

    def look(self, view: View | None, hips_m: float | None) -> None:
        """Go on with the operator in view: a bound like the others.

        Args:
            view: From where the camera sees them; ``None``: not known, any height will do.
            hips_m: Height of their hips that goes with the goal's, world ENU; ``None``: not known.
        """
        self._view, self._hips_m = view, hips_m
        self.bound(self.config)

    def heights_m(self, distance_m: float) -> tuple[float, float]:
        """Return the lowest and the highest that a goal may be at this distance: within bounds, and in view.

        Where the two contradict each other the bounds win.
        """
        least, most = self.config.min_altitude_m, self.config.max_altitude_m
        if self._view is None or self._hips_m is None:
            return least, most
        low, high = (min(max(h + self._hips_m, least), most) for h in self._view.heights_m(distance_m))
        return low, high

    def bounded(self, goal: Goal) -> Goal:
        """Return the goal within bounds."""
        c = self.config
        distance_m = float(np.clip(goal.distance_m, c.min_distance_m, c.max_distance_m))
        altitude_m = float(np.clip(goal.altitude_m, *self.heights_m(distance_m)))
        return replace(goal, distance_m=distance_m, altitude_m=altitude_m)

    def approach(self, distance_m: float, altitude_m: float, wanted: Goal) -> None:
        """Begin where the drone is and move smoothly to what is wanted, or to where bounds allow it."""
        end = self.bounded(wanted)
        self.goal = replace(end, distance_m=distance_m, altitude_m=altitude_m)
        self._stop()
        self._distance_m, self._altitude_m = end.distance_m, end.altitude_m
        self.command, self.told = Command.TAKE_OFF, ""
        self._give(
            abs(distance_m - end.distance_m) / self.config.distance_m_s
            + abs(altitude_m - end.altitude_m) / self.config.climb_m_s
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
        offset = (drone_m - operator_m)[:2]
        distance, angle = math.hypot(offset[0], offset[1]), math.atan2(offset[1], offset[0])
        height = float(drone_m[2]) if altitude_m is None else altitude_m
        if self.goal.angle_rad is None:
            self.goal = replace(self.goal, angle_rad=angle)
        if self.command is None:
            return self.goal
        self._left_s -= dt_s
        if self._left_s < 0:
            self.cancel(distance, height)
            return self.goal
        self._on(dt_s, distance, height, angle)
        if self._arrived():
            self.command = None
            self.goal = replace(self.goal, distance_m=self._distance_m, altitude_m=self._altitude_m)
            self._stop()
        return self.goal

    def _on(self, dt_s: float, distance_m: float, height_m: float, angle_rad: float) -> None:
        """Move every part of the goal on towards its end."""
        goal, config = self.goal, self.config
        assert goal.angle_rad is not None
        receding = self._rate(
            self._distance_m - goal.distance_m, config.distance_m_s, goal.distance_m - distance_m
        )
        climbing = self._rate(
            self._altitude_m - goal.altitude_m, config.climb_m_s, goal.altitude_m - height_m
        )
        # The drone looks at the operator: moving to its own left takes it clockwise around them.
        lead = wrap(angle_rad - goal.angle_rad) * goal.distance_m
        left = math.copysign(self._arc_left_m, self._around_m_s)
        around = self._rate(left, abs(self._around_m_s), lead)
        self._arc_left_m = max(0.0, self._arc_left_m - abs(around) * dt_s)
        self.goal = Goal(
            goal.distance_m + receding * dt_s,
            goal.altitude_m + climbing * dt_s,
            wrap(goal.angle_rad - around * dt_s / goal.distance_m),
            around, receding, climbing,
        )  # fmt: skip

    def _rate(self, left_m: float, speed_m_s: float, lead_m: float) -> float:
        """Return the speed of a part of the goal: gentle at its end, none while the drone is far behind."""
        if abs(left_m) <= self.config.near_m or lead_m * math.copysign(1.0, left_m) > self.config.lead_m:
            return 0.0
        return math.copysign(min(speed_m_s, self.config.slowing_1_s * abs(left_m)), left_m)

    def _arrived(self) -> bool:
        near = self.config.near_m
        return (
            abs(self._distance_m - self.goal.distance_m) <= near
            and abs(self._altitude_m - self.goal.altitude_m) <= near
            and self._arc_left_m <= near
        )

    def _stop(self) -> None:
        """Let the goal stay as it is."""
        self.goal = replace(self.goal, tangential_m_s=0.0, receding_m_s=0.0, climbing_m_s=0.0)
        self._distance_m, self._altitude_m = self.goal.distance_m, self.goal.altitude_m
        self._arc_left_m = self._around_m_s = 0.0

    def _arc(self, length_m: float, tangential_m_s: float) -> None:
        self._arc_left_m, self._around_m_s = length_m, tangential_m_s
        self._give(length_m / abs(tangential_m_s))

    def _climb(self, command: Command, step_m: float) -> None:
        low, high = self.heights_m(self.goal.distance_m)
        self._altitude_m = float(np.clip(self.goal.altitude_m + step_m, low, high))
        bound_m = self.config.max_altitude_m if step_m > 0 else self.config.min_altitude_m
        if self._altitude_m == bound_m:
            why = f"that is as {'high' if step_m > 0 else 'low'} as it goes"
        else:
            why = f"the camera would not see your {'legs; farther first' if step_m > 0 else 'raised hands'}"
        self._tell(command, self._altitude_m - self.goal.altitude_m, step_m, why)
        self._give(abs(step_m) / self.config.climb_m_s)

    def _approach(self, command: Command, step_m: float) -> None:
        """Go nearer or farther; where the height of now would lose the operator, it comes along."""
        c, goal = self.config, self.goal
        self._distance_m = float(np.clip(goal.distance_m + step_m, c.min_distance_m, c.max_distance_m))
        why = f"that is as {'far away' if step_m > 0 else 'near'} as it goes"
        if step_m < 0 and self._view is not None:
            nearest_m = min(self._view.nearest_m, goal.distance_m)
            if nearest_m > self._distance_m:
                self._distance_m = nearest_m
                why = "nearer, hands and knees do not fit into the picture"
        self._altitude_m = float(np.clip(goal.altitude_m, *self.heights_m(self._distance_m)))
        self._tell(command, self._distance_m - goal.distance_m, step_m, why)
        climb_m = self._altitude_m - goal.altitude_m
        if abs(climb_m) > _TOLD_M:
            said = f"the height changes by {climb_m:+.1f} m on the way, to keep you in the picture"
            self.told = f"{self.told}; {said}" if self.told else f"{command}: {said}"
        self._give(abs(step_m) / c.distance_m_s + abs(climb_m) / c.climb_m_s)

    def _tell(self, command: Command, way_m: float, asked_m: float, why: str) -> None:
        """Note that a movement is shorter than asked for, if it is."""
        way_m = max(math.copysign(1.0, asked_m) * way_m, 0.0)
        if way_m < _TOLD_M:
            self.told = f"{command}: stays where it is; {why}"
        elif way_m < abs(asked_m) - _TOLD_M:
            self.told = f"{command}: {way_m:.1f} m instead of {abs(asked_m):.1f} m; {why}"

    def _give(self, needed_s: float) -> None:
        """Set the time after which the movement gives up."""
        self._left_s = 1.5 * needed_s + self.config.patience_s
