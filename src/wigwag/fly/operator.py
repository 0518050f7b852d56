"""Where the operator is and moves to, seen from a moving drone."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.fly.values import VehicleState
from wigwag.skeleton import Pose


@dataclass(frozen=True, slots=True)
class Mount:
    """How the camera sits on the drone."""

    pitch_down_rad: float = 0.0
    """Angle from the drone's forward axis down to the optical axis."""
    offset_m: tuple[float, float, float] = (0.1, 0.0, 0.0)
    """Optical centre in body FLU."""

    def to_body(self, point_m: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
        """Turn a point in the camera optical frame into body FLU, metres."""
        right, down, forward = point_m
        cos, sin = np.cos(self.pitch_down_rad), np.sin(self.pitch_down_rad)
        flu = np.array([cos * forward - sin * down, -right, -sin * forward - cos * down])
        return np.asarray(flu + self.offset_m)


def rotation(state: VehicleState) -> Float[np.ndarray, "3 3"]:
    """Return the rotation that takes body FLU to world ENU: heading, then pitch, then roll."""
    (ch, cp, cr) = (np.cos(a) for a in (state.heading_rad, state.pitch_rad, state.roll_rad))
    (sh, sp, sr) = (np.sin(a) for a in (state.heading_rad, state.pitch_rad, state.roll_rad))
    yaw = np.array([[ch, -sh, 0], [sh, ch, 0], [0, 0, 1]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return np.asarray(yaw @ pitch @ roll)


@dataclass(frozen=True, slots=True)
class TrackConfig:
    """Settings of the operator's track."""

    alpha: float = 0.30
    """Share of a measurement's surprise that goes into the position, at 30 Hz."""
    beta: float = 0.045
    """Share that goes into the velocity, at 30 Hz."""
    restart_after_s: float = 1.0
    """A gap after which the track begins anew instead of extrapolating."""
    max_speed_m_s: float = 3.0
    """A person on foot is not faster; the estimate is clipped to it."""
    slack_m: float = 0.8
    """Whoever is seen farther than this from where the operator can have walked to is somebody else."""
    reach_s: float = 2.0
    """The operator is not believed to have walked for longer than this while not seen."""
    height_s: float = 0.3
    """Time constant of the hips' height, which the drone's own height goes by."""
    history_s: float = 1.0
    """How long the drone's own states are remembered, so that a late frame meets the state of its time."""


class OperatorTrack:
    """The operator's hips in the world, by an alpha-beta filter.

    The hips are tracked and not the whole trunk: an arm before the chest puts its own depth into the
    shoulders' windows, and would move the drone.

    Args:
        config: Gains and limits.
        mount: How the camera sits on the drone.
    """

    def __init__(self, config: TrackConfig | None = None, mount: Mount | None = None) -> None:
        self.config = config or TrackConfig()
        self.mount = mount or Mount()
        self.seen_ns: int | None = None
        self.since_ns: int | None = None
        """Since when this person has been seen without a break of ``restart_after_s``."""
        self.person = 0
        """Counts up when whoever is tracked cannot be who was tracked before."""
        self.height_m = 0.0
        """Height of the hips, world ENU, smoothed."""
        self._position = np.zeros(3)
        self._velocity = np.zeros(3)
        self._stranger: tuple[Float[np.ndarray, " 3"], int] | None = None
        """Where somebody else was last seen, and since when."""
        self._states: deque[VehicleState] = deque()

    @property
    def velocity_m_s(self) -> Float[np.ndarray, " 3"]:
        """The operator's estimated velocity, world ENU."""
        return self._velocity

    def position_m(self, now_ns: int) -> Float[np.ndarray, " 3"]:
        """Return where the operator's hips should be now, world ENU, metres."""
        ahead_s = 0.0 if self.seen_ns is None else min((now_ns - self.seen_ns) * 1e-9, 0.5)
        return np.asarray(self._position + self._velocity * ahead_s)

    def observe_vehicle(self, state: VehicleState) -> None:
        """Remember where the drone is, so that later frames can be placed. States come in order of time."""
        self._states.append(state)
        oldest = state.stamp_ns - int(self.config.history_s * 1e9)
        while len(self._states) > 2 and self._states[0].stamp_ns < oldest:
            self._states.popleft()

    def observe(self, pose: Pose) -> bool:
        """Take in a pose: the drone's state at its stamp places it in the world.

        Poses that are not newer than the last one are ignored. So is somebody who is where the operator
        cannot be, until they have been there for ``restart_after_s``: then they are tracked, as another
        ``person``.

        Returns:
            Whether it is the tracked person's.
        """
        if not self._states or (self.seen_ns is not None and pose.stamp_ns <= self.seen_ns):
            return False
        config, measured = self.config, self._in_world(pose)
        gap_s = np.inf if self.seen_ns is None else (pose.stamp_ns - self.seen_ns) * 1e-9
        if self.seen_ns is not None and self._is_elsewhere(measured, gap_s):
            if not self._settled(measured, pose.stamp_ns, gap_s):
                return False
            self.person += 1
            gap_s = np.inf
        self._stranger = None
        if gap_s > config.restart_after_s:
            self._position, self._velocity = measured, np.zeros(3)
            self.height_m, self.since_ns = float(measured[2]), pose.stamp_ns
        else:
            self._filter(measured, gap_s)
        self.seen_ns = pose.stamp_ns
        return True

    def _is_elsewhere(self, measured: Float[np.ndarray, " 3"], gap_s: float) -> bool:
        """Say whether the operator cannot be there: too far to walk, or where somebody else was just seen."""
        config = self.config
        surprise = measured - (self._position + self._velocity * min(gap_s, 0.5))
        away_m = float(np.hypot(surprise[0], surprise[1]))
        if self._stranger is not None and self._near_stranger(measured):
            return away_m > config.slack_m
        return away_m > config.slack_m + config.max_speed_m_s * min(gap_s, config.reach_s)

    def _near_stranger(self, measured: Float[np.ndarray, " 3"]) -> bool:
        if self._stranger is None:
            return False
        away = measured - self._stranger[0]
        return bool(np.hypot(away[0], away[1]) <= self.config.slack_m)

    def _settled(self, measured: Float[np.ndarray, " 3"], stamp_ns: int, gap_s: float) -> bool:
        """Say whether somebody else has been seen for long enough, in one place, to be tracked instead."""
        if self._stranger is None or not self._near_stranger(measured):
            self._stranger = (measured, stamp_ns)
            return gap_s > self.config.reach_s
        since_ns = self._stranger[1]
        self._stranger = (measured, since_ns)
        return (stamp_ns - since_ns) * 1e-9 >= self.config.restart_after_s

    def _filter(self, measured: Float[np.ndarray, " 3"], gap_s: float) -> None:
        """Weigh a measurement against the prediction, as an alpha-beta filter does."""
        predicted = self._position + self._velocity * gap_s
        surprise = measured - predicted
        # The gains are stated at 30 Hz; a slower stream weighs each measurement more.
        frames = gap_s * 30.0
        alpha = 1.0 - (1.0 - self.config.alpha) ** frames
        beta = min(self.config.beta * frames, 1.0)
        self._position = predicted + alpha * surprise
        self._velocity = self._velocity + beta * surprise / gap_s
        speed = float(np.linalg.norm(self._velocity))
        if speed > self.config.max_speed_m_s:
            self._velocity = self._velocity * (self.config.max_speed_m_s / speed)
        self.height_m += (1.0 - np.exp(-gap_s / self.config.height_s)) * (float(measured[2]) - self.height_m)

    def _in_world(self, pose: Pose) -> Float[np.ndarray, " 3"]:
        state = self.state_at(pose.stamp_ns)
        body = self.mount.to_body(pose.hip_center)
        return np.asarray(state.position_m + rotation(state) @ body)

    def state_at(self, stamp_ns: int) -> VehicleState:
        """Return the drone's state at a stamp, interpolated; there must have been one."""
        after = next((s for s in self._states if s.stamp_ns >= stamp_ns), self._states[-1])
        before = next((s for s in reversed(self._states) if s.stamp_ns <= stamp_ns), self._states[0])
        if after.stamp_ns <= before.stamp_ns:
            return before
        share = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)

        def angle(a: float, b: float) -> float:
            return a + share * float(np.angle(np.exp(1j * (b - a))))

        return VehicleState(
            before.position_m + share * (after.position_m - before.position_m),
            before.velocity_m_s + share * (after.velocity_m_s - before.velocity_m_s),
            angle(before.heading_rad, after.heading_rad),
            stamp_ns,
            angle(before.roll_rad, after.roll_rad),
            angle(before.pitch_rad, after.pitch_rad),
            after.armed,
        )
