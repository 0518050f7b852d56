"""What stands between every wish and the propellers: a pure state machine over values and a clock.

The supervisor knows no recogniser, no camera and no vehicle. It is told what is known (``Situation``),
and answers what may be done (``Verdict``). It keeps no clock of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from wigwag.fly.values import HOVER, Command, Setpoint


class Mode(StrEnum):
    """What the drone is allowed to be doing."""

    GROUNDED = "grounded"
    TAKING_OFF = "taking_off"
    FOLLOWING = "following"
    HOLDING = "holding"
    LOST_PERSON = "lost_person"
    LANDING = "landing"


class Action(StrEnum):
    """What the vehicle itself is to be asked, besides the set-point."""

    NONE = "none"
    TAKE_OFF = "take_off"
    LAND = "land"
    HOLD = "hold"


@dataclass(frozen=True, slots=True)
class SupervisorConfig:
    """Limits. They can be tightened; loosening them is at the user's own risk."""

    max_speed_m_s: float = 1.5
    """Horizontal."""
    max_climb_m_s: float = 0.6
    max_yaw_rate_rad_s: float = 1.2
    min_distance_m: float = 2.0
    """Horizontal distance to the operator below which the drone only retreats."""
    retreat_m_s: float = 0.6
    max_pose_age_s: float = 0.5
    """An operator not seen for this long is lost: the drone stops."""
    land_when_lost_s: float = 30.0
    """An operator lost for this long: the drone lands."""
    max_state_age_s: float = 0.5
    """A vehicle state older than this is no state: the drone stops."""


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known at one moment."""

    now_ns: int
    """Monotonic nanoseconds, the clock of the other stamps."""
    pose_ns: int | None
    """When the operator was last seen; ``None``: never."""
    state_ns: int
    """Stamp of the vehicle's newest state."""
    distance_m: float | None
    """Horizontal distance to the operator, where one is known."""
    bearing_rad: float
    """Where the operator stands from the drone's nose, positive to the left."""
    flying: bool
    """The vehicle is off the ground and takes set-points."""
    landed: bool
    """The vehicle stands on the ground with its motors off."""
    command: Command | None = None
    """What the operator asks for now; ``None`` most of the time."""
    wanted: Setpoint = HOVER
    """What the follow law would like."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What may be done."""

    mode: Mode
    setpoint: Setpoint
    action: Action = Action.NONE
    accepted: Command | None = None
    """The command, if it is let through to the movements."""
    reason: str = ""
    """Why a command or a set-point was changed. For people to read."""


