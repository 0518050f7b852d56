"""Somebody else: walks through the picture on lines, stops where told, and shows gestures of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.sim.motion import Operator, wrap
from wigwag.sim.person import Person
from wigwag.sim.script import Act, Script, Walk


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight stretch of a way.

    Raises:
        InputError: If the speed is not above 0, or the pause is negative.
    """

    to_m: tuple[float, float]
    """Where it ends, x and y, world ENU, metres."""
    speed_m_s: float = 1.3
    pause_s: float = 0.0
    """How long the person stands at its end."""

    def __post_init__(self) -> None:
        """Check what would make time stand still."""
        if not self.speed_m_s > 0 or not self.pause_s >= 0:
            raise InputError(
                f"Leg needs speed_m_s above 0 and pause_s of 0 or more, but got {self.speed_m_s} and "
                f"{self.pause_s}."
            )


def plan_way(
    start_m: tuple[float, float], legs: Sequence[Leg], begin_s: float = 0.0
) -> tuple[tuple[Walk, ...], tuple[float, ...]]:
    """Turn a way into walks.

    Args:
        start_m: Where it begins, x and y, world ENU, metres.
        legs: Its stretches, in order.
        begin_s: When it begins, seconds of the session.

    Returns:
        A walk a leg, and when each of them ends.

    Example:
        >>> walks, ends = plan_way((0.0, 0.0), [Leg((0.0, 2.6), speed_m_s=1.3)])
        >>> ends
        (2.5,)
    """
    walks, ends = [], []
    here, now_s = np.asarray(start_m, dtype=np.float64), begin_s
    for leg in legs:
        span = np.asarray(leg.to_m) - here
        length = float(np.hypot(*span))
        # Getting going and stopping take half a second each at half the speed; a short leg is slower.
        duration = max(length / leg.speed_m_s + 0.5, 1.0)
        speed = length / (duration - 0.5)
        walks.append(Walk(now_s, duration, float(np.arctan2(span[1], span[0])), speed))
        ends.append(now_s + duration)
        here, now_s = np.asarray(leg.to_m, dtype=np.float64), now_s + duration + leg.pause_s
    return tuple(walks), tuple(ends)


def beside(distance_m: float, side: float) -> tuple[float, float]:
    """Return a place at the edge of what a drone at the origin sees, or 2.6 m aside if that is nearer.

    Args:
        distance_m: Along the line of sight, east.
        side: 1 to the left of it, -1 to the right.
    """
    return distance_m, side * min(0.52 * distance_m + 0.7, 2.6)


def crossings(
    distance_m: float, count: int, rng: np.random.Generator
) -> tuple[tuple[float, float], list[list[Leg]]]:
    """Plan a way that crosses before and behind an operator by turns.

    Args:
        distance_m: From a drone at the origin to the operator, along the line of sight, east.
        count: How often.
        rng: Chooses how far before and behind (0.8 to 1.5 m) and how fast (1.0 to 1.6 m/s).

    Returns:
        Where the way begins, and the legs of each crossing.
    """
    start = beside(distance_m + 1.0, -1.0)
    ways: list[list[Leg]] = []
    side = -1.0
    for k in range(count):
        offset = float(rng.uniform(0.8, 1.5)) * (-1.0 if k % 2 == 0 else 1.0)
        speed = float(rng.uniform(1.0, 1.6))
        to, across = beside(distance_m + offset, side), beside(distance_m + offset, -side)
        ways.append([Leg(to, speed, 0.9), Leg(across, speed, 0.4)])
        side = -side
    return start, ways


class Passerby(Operator):
    """A person who goes their own way and faces where they go, also while standing.

    Args:
        person: Whose body and habits.
        start_m: Where they stand at first, x and y, world ENU, metres.
        legs: The way.
        begin_s: When they set out, seconds of the session.
        acts: Gestures that they show, wherever they are then.
        looks_at_drone: Whether they turn to the drone whenever they stand.
        seed: Chooses sway, trembling and the like.

    Example:
        >>> walker = Passerby(Person.random(9), (3.0, -2.0), [Leg((3.0, 2.0))])
        >>> for k in range(1, 151):
        ...     joints = walker.step(k / 30, 1 / 30, np.array([0.0, 0.0, 1.5]))
        >>> walker.root_xy.round(2).tolist()
        [3.0, 2.0]
    """

    def __init__(
        self,
        person: Person,
        start_m: tuple[float, float],
        legs: Sequence[Leg],
        begin_s: float = 0.0,
        *,
        acts: Sequence[Act] = (),
        looks_at_drone: bool = False,
        seed: int = 0,
    ) -> None:
        walks, self.ends_s = plan_way(start_m, legs, begin_s)
        heading = walks[0].direction_rad if walks else np.pi
        last_s = max([begin_s, *self.ends_s, *(act.end_s for act in acts)])
        script = Script(tuple(acts), walks, (), last_s)
        super().__init__(person, script, start_m, heading, seed)
        self._looks_at_drone = looks_at_drone
        self._course_rad = float(heading)

    def _face(self, dt_s: float, drone_xy: Float[np.ndarray, 2], turn: float) -> None:
        if self._walk < len(self.script.walks):
            walk = self.script.walks[self._walk]
            # They turn to where they will go shortly before they set out.
            if walk.start_s - dt_s <= self._last_time_s() + 1.2 and walk.speed_m_s > 0.05:
                self._course_rad = walk.direction_rad
                self._turn(wrap(self._course_rad - self.heading_rad), dt_s)
                return
        if self._looks_at_drone:
            span = drone_xy - self.root_xy
            self._course_rad = float(np.arctan2(span[1], span[0]))
        self._turn(wrap(self._course_rad - self.heading_rad), dt_s)

    def _last_time_s(self) -> float:
        return self._last_s if self._last_s is not None else 0.0
