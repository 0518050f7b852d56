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

    closer: float = 0.6
    """A body whose sides have changed lies closer to the last one, by this factor, if they are changed back."""
    apart: float = 0.35
    """And it has moved by more than this share of the distance between the sides."""
    memory_s: float = 0.5
    """A last body older than this says nothing."""
    insist_s: float = 1.5
    """If the network insists for this long, it is right and we were not."""


class SideKeeper:
    """Undoes changes of left and right that no person can make from one frame to the next.

    Trunk with arms and face, and legs, are judged apart: either may be crossed by itself. A person who
    really turns round passes through profile, where left and right change places little by little.

    Args:
        config: Thresholds.
    """

    def __init__(self, config: SidesConfig | None = None) -> None:
        self.config = config or SidesConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the last body."""
        self._last: Float[np.ndarray, "33 2"] | None = None
        self._last_ns = 0
        self._insisted_s = [0.0, 0.0]

    def __call__(self, body: Body, stamp_ns: int) -> Body:
        """Return the body with its sides as they were.

        Args:
            body: What the network sees now.
            stamp_ns: Monotonic nanoseconds.
        """
        step_s = (stamp_ns - self._last_ns) * 1e-9
        if self._last is None or step_s > self.config.memory_s:
            self._insisted_s = [0.0, 0.0]
        else:
            for part, members in enumerate((_UPPER, _LOWER)):
                if self._changed(body, part):
                    self._insisted_s[part] += step_s
                    if self._insisted_s[part] <= self.config.insist_s:
                        body = _crossed(body, members)
                    else:
                        self._insisted_s[part] = 0.0
                else:
                    self._insisted_s[part] = max(0.0, self._insisted_s[part] - step_s)
        self._last, self._last_ns = body.points_px, stamp_ns
        return body

    def _changed(self, body: Body, part: int) -> bool:
        assert self._last is not None
        left = list(_TELLING[part])
        right = [other_side(point) for point in left]
        now, last = body.points_px, self._last
        kept = np.linalg.norm(now[left + right] - last[left + right], axis=1).mean()
        crossed = np.linalg.norm(now[right + left] - last[left + right], axis=1).mean()
        between = np.linalg.norm(last[left] - last[right], axis=1).mean()
        return bool(crossed < self.config.closer * kept and kept > self.config.apart * between)


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
