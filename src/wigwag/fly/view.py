"""From where a camera that is fixed to the drone sees what gestures need of a body, hands to knees."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wigwag.fly.operator import Mount

if TYPE_CHECKING:
    from wigwag.camera.frame import Intrinsics

_STEEPEST_RAD = math.radians(85.0)
"""Steeper than this nothing is at a horizontal distance."""
_NEAR_M = 0.1


@dataclass(frozen=True, slots=True)
class View:
    """What a level drone's camera sees of the vertical, and how much of a body has to be in it.

    Angles count from the horizontal, upwards.

    Args:
        upper_rad: Of what appears at the picture's upper edge.
        lower_rad: Of what appears at its lower edge.
        offset_m: The optical centre ahead of and above the drone's own.
        above_hips_m: How far what has to be seen reaches above the operator's hips.
        below_hips_m: How far it reaches below them.

    Example:
        >>> view = View(0.4, -0.4, (0.0, 0.0), above_hips_m=1.2, below_hips_m=0.5)
        >>> [round(m, 2) for m in view.heights_m(4.0)]
        [-0.49, 1.19]
        >>> round(view.nearest_m, 2)
        2.01
    """

    upper_rad: float
    lower_rad: float
    offset_m: tuple[float, float]
    above_hips_m: float
    below_hips_m: float

    @classmethod
    def through(
        cls, lens: Intrinsics, mount: Mount, above_hips_m: float, below_hips_m: float, margin_rad: float
    ) -> View:
        """Return what is seen through a lens.

        Args:
            lens: Of the pictures that poses are found in.
            mount: How the camera sits on the drone.
            above_hips_m: As above.
            below_hips_m: As above.
            margin_rad: What is so near to the upper or lower edge counts as not seen.
        """
        upper = math.atan(lens.cy / lens.fy) - margin_rad - mount.pitch_down_rad
        lower = -math.atan((lens.height - lens.cy) / lens.fy) + margin_rad - mount.pitch_down_rad
        return cls(upper, lower, (mount.offset_m[0], mount.offset_m[2]), above_hips_m, below_hips_m)

    def heights_m(self, distance_m: float) -> tuple[float, float]:
        """Return the lowest and the highest that the drone sees all from, metres above the operator's hips.

        Where the body does not fit into the picture both are the same: hands and knees are cut alike.

        Args:
            distance_m: Horizontal, from the drone to the hips.
        """
        lowest, highest = self._edges_m(distance_m)
        if lowest > highest:
            lowest = highest = (lowest + highest) / 2
        return lowest, highest

    def allowing(self, distance_m: float, height_m: float) -> View | None:
        """Return a view that asks for no more of the body than is seen from a place that the user has set.

        Args:
            distance_m: Horizontal, from the drone to the hips.
            height_m: Above the hips.

        Returns:
            ``None`` if not even the hips are seen from there: then the camera is not what it is said to be.
        """
        lowest, highest = self._edges_m(distance_m)
        above_m = self.above_hips_m - max(lowest - height_m, 0.0)
        below_m = self.below_hips_m - max(height_m - highest, 0.0)
        if min(above_m, below_m) < 0:
            return None
        return replace(self, above_hips_m=above_m, below_hips_m=below_m)

    def _edges_m(self, distance_m: float) -> tuple[float, float]:
        """Return from where the hands, and from where the knees are at their edge of the picture."""
        ahead, up = self.offset_m
        away = max(distance_m - ahead, _NEAR_M)
        lowest = self.above_hips_m - away * _slope(self.upper_rad) - up
        return lowest, -self.below_hips_m - away * _slope(self.lower_rad) - up

    @property
    def nearest_m(self) -> float:
        """The nearest distance that all fits into the picture from; infinite if there is none."""
        per_metre = _slope(self.upper_rad) - _slope(self.lower_rad)
        if per_metre <= 0:
            return math.inf
        return max((self.above_hips_m + self.below_hips_m) / per_metre, _NEAR_M) + self.offset_m[0]


def _slope(angle_rad: float) -> float:
    return math.tan(min(max(angle_rad, -_STEEPEST_RAD), _STEEPEST_RAD))


__all__ = ["View"]
