"""A turned square in the picture: where a network looks, and the way there and back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True)
class Region:
    """A square cut from the picture, turned so that the person in it stands upright."""

    u: float
    """Centre, pixels from the left edge."""
    v: float
    """Centre, pixels from the upper edge."""
    side: float
    """Length of a side, pixels."""
    angle_rad: float = 0.0
    """How far the square is turned, clockwise as one sees it (v points down)."""

    @classmethod
    def around(
        cls, center: Float[np.ndarray, " 2"], above: Float[np.ndarray, " 2"], scale: float = 1.25
    ) -> Region:
        """Build the square that holds a whole body from BlazePose's two alignment points.

        Args:
            center: Middle of the hips, pixels.
            above: A point on the circle around the whole body, in the direction of the head, pixels.
            scale: How much wider than that circle the square is (MediaPipe's value).
        """
        du, dv = float(above[0] - center[0]), float(above[1] - center[1])
        return cls(float(center[0]), float(center[1]), 2.0 * scale * math.hypot(du, dv), math.atan2(du, -dv))

    def usable(self, max_tilt_rad: float) -> bool:
        """Say whether a body may stand here: a real size, and not tilted by more than this."""
        return math.isfinite(self.side) and self.side > 4.0 and abs(self.angle_rad) <= max_tilt_rad

    def resembles(self, other: Region) -> bool:
        """Say whether both hold the same thing: middles and sides that differ by less than a fifth."""
        near = math.hypot(self.u - other.u, self.v - other.v) < 0.2 * other.side
        return near and abs(self.side - other.side) < 0.2 * other.side

    def wider(self, scale: float) -> Region:
        """Return an upright square around the same middle, its side longer by ``scale``."""
        return Region(self.u, self.v, scale * self.side)

    @classmethod
    def whole(cls, width: int, height: int) -> Region:
        """Build the smallest upright square that holds the whole picture."""
        return cls(width / 2, height / 2, float(max(width, height)))

    def matrix(self, pixels: int) -> Float[np.ndarray, "2 3"]:
        """Return the affine map from the pixels of a crop of ``pixels`` x ``pixels`` to the picture's.

        A crop's pixel is the square from its index to the next: index 0 shows what lies half a pixel inside
        the crop. The picture's pixels have their middle at their index, as the intrinsics say.
        """
        step = self.side / pixels
        c, s = step * math.cos(self.angle_rad), step * math.sin(self.angle_rad)
        half = (pixels - 1) / 2
        return np.array([[c, -s, self.u - half * (c - s)], [s, c, self.v - half * (s + c)]])

    def to_picture(
        self, points: Float[np.ndarray, "*batch 2"], pixels: float = 1.0
    ) -> Float[np.ndarray, "*batch 2"]:
        """Map points of a crop of ``pixels`` x ``pixels`` to pixels of the picture."""
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        local = (np.asarray(points) / pixels - 0.5) * self.side
        return np.asarray(local @ np.array([[c, s], [-s, c]]) + (self.u, self.v))

    def to_crop(
        self, points: Float[np.ndarray, "*batch 2"], pixels: float = 1.0
    ) -> Float[np.ndarray, "*batch 2"]:
        """Map pixels of the picture to points of a crop of ``pixels`` x ``pixels``."""
        c, s = math.cos(self.angle_rad), math.sin(self.angle_rad)
        local = (np.asarray(points) - (self.u, self.v)) @ np.array([[c, -s], [s, c]])
        return np.asarray((local / self.side + 0.5) * pixels)
