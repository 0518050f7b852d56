"""How far off a lifted landmark may be: one standard deviation, from what its window showed."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from wigwag.pose.lift_kernels import FILL, SPREAD, WIDENED

_OF_JOINT = np.array([0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6])
"""Joint type (nose, shoulder, elbow, wrist, hip, knee, heel) of each landmark."""

# Fitted on the UTD-MHAD depth of subjects 1, 3, 5 and 7, with and without pixels knocked out, so that 68 %
# of the errors lie within one standard deviation and 95 % within two (the loss is that of these two
# quantiles; each subject left out in turn kept about that coverage). `wigwag benchmark lift` gives the
# coverage for the other four.
_BASE_MM = np.array([9.0, 11.5, 9.0, 10.0, 11.0, 11.0, 10.5])[_OF_JOINT]
"""On a flat, full, near surface: what the person's shape and the Kinect's skeleton disagree by."""
_PER_SPREAD = np.array([0.80, 0.30, 0.80, 0.90, 0.45, 0.45, 0.70])[_OF_JOINT]
"""Share of the surface's own spread: noise, a slope, two surfaces that run into each other."""
_UNFILLED_MM = np.array([24.0, 24.0, 75.0, 62.0, 10.0, 10.0, 12.0])[_OF_JOINT]
"""In a window that its surface hardly fills: holes, an edge, something else beside it."""
_WIDENED_MM = np.array([35.0, 60.0, 260.0, 155.0, 60.0, 60.0, 60.0])[_OF_JOINT]
"""If only a window twice as wide had a depth that could be the landmark's."""
_FILLED_MM = np.array([45.0, 55.0, 130.0, 170.0, 50.0, 90.0, 90.0])[_OF_JOINT]
"""If the depth is a neighbour's: measured by leaving out depths that are there."""

# Seen in the simulator only, on its training people: a Kinect stood at one distance, and its landmarks have
# no visibility.
_PER_SQUARE = 0.75e-6
"""Stereo noise that is left after averaging, millimetres over the square of millimetres."""
_UNSEEN_MM = 75.0
"""Across the line of sight at visibility 0: the network guesses."""
_LEAST_MM = 12.0
"""Across the line of sight at full visibility: the network errs by a share of the person, at any distance."""


def lifted_sigma_m(
    found: Float[np.ndarray, "13 4"],
    measured: Bool[np.ndarray, 13],
    z_mm: Float[np.ndarray, 13],
    visibility: Float[np.ndarray, 13],
) -> Float[np.ndarray, 13]:
    """Return one standard deviation of each lifted landmark's place along its worst axis, metres.

    Args:
        found: What ``lift_depths`` found.
        measured: Whether a landmark's depth is its own.
        z_mm: The depths that were settled on, millimetres.
        visibility: What the pose network says, 0 to 1.
    """
    own = (
        _BASE_MM**2
        + (_PER_SPREAD * found[:, SPREAD]) ** 2
        + (_UNFILLED_MM * (1.0 - found[:, FILL])) ** 2
        + (_WIDENED_MM * found[:, WIDENED]) ** 2
    )
    variance = np.where(measured, own, _FILLED_MM**2) + (_PER_SQUARE * z_mm**2) ** 2
    variance = variance + (_UNSEEN_MM * (1.0 - np.clip(visibility, 0.0, 1.0))) ** 2
    return np.asarray(np.maximum(np.sqrt(variance), _LEAST_MM) * 1e-3)


__all__ = ["lifted_sigma_m"]
