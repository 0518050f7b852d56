"""The follow law and the movements, kept in step with what the supervisor decides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wigwag.fly.follow import FollowConfig, FollowLaw, Goal
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.movements import Movement, MovementConfig
from wigwag.fly.operator import OperatorTrack
from wigwag.fly.situation import Mode, Verdict
from wigwag.fly.values import HOVER, Setpoint, VehicleState
from wigwag.fly.view import View

_FLOWN = (Mode.FOLLOWING, Mode.EXECUTING)


class Helm:
    """Says what it would like to fly in each mode; what may be flown is the supervisor's word.

    Args:
        goal: What is kept after taking off.
        follow: Gains of the follow law.
        movement: Sizes and bounds of the commands' movements.
    """

    def __init__(
        self,
        goal: Goal | None = None,
        follow: FollowConfig | None = None,
        movement: MovementConfig | None = None,
    ) -> None:
        self.start = goal or Goal()
        self.law = FollowLaw(follow)
        self.bounds = movement or MovementConfig()
        self.movement = Movement(self.bounds, self.start)
        self._view: View | None = None
        self._blind = ""
        """What the camera does not see from where the flight is set to, for people to read."""
        self._last_ns: int | None = None

    @property
    def moving(self) -> bool:
        """Whether a movement is under way."""
        return self.movement.command is not None

    def keep_within(self, limits: SupervisorConfig) -> None:
        """Let neither goal nor movements lead beyond limits that have changed; what does not, stays."""
        near, far = limits.min_distance_m, limits.max_distance_m
        low, high = limits.floor_m, limits.ceiling_m
        bounds = self.bounds
        self.movement.bound(
            replace(
                bounds,
                min_distance_m=_between(bounds.min_distance_m, near, far),
                max_distance_m=_between(bounds.max_distance_m, near, far),
                min_altitude_m=_between(bounds.min_altitude_m, low, high),
                max_altitude_m=_between(bounds.max_altitude_m, low, high),
            )
        )

    def look(self, view: View) -> None:
        """Keep goal and movements to where a camera sees the operator from.

        The height and distance that the flight was set to are flown in any case: what is not seen from there
        need not be seen elsewhere.
        """
        self._view = view
        self._look()

    def enter(self, before: Mode, verdict: Verdict, track: OperatorTrack, state: VehicleState) -> str:
        """Take in what the supervisor has just decided.

        Returns:
            How what is flown differs from what was asked for, and why; empty if it does not. For people.
        """
        mode, told = verdict.mode, ""
        if mode in _FLOWN and before not in _FLOWN:
            if before is Mode.TAKING_OFF or self.law.level_m is None:
                self._level(track)
            self.law.reset()
            here = self._here(track, state)
            if before is Mode.TAKING_OFF:
                self.movement.approach(*here, self.start)
                told = self._blind
            else:
                self.movement.cancel(*here)
        elif before in _FLOWN and mode not in _FLOWN:
            self.movement.cancel(*self._here(track, state))
            self.law.reset()
        if verdict.accepted is not None and mode is Mode.EXECUTING:
            self.movement.start(verdict.accepted)
            told = self.movement.told
        return told

    def wish(self, mode: Mode, track: OperatorTrack, state: VehicleState, now_ns: int) -> Setpoint:
        """Return the set-point that is wanted in a mode.

        Args:
            mode: As decided for this turn.
            track: The operator's.
            state: The drone's newest.
            now_ns: Monotonic nanoseconds.
        """
        step_s = 0.0 if self._last_ns is None else (now_ns - self._last_ns) * 1e-9
        self._last_ns = now_ns
        if track.seen_ns is None or mode not in (*_FLOWN, Mode.HOLDING):
            return HOVER
        if mode is Mode.HOLDING:
            return self.law.turn(track, state, now_ns)
        if self.law.level_m is None:  # taken over in the air, and followed at once
            self._level(track)
        drone, operator = self.law.places(track, state, now_ns)
        height_m = float(drone[2]) - self.law.rise(track)
        goal = self.movement.update(min(max(step_s, 0.0), 0.2), drone, operator, height_m)
        return self.law.setpoint(track, state, goal, now_ns)

    def _level(self, track: OperatorTrack) -> None:
        """Take the height that is kept as meant for an operator who stands as they do now."""
        self.law.level(track.height_m)
        self._look()

    def _look(self) -> None:
        hips_m, start, self._blind = self.law.level_m, self.start, ""
        if self._view is None or hips_m is None:
            return
        seen = self._view.allowing(start.distance_m, start.altitude_m - hips_m)
        if seen != self._view:
            part = "you" if seen is None else "all of you"
            self._blind = (
                f"the camera does not see {part} from {start.altitude_m:g} m: tilt it, or fly otherwise"
            )
        self.movement.look(seen, hips_m)

    def _here(self, track: OperatorTrack, state: VehicleState) -> tuple[float, float]:
        """Return distance and height as the goal counts them."""
        away = (track.position_m(state.stamp_ns) - state.position_m)[:2]
        return float(np.hypot(away[0], away[1])), float(state.position_m[2]) - self.law.rise(track)


def _between(value: float, least: float, most: float) -> float:
    return min(max(value, least), most)
