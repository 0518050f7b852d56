"""What the pose network says of one person in one picture."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from jaxtyping import Float, UInt8

Picture = UInt8[np.ndarray, "height width 3"]
"""RGB, 8 bit."""


class Point(IntEnum):
    """BlazePose's 33 landmarks. Left and right are the person's own."""

    NOSE = 0
    LEFT_EYE_INNER = 1
    LEFT_EYE = 2
    LEFT_EYE_OUTER = 3
    RIGHT_EYE_INNER = 4
    RIGHT_EYE = 5
    RIGHT_EYE_OUTER = 6
    LEFT_EAR = 7
    RIGHT_EAR = 8
    MOUTH_LEFT = 9
    MOUTH_RIGHT = 10
    LEFT_SHOULDER = 11
    RIGHT_SHOULDER = 12
    LEFT_ELBOW = 13
    RIGHT_ELBOW = 14
    LEFT_WRIST = 15
    RIGHT_WRIST = 16
    LEFT_PINKY = 17
    RIGHT_PINKY = 18
    LEFT_INDEX = 19
    RIGHT_INDEX = 20
    LEFT_THUMB = 21
    RIGHT_THUMB = 22
    LEFT_HIP = 23
    RIGHT_HIP = 24
    LEFT_KNEE = 25
    RIGHT_KNEE = 26
    LEFT_ANKLE = 27
    RIGHT_ANKLE = 28
    LEFT_HEEL = 29
    RIGHT_HEEL = 30
    LEFT_FOOT_INDEX = 31
    RIGHT_FOOT_INDEX = 32


N_POINTS = len(Point)

BODY_BONES: tuple[tuple[int, int], ...] = (
    (7, 2), (2, 0), (0, 5), (5, 8), (9, 10),
    (11, 12), (11, 23), (12, 24), (23, 24),
    (11, 13), (13, 15), (15, 17), (15, 19), (15, 21), (17, 19),
    (12, 14), (14, 16), (16, 18), (16, 20), (16, 22), (18, 20),
    (23, 25), (25, 27), (27, 29), (29, 31), (27, 31),
    (24, 26), (26, 28), (28, 30), (30, 32), (28, 32),
)  # fmt: skip
"""Pairs of the 33 landmarks that a drawing joins with a line."""


@dataclass(frozen=True, slots=True)
class Body:
    """One person as BlazePose sees them: 33 landmarks in the picture and, roughly, in space.

    How sure the network is, in ``score`` and ``clarity``, not every engine tells; ``None``: it does not.
    """

    points_px: Float[np.ndarray, "33 2"]
    """Pixels (u, v) of the full picture; may lie outside of it where the network guesses."""
    visibility: Float[np.ndarray, " 33"]
    """How surely each landmark is in the picture and not hidden, 0 to 1."""
    world_m: Float[np.ndarray, "33 3"]
    """The network's own guess in metres from the middle of the hips: x right, y down, z away."""
    score: float | None
    """The network's own word on whether there is a person, 0 to 1. Furniture often gets 0.99."""
    clarity: float | None
    """How sharply the network sees those of wigwag's 13 landmarks that lie in the picture, 0 to 1: the
    median peak of their heat maps; 0 if fewer than five do. This is what tells people (above 0.7,
    mostly) from furniture (below 0.5, mostly)."""

    @property
    def torso_px(self) -> float:
        """Length from the middle of the shoulders to the middle of the hips, pixels."""
        points = self.points_px
        return float(np.linalg.norm(points[[11, 12]].mean(axis=0) - points[[23, 24]].mean(axis=0)))

    @property
    def hip_center_px(self) -> Float[np.ndarray, " 2"]:
        """Midpoint of the hips, pixels."""
        return np.asarray(self.points_px[[23, 24]].mean(axis=0))
