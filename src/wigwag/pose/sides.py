"""Left stays left: the network sometimes takes a person's front for their back, for a moment."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from wigwag.pose.body import Body, Point

_UPPER = (
    Point.LEFT_EYE_INNER, Point.LEFT_EYE, Point.LEFT_EYE_OUTER, Point.LEFT_EAR, Point.MOUTH_LEFT,
    Point.LEFT_SHOULDER, Point.LEFT_ELBOW, Point.LEFT_WRIST, Point.LEFT_PINKY, Point.LEFT_INDEX,
    Point.LEFT_THUMB,
)  # fmt: skip
_LOWER = (Point.LEFT_HIP, Point.LEFT_KNEE, Point.LEFT_ANKLE, Point.LEFT_HEEL, Point.LEFT_FOOT_INDEX)
_TELLING = ((Point.LEFT_SHOULDER, Point.LEFT_ELBOW), (Point.LEFT_HIP, Point.LEFT_KNEE))
"""What changes place only if the person turns round: a wrist may cross to the other side by itself."""


def other_side(point: Point) -> Point:
    """Return the landmark on the other side of the body.

    Example:
        >>> other_side(Point.LEFT_WRIST).name
        'RIGHT_WRIST'
    """
    name = point.name
    return Point[name.replace("LEFT", "RIGHT") if "LEFT" in name else name.replace("RIGHT", "LEFT")]


@dataclass(frozen=True, slots=True)
class SidesConfig:
    """When a change of sides is not believed."""

    memory_s: float = 0.25
    """Time constant of the remembered direction from right to left."""
    facing: float = 0.6
    """A person faces the camera, or away, while that direction is longer than this share of its longest.
    Who turns round passes through profile, where it is short: then any change is believed."""
    against: float = 0.25
    """It has changed when it points back by more than this share of what is remembered."""
    forget_s: float = 0.5
    """After a gap this long, whatever the network says is believed."""
    insist_s: float = 1.5
    """If the network insists for this long, it is right and we were not."""


class SideKeeper:
    """Undoes changes of left and right that no person can make from one frame to the next.

    Trunk with arms and face, and legs, are judged apart: either may be crossed by itself.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: SidesConfig | None = None) -> None:
        self.config = config or SidesConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the last body."""
        self._last_ns: int | None = None
        self._axes = np.zeros((2, 2))
        self._longest = [0.0, 0.0]
        self._insisted_s = [0.0, 0.0]

    def __call__(self, body: Body, stamp_ns: int) -> Body:
        """Return the body with its sides as they were.

        Args:
            body: What the network sees now.
            stamp_ns: Monotonic nanoseconds.
        """
        gap_s = np.inf if self._last_ns is None else (stamp_ns - self._last_ns) * 1e-9
        self._last_ns = stamp_ns
        if gap_s > self.config.forget_s:
            self._insisted_s = [0.0, 0.0]
            for part in range(2):
                self._remember(part, _axis(body, part), share=1.0, decay=0.0)
            return body
        for part, members in enumerate((_UPPER, _LOWER)):
            if not self._changed(part, _axis(body, part)):
                self._insisted_s[part] = max(0.0, self._insisted_s[part] - gap_s)
            elif self._insisted_s[part] < self.config.insist_s:
                self._insisted_s[part] += gap_s
                body = _crossed(body, members)
            else:
                self._insisted_s[part] = 0.0
                self._axes[part] = _axis(body, part)
            share = 1.0 - np.exp(-gap_s / self.config.memory_s)
            self._remember(part, _axis(body, part), share, decay=float(np.exp(-gap_s / 5.0)))
        return body

    def _remember(self, part: int, axis: Float[np.ndarray, " 2"], share: float, decay: float) -> None:
        self._axes[part] += share * (axis - self._axes[part])
        self._longest[part] = max(decay * self._longest[part], float(np.hypot(*axis)))

    def _changed(self, part: int, axis: Float[np.ndarray, " 2"]) -> bool:
        remembered = self._axes[part]
        length = float(np.hypot(*remembered))
        if length < self.config.facing * self._longest[part]:
            return False
        return float(axis @ remembered) < -self.config.against * length**2


def _axis(body: Body, part: int) -> Float[np.ndarray, " 2"]:
    """Return the mean direction from right to left of what tells the sides, pixels."""
    left = list(_TELLING[part])
    right = [other_side(point) for point in left]
    return np.asarray((body.points_px[left] - body.points_px[right]).mean(axis=0))


def _crossed(body: Body, members: tuple[Point, ...]) -> Body:
    order = np.arange(len(Point))
    for point in members:
        order[point], order[other_side(point)] = other_side(point), point
    return replace(
        body,
        points_px=body.points_px[order],
        visibility=body.visibility[order],
        world_m=body.world_m[order],
    )