class Supervisor:
    """The first supervisor: limits, minimum distance, person lost, frames stale; stop always wins.

    Args:
        config: Limits.
        mode: Where it begins: on the ground, or taking over a vehicle that hovers already.

    Example:
        >>> supervisor = Supervisor()
        >>> seen = Situation(10**9, 10**9, 10**9, 4.0, 0.0, flying=False, landed=True)
        >>> supervisor.step(replace(seen, command=Command.TAKE_OFF)).action
        <Action.TAKE_OFF: 'take_off'>
    """

    def __init__(self, config: SupervisorConfig | None = None, mode: Mode = Mode.GROUNDED) -> None:
        self.config = config or SupervisorConfig()
        self.mode = mode
        self._lost_ns: int | None = None

    def step(self, situation: Situation) -> Verdict:
        """Decide once. Call it at the loop's rate, also when nothing was seen."""
        verdict = self._command(situation) or self._watch(situation)
        self.mode = verdict.mode
        if self.mode is not Mode.LOST_PERSON:
            self._lost_ns = None
        return replace(verdict, setpoint=self.limited(verdict.setpoint))

    def limited(self, setpoint: Setpoint) -> Setpoint:
        """Clip a set-point to the limits; one that is not finite becomes standing still."""
        values = np.array([*setpoint.velocity_m_s, setpoint.yaw_rate_rad_s])
        if not np.isfinite(values).all():
            return HOVER
        speed = math.hypot(values[0], values[1])  # infinite, not an overflow, for what is absurdly fast
        if speed > self.config.max_speed_m_s:
            values[:2] *= self.config.max_speed_m_s / speed
        climb = float(np.clip(values[2], -self.config.max_climb_m_s, self.config.max_climb_m_s))
        yaw = float(np.clip(values[3], -self.config.max_yaw_rate_rad_s, self.config.max_yaw_rate_rad_s))
        return Setpoint((float(values[0]), float(values[1]), climb), yaw)

    def _command(self, now: Situation) -> Verdict | None:
        match now.command:
            case None:
                return None
            case Command.STOP if self.mode is Mode.GROUNDED:
                return Verdict(self.mode, HOVER, reason="stop: already on the ground")
            case Command.STOP:  # landing and taking off are cut short by holding, too
                return Verdict(Mode.HOLDING, HOVER, Action.HOLD, now.command, "stop")
            case Command.LAND if self.mode is not Mode.GROUNDED:
                return Verdict(Mode.LANDING, HOVER, Action.LAND, now.command)
            case Command.TAKE_OFF if self.mode is Mode.GROUNDED and now.landed and not self._blind(now):
                return Verdict(Mode.TAKING_OFF, HOVER, Action.TAKE_OFF, now.command)
            case Command.LAND | Command.TAKE_OFF:
                return None
            case _ if self.mode in (Mode.FOLLOWING, Mode.HOLDING) and not self._blind(now):
                return Verdict(Mode.FOLLOWING, self._kept_away(now), accepted=now.command)
        return None

    def _watch(self, now: Situation) -> Verdict:
        mode = self.mode
        if mode is Mode.GROUNDED:
            return Verdict(mode, HOVER)
        if mode is Mode.LANDING:
            return Verdict(Mode.GROUNDED if now.landed else mode, HOVER)
        if mode is Mode.TAKING_OFF:
            return Verdict(Mode.FOLLOWING if now.flying else mode, HOVER)
        if now.landed:
            return Verdict(Mode.GROUNDED, HOVER, reason="the vehicle landed by itself")
        if self._state_is_stale(now):
            return Verdict(mode, HOVER, Action.HOLD, reason="vehicle state is stale")
        if self._blind(now):
            return self._lost(now)
        if mode is Mode.HOLDING:
            turn = Setpoint((0.0, 0.0, 0.0), now.wanted.yaw_rate_rad_s)
            return Verdict(mode, self._kept_away(replace(now, wanted=turn)))
        return Verdict(Mode.FOLLOWING, self._kept_away(now))

    def _lost(self, now: Situation) -> Verdict:
        if self.mode is Mode.HOLDING:
            return Verdict(self.mode, HOVER, reason="operator not seen")
        if self._lost_ns is None:
            self._lost_ns = now.now_ns
        if (now.now_ns - self._lost_ns) * 1e-9 > self.config.land_when_lost_s:
            return Verdict(Mode.LANDING, HOVER, Action.LAND, reason="operator lost for too long")
        return Verdict(Mode.LOST_PERSON, HOVER, reason="operator not seen")

    def _blind(self, now: Situation) -> bool:
        if now.pose_ns is None or now.distance_m is None:
            return True
        return (now.now_ns - now.pose_ns) * 1e-9 > self.config.max_pose_age_s or self._state_is_stale(now)

    def _state_is_stale(self, now: Situation) -> bool:
        return (now.now_ns - now.state_ns) * 1e-9 > self.config.max_state_age_s

    def _kept_away(self, now: Situation) -> Setpoint:
        """Take out what brings the drone closer than the minimum, and retreat."""
        assert now.distance_m is not None
        if now.distance_m >= self.config.min_distance_m:
            return now.wanted
        ahead = np.array([np.cos(now.bearing_rad), np.sin(now.bearing_rad)])
        level = np.array(now.wanted.velocity_m_s[:2])
        approach = float(level @ ahead)
        level = level + (min(approach, -self.config.retreat_m_s) - approach) * ahead
        return replace(
            now.wanted, velocity_m_s=(float(level[0]), float(level[1]), now.wanted.velocity_m_s[2])
        )
