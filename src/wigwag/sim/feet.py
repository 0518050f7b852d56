"""Where the feet stand, and when they step: planted feet that follow a moving, turning body."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from wigwag.sim.gestures import minimum_jerk
from wigwag.sim.person import Person

_YAW_WEIGHT_M = 0.25
"""Metres of displacement that a radian of misdirection counts as."""


class Feet:
    """Two feet on the ground. One steps at a time, when it has been left behind by the body.

    Walking in any direction, turning on the spot and small corrections all come out of one rule, and a
    planted foot never slides.

    Args:
        person: Gives the width of the stance.
        root_xy: Where the person stands, metres, world ENU.
        heading_rad: Where the person faces, anticlockwise from east.
    """

    def __init__(self, person: Person, root_xy: Float[np.ndarray, 2], heading_rad: float) -> None:
        self._half = person.stance_half_m
        self._lift = 0.05 * person.height_m
        self._where = np.stack([self._home(i, root_xy, heading_rad) for i in (0, 1)])
        self._height = np.zeros(2)
        self._swinging: int | None = None
        self._since_s = 0.0
        self._lasts_s = 0.45
        self._from = self._where[0].copy()
        self._rested_s = 1.0
        self._last = 1
        self._high = 1.0

    def _home(self, foot: int, root_xy: Float[np.ndarray, 2], heading_rad: float) -> Float[np.ndarray, 3]:
        """Return x, y and yaw of a foot that stands as it should."""
        side = 1.0 if foot == 0 else -1.0
        left = np.array([-np.sin(heading_rad), np.cos(heading_rad)])
        place = root_xy + side * self._half * left
        return np.array([place[0], place[1], heading_rad + side * 0.12])

    def step(
        self,
        dt_s: float,
        root_xy: Float[np.ndarray, 2],
        velocity_m_s: Float[np.ndarray, 2],
        heading_rad: float,
        turn_rate_rad_s: float,
    ) -> Float[np.ndarray, "2 4"]:
        """Go on by ``dt_s``.

        Returns:
            For the left and right foot x, y, height above flat standing (metres) and yaw (radians).
        """
        if self._swinging is None:
            self._rested_s += dt_s
            self._begin(root_xy, velocity_m_s, heading_rad)
        if self._swinging is not None:
            self._swing(dt_s, root_xy, velocity_m_s, heading_rad, turn_rate_rad_s)
        return np.column_stack([self._where[:, :2], self._height, self._where[:, 2]])

    def place(self, ankles_xy: Float[np.ndarray, "2 2"]) -> None:
        """Put both feet somewhere else at once (a recording has moved them)."""
        self._where[:, :2] = ankles_xy
        self._height[:] = 0
        self._swinging = None

    def stride(self, heading_rad: float) -> float:
        """How far the left foot is ahead of the right, metres."""
        ahead = np.array([np.cos(heading_rad), np.sin(heading_rad)])
        return float((self._where[0, :2] - self._where[1, :2]) @ ahead)

    def _begin(self, root_xy: np.ndarray, velocity: np.ndarray, heading: float) -> None:
        """Lift the foot that is left behind furthest, if far enough."""
        speed = float(np.hypot(*velocity))
        double_support_s = 0.05 if speed > 0.1 else 0.12
        if self._rested_s < double_support_s:
            return
        misplaced = np.zeros(2)
        for foot in (0, 1):
            off = self._home(foot, root_xy + 0.10 * velocity, heading) - self._where[foot]
            misplaced[foot] = np.hypot(off[0], off[1]) + _YAW_WEIGHT_M * abs(off[2])
        if speed > 0.1 and self._rested_s < 0.3:
            misplaced[self._last] *= 0.6  # walking goes left, right, left
        elif speed > 0.1:
            # The first step goes to where the body goes: to the left with the left foot.
            leftward = float(velocity @ np.array([-np.sin(heading), np.cos(heading)]))
            misplaced += 0.08 * np.array([np.sign(leftward), -np.sign(leftward)]) * (abs(leftward) > 0.05)
        foot = int(np.argmax(misplaced))
        if misplaced[foot] < 0.06:
            return
        self._swinging, self._last, self._since_s = foot, foot, 0.0
        # Walking sideways takes shorter, quicker steps, since the feet do not cross.
        across = abs(float(velocity @ np.array([-np.sin(heading), np.cos(heading)])))
        self._lasts_s = 0.46 - 0.10 * min(speed / 0.75, 1.0) - 0.10 * min(across / 0.75, 1.0)
        self._from = self._where[foot].copy()
        # Small steps are low.
        self._high = self._lift * min(1.0, 0.4 + misplaced[foot] / 0.3)

    def _uncrossed(self, foot: int, aim: Float[np.ndarray, 2], heading_rad: float) -> Float[np.ndarray, 2]:
        """Keep the aim of a foot on its own side of the other foot."""
        outward = np.array([-np.sin(heading_rad), np.cos(heading_rad)]) * (1.0 if foot == 0 else -1.0)
        apart = float((aim - self._where[1 - foot, :2]) @ outward)
        return aim + max(0.0, 1.1 * self._half - apart) * outward

    def _swing(
        self, dt_s: float, root_xy: np.ndarray, velocity: np.ndarray, heading: float, turn_rate: float
    ) -> None:
        """Carry the lifted foot on to where the body will need it."""
        foot = self._swinging
        assert foot is not None
        self._since_s += dt_s
        phase = min(self._since_s / self._lasts_s, 1.0)
        left_s = (1 - phase) * self._lasts_s
        # It lands ahead of the body by half of the time that it will then stand.
        ahead_s = left_s + 0.5 * (self._lasts_s + 0.05)
        aim = self._home(foot, root_xy + velocity * ahead_s, heading + turn_rate * left_s)
        aim[:2] = self._uncrossed(foot, aim[:2], heading)
        share = float(minimum_jerk(phase))
        self._where[foot] = (1 - share) * self._from + share * aim
        self._height[foot] = self._high * 16 * phase**2 * (1 - phase) ** 2
        if phase >= 1.0:
            self._swinging, self._rested_s = None, 0.0
            self._height[foot] = 0.0
