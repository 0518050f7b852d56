"""Where the drone may be: a cylinder or a polygon, seen from above."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from wigwag.errors import InputError


class Wall(NamedTuple):
    """A limit near a place: a unit vector towards it, world ENU, and how far away it is."""

    east: float
    north: float
    distance_m: float
    """Negative outside; then the vector points farther out."""


class Fence(Protocol):
    """A region that the drone does not leave."""

    def walls(self, east_m: float, north_m: float) -> Sequence[Wall]:
        """Return the limits seen from a place, all that matter; at least one."""
        ...


@dataclass(frozen=True, slots=True)
class Cylinder:
    """All places within a radius of a centre.

    Raises:
        InputError: If the radius is not positive.

    Example:
        >>> Cylinder(10.0).walls(6.0, 0.0)
        (Wall(east=1.0, north=0.0, distance_m=4.0),)
    """

    radius_m: float
    center_m: tuple[float, float] = (0.0, 0.0)
    """East and north, from where the drone was switched on."""

    def __post_init__(self) -> None:
        """Check the radius."""
        if not 0 < self.radius_m < math.inf:
            raise InputError(f"Cylinder.radius_m must be above 0 and finite, but got {self.radius_m}.")

    def walls(self, east_m: float, north_m: float) -> tuple[Wall, ...]:
        """Return the wall straight out from the centre."""
        east, north = east_m - self.center_m[0], north_m - self.center_m[1]
        out = math.hypot(east, north)
        if out < 1e-9:
            return (Wall(1.0, 0.0, self.radius_m),)
        return (Wall(east / out, north / out, self.radius_m - out),)


@dataclass(frozen=True, slots=True)
class Polygon:
    """All places within a polygon, convex or not.

    Raises:
        InputError: If there are fewer than three corners, or its sides cross.

    Example:
        >>> yard = Polygon(((-5, -5), (5, -5), (5, 5), (-5, 5)))
        >>> min(yard.walls(4.0, 0.0), key=lambda wall: wall.distance_m)
        Wall(east=1.0, north=0.0, distance_m=1.0)
    """

    corners_m: tuple[tuple[float, float], ...]
    """East and north of each, from where the drone was switched on, in order around."""

    def __post_init__(self) -> None:
        """Check that inside and outside can be told."""
        n = len(self.corners_m)
        if n < 3 or not all(math.isfinite(v) for corner in self.corners_m for v in corner):
            raise InputError(f"Polygon.corners_m needs at least 3 finite corners, but got {self.corners_m}.")
        sides = self._sides()
        for i in range(n):
            for j in range(i + 2, n if i else n - 1):
                if _cross(sides[i], sides[j]):
                    raise InputError(f"Polygon.corners_m: sides {i} and {j} cross. Put them in order around.")

    def walls(self, east_m: float, north_m: float) -> tuple[Wall, ...]:
        """Return every side from inside; from outside the nearest one."""
        near = []
        for (ax, ay), (bx, by) in self._sides():
            side_x, side_y = bx - ax, by - ay
            length2 = side_x * side_x + side_y * side_y
            share = 0.0
            if length2 > 0:
                share = min(max(((east_m - ax) * side_x + (north_m - ay) * side_y) / length2, 0.0), 1.0)
            x, y = ax + share * side_x - east_m, ay + share * side_y - north_m
            far = math.hypot(x, y)
            if far > 1e-9:
                near.append(Wall(x / far, y / far, far))
            else:  # on the side itself: straight out, whichever way round the corners run
                length = math.sqrt(length2) or 1.0
                turn = math.copysign(1.0, self._area())
                near.append(Wall(turn * side_y / length, -turn * side_x / length, 0.0))
        if self._inside(east_m, north_m):
            return tuple(near)
        wall = min(near, key=lambda wall: wall.distance_m)
        if wall.distance_m == 0:
            return (wall,)
        return (Wall(-wall.east, -wall.north, -wall.distance_m),)

    def _sides(self) -> list[tuple[tuple[float, float], tuple[float, float]]]:
        return list(zip(self.corners_m, (*self.corners_m[1:], self.corners_m[0]), strict=True))

    def _area(self) -> float:
        """Positive if the corners run anticlockwise."""
        return sum(ax * by - bx * ay for (ax, ay), (bx, by) in self._sides()) / 2

    def _inside(self, east_m: float, north_m: float) -> bool:
        """Count the sides to the east."""
        inside = False
        for (ax, ay), (bx, by) in self._sides():
            if (ay > north_m) != (by > north_m) and east_m < (bx - ax) * (north_m - ay) / (by - ay) + ax:
                inside = not inside
        return inside


_Side = tuple[tuple[float, float], tuple[float, float]]


def _cross(one: _Side, other: _Side) -> bool:
    """Say whether two sides that share no corner meet."""

    def turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    (a, b), (c, d) = one, other
    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0
