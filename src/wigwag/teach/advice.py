"""What to tell somebody who shows a gesture to teach it: pure functions from values to advice, or none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float

from wigwag.pose.body import Point
from wigwag.skeleton import Clip, Landmark

_PARTS: tuple[tuple[str, tuple[Point, ...]], ...] = (
    ("head", (Point.NOSE, Point.LEFT_EAR, Point.RIGHT_EAR)),
    ("left hand", (Point.LEFT_WRIST,)),
    ("right hand", (Point.RIGHT_WRIST,)),
    ("hips", (Point.LEFT_HIP, Point.RIGHT_HIP)),
    ("feet", (Point.LEFT_ANKLE, Point.RIGHT_ANKLE, Point.LEFT_HEEL, Point.RIGHT_HEEL)),
)
_WRISTS = [Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST]

MIN_S, MAX_S = 1.0, 5.0
"""Shortest and longest movement that a stream is searched for (``SegmentConfig``)."""
TOO_FAST_M_S = 7.0
"""Hands faster than this are blurred in a picture, and 0.2 m further in the next."""
LONGEST_HOLE_S = 0.3
LEAST_SEEN = 0.85
"""Share of a movement's pictures in which the whole person must be found."""
TOO_LIKE = 1.3
"""An example of another gesture this near, in times the usual distance between two people who show the same,
may be that gesture. On simulated training people, one's own gesture by somebody else is at 0.78 to 1.31 (95 %
within 1.16), the nearest other one at 1.42 and more."""
UNLIKE_FIRST = 1.5
"""Repetitions by one person this far apart are two gestures."""


class Fault(StrEnum):
    """What is wrong."""

    NOBODY = "nobody"
    OUT_OF_VIEW = "out of view"
    EARLY = "too early"
    ARMS_UP = "arms up"
    TOO_FAST = "too fast"
    TOO_LONG = "too long"
    LOST = "lost"
    TOO_LIKE = "too like another"
    UNLIKE_FIRST = "unlike the first"


@dataclass(frozen=True, slots=True)
class Advice:
    """What is wrong, and what to do, for people to read."""

    fault: Fault
    text: str


@dataclass(frozen=True, slots=True)
class Near:
    """The nearest example of a gesture."""

    label: str
    times: float
    """Its distance, in times the usual one between two people who show that gesture."""
    example: str
    """What it is called."""


def out_of_view(
    points_px: Float[np.ndarray, "33 2"], width: int, height: int, margin_px: float = 2.0
) -> tuple[str, ...]:
    """Return which parts of a body lie outside of the picture, from top to bottom.

    Args:
        points_px: BlazePose's 33 landmarks, pixels (u, v); where the picture ends the network guesses on.
        width: Of the picture, pixels.
        height: Of the picture, pixels.
        margin_px: How far outside still counts as inside.

    Example:
        >>> out_of_view(np.tile([320.0, 500.0], (33, 1)), 640, 480)
        ('head', 'left hand', 'right hand', 'hips', 'feet')
    """
    most = np.array([width, height]) - 1 + margin_px
    outside = np.any((points_px < -margin_px) | (points_px > most), axis=1)
    return tuple(name for name, points in _PARTS if outside[list(points)].any())


def advise_view(found: bool, why: str, parts: Sequence[str]) -> Advice | None:
    """Say what keeps somebody from being seen whole.

    Args:
        found: Whether there is a pose.
        why: If not, why not.
        parts: What is out of view.

    Example:
        >>> advise_view(True, "", ["feet"]).text
        'feet out of view: step back, or tilt the camera'
    """
    if not found:
        return Advice(Fault.NOBODY, f"nobody to be seen{': ' + why if why else ''}")
    if not parts:
        return None
    what = " and ".join(parts) if len(parts) < 3 else "most of you"
    return Advice(Fault.OUT_OF_VIEW, f"{what} out of view: step back, or tilt the camera")


