"""Frames in which the camera lost the person: found, bridged where short, refused where too many."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from wigwag.errors import DataError

FEWEST_S = 0.3
"""A person who is seen for less time than this shows no gesture."""

FEWEST_SEEN = 0.5
"""Of the frames between the first and the last in which the person is seen, so many must show them."""


def seen(joints: Float[np.ndarray, "frames joints 3"]) -> Bool[np.ndarray, " frames"]:
    """Say in which frames there is a person: a Kinect writes zeros for all joints when it has lost them.

    A frame with a joint that is not a finite number shows nobody either.
    """
    return np.asarray(np.isfinite(joints).all(axis=(1, 2)) & (joints != 0).any(axis=(1, 2)))


def bridged(
    joints: Float[np.ndarray, "frames joints 3"], rate_hz: float
) -> tuple[Float[np.ndarray, "frames joints 3"], str]:
    """Cut off the frames at both ends in which nobody is seen and fill the ones between linearly.

    Args:
        joints: Metres, any frame of reference; lost frames are all zero or not finite.
        rate_hz: Frames a second.

    Returns:
        The repaired frames, and what was done, in words (empty: nothing).

    Raises:
        DataError: If the person is seen for less than 0.3 s, or in less than half of the frames between
            the first and the last that show them. The message is the reason alone; the caller names the
            recording.
    """
    there = np.flatnonzero(seen(joints))
    if len(there) == 0:
        raise DataError("nobody is seen: every frame is zero")
    if len(there) < max(2.0, FEWEST_S * rate_hz):
        raise DataError(f"the person is seen in {len(there)} of {len(joints)} frames only")
    span = np.arange(there[0], there[-1] + 1)
    if len(there) < FEWEST_SEEN * len(span):
        raise DataError(f"the person is lost in {len(span) - len(there)} of {len(span)} frames")
    if len(there) == len(joints):
        return joints, ""
    after = np.clip(np.searchsorted(there, span, side="right"), 1, len(there) - 1)
    start, stop = there[after - 1], there[after]
    weight = ((span - start) / (stop - start))[:, None, None]
    filled = joints[start] + weight * (joints[stop] - joints[start])
    done = []
    if cut := len(joints) - len(span):
        done.append(f"{cut} frames without a person cut off the ends")
    if gaps := len(span) - len(there):
        done.append(f"{gaps} frames without a person filled in")
    return filled, ", ".join(done)


__all__ = ["FEWEST_S", "FEWEST_SEEN", "bridged", "seen"]