def advise_movement(clip: Clip, hole_s: float, seen: float, lost: Sequence[str] = ()) -> Advice | None:
    """Say what is wrong with a movement that is over, as far as it can be told by itself.

    Args:
        clip: The movement, without what was before and after it.
        hole_s: The longest time without a pose, seconds.
        seen: Share of its pictures in which the whole person was in view, 0 to 1.
        lost: Which parts were out of view.
    """
    if hole_s > LONGEST_HOLE_S:
        return Advice(Fault.LOST, f"lost you for {hole_s:.1f} s: stay in the picture, facing the camera")
    if seen < LEAST_SEEN:
        what = " and ".join(lost) or "you"
        return Advice(Fault.OUT_OF_VIEW, f"{what} out of view meanwhile: step back, or tilt the camera")
    if clip.duration_s < MIN_S:
        return Advice(
            Fault.TOO_FAST, f"too fast: {clip.duration_s:.1f} s; take {MIN_S:.0f} to {MAX_S:.0f} s for it"
        )
    if clip.duration_s > MAX_S:
        return Advice(
            Fault.TOO_LONG, f"too long: {clip.duration_s:.1f} s; take {MIN_S:.0f} to {MAX_S:.0f} s for it"
        )
    speed = hand_speed_m_s(clip)
    if speed > TOO_FAST_M_S:
        return Advice(
            Fault.TOO_FAST, f"too fast: hands at {speed:.0f} m/s; below {TOO_FAST_M_S:.0f} is seen well"
        )
    return None


def hand_speed_m_s(clip: Clip) -> float:
    """Return how fast the faster hand is, seen from the hips, for a tenth of a second or more.

    Medians over five moments: single wrong depths do not count.
    """
    hips = (clip.joints[:, Landmark.LEFT_HIP] + clip.joints[:, Landmark.RIGHT_HIP]) / 2
    hands = clip.joints[:, _WRISTS] - hips[:, None]
    if len(hands) < 7:
        return 0.0
    steady = np.median(np.lib.stride_tricks.sliding_window_view(hands, 5, axis=0), axis=-1)
    steps_s = np.diff(clip.times_s[2:-2])
    speeds = np.linalg.norm(np.diff(steady, axis=0), axis=2) / steps_s[:, None]
    lasting = np.lib.stride_tricks.sliding_window_view(speeds, min(3, len(speeds)), axis=0).min(axis=-1)
    return float(lasting.max())


def advise_likeness(label: str, nearest: Sequence[Near], to_first: float | None) -> Advice | None:
    """Say whether a movement is too like another gesture, or unlike the repetitions before.

    Args:
        label: What is being taught.
        nearest: The nearest example of each gesture that is known.
        to_first: Distance to the nearest repetition before, in times the usual one; ``None``: the first.

    Example:
        >>> advise_likeness("mine", [Near("land", 0.9, "land of ann")], None).text
        'too like "land" (0.9 times the distance between two people who show that): make it differ more'
    """
    others = [near for near in nearest if near.label != label and near.times < TOO_LIKE]
    if others:
        near = min(others, key=lambda one: one.times)
        return Advice(
            Fault.TOO_LIKE,
            f'too like "{near.label}" ({near.times:.1f} times the distance between two people who show '
            "that): make it differ more",
        )
    if to_first is not None and to_first > UNLIKE_FIRST:
        return Advice(
            Fault.UNLIKE_FIRST,
            f"unlike the repetition before ({to_first:.1f} times the usual distance): show the same again",
        )
    return None


__all__ = [
    "LEAST_SEEN", "LONGEST_HOLE_S", "MAX_S", "MIN_S", "TOO_FAST_M_S", "TOO_LIKE", "UNLIKE_FIRST", "Advice",
    "Fault", "Near", "advise_likeness", "advise_movement", "advise_view", "hand_speed_m_s", "out_of_view",
]  # fmt: skip
