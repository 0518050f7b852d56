"""Who wants to be the operator says so with the body: a pure state machine over poses and their stamps.

Engage: one hand, either one, held still well above the head for a second while the other hangs. Disengage:
both hands held still above the head for a second and a half. Both are postures, held: commands and everyday
movements pass through them, but do not stay.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.skeleton import Landmark, Pose

_WRISTS = (Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST)
_SHOULDERS = [Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER]
_HIPS = [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]

_ANCHOR_S = 0.4
"""Time constant with which the place where a hand is still follows it: arms sink a little while held."""


class Signal(StrEnum):
    """What a held posture asks for."""

    ENGAGE = "engage"
    DISENGAGE = "disengage"


@dataclass(frozen=True, slots=True)
class EngagementConfig:
    """When a posture counts as held. Lengths are shares of the torso (shoulders to hips, about half a metre).

    Raises:
        InputError: If a value is not above 0; the message names it.
    """

    engage_s: float = 1.0
    """How long one hand must be held up."""
    disengage_s: float = 1.5
    """How long both hands must be held up."""
    above: float = 0.3
    """A hand is up if its wrist is this far above the middle of the head: clear of a hand that scratches it,
    and reached by an arm that is bent by a right angle less a third."""
    hanging: float = 0.5
    """The other arm hangs if its wrist is this far below the shoulders."""
    still: float = 0.25
    """A hand is still while it stays within this distance of where it has been, seen from the trunk."""
    grace_s: float = 0.15
    """A posture that is clearly another for less than this goes on: the network errs for a frame now and
    then."""
    clear: float = 0.7
    """Wrists of a lower visibility say nothing against a posture: in the dark, and where they blur, the
    network loses an arm for some frames in a row."""
    gap_s: float = 0.5
    """After a gap this long in the poses everything begins anew."""

    def __post_init__(self) -> None:
        """Check ranges once, where the configuration enters."""
        for name in self.__slots__:
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"EngagementConfig.{name} must be above 0, but got {getattr(self, name)}.")


class Engagement:
    """One person's engaging and disengaging; fed with every pose of that person.

    It looks at the body as the camera sees it, at the distance of the hips, and asks nothing of the depth of
    a thin, raised arm. What is up is what the trunk says: it may lean, and the camera may be tilted.

    Args:
        config: Thresholds.

    Example:
        >>> import numpy as np
        >>> joints = np.zeros((13, 3))
        >>> joints[:, 1] = (-0.7, -0.5, -0.5, -0.2, -0.2, 0.0, 0.0, 0.0, 0.0, 0.4, 0.4, 0.8, 0.8)
        >>> joints[Landmark.LEFT_WRIST, 1] = -1.1  # y points down
        >>> engagement = Engagement()
        >>> poses = [Pose(joints + (0.0, 0.0, 4.0), np.ones(13), k * 33_333_333) for k in range(40)]
        >>> [k for k, pose in enumerate(poses) if engagement.update(pose)]  # after a second and a frame
        [31]
    """

    def __init__(self, config: EngagementConfig | None = None) -> None:
        self.config = config or EngagementConfig()
        self.reset()

    def reset(self) -> None:
        """Forget what has been held so far; a posture that is held on must be held anew."""
        self._up = (False, False)
        self._anchor: Float[np.ndarray, "2 2"] | None = None
        self._since_ns = self._good_ns = self._last_ns = 0
        self._against_s = 0.0
        self._said = False

    @property
    def progress(self) -> float:
        """How much of the time one hand has been held up, 0 to 1."""
        return self._share(self.config.engage_s) if sum(self._up) == 1 else 0.0

    @property
    def release_progress(self) -> float:
        """How much of the time both hands have been held up, 0 to 1."""
        return self._share(self.config.disengage_s) if sum(self._up) == 2 else 0.0

    def update(self, pose: Pose) -> Signal | None:
        """Take in the newest pose of the person and return a signal once, when its posture has been held."""
        now, config = pose.stamp_ns, self.config
        up, wrists = self._look(pose)
        elapsed_s = (now - self._good_ns) * 1e-9
        if self._anchor is None or elapsed_s > config.gap_s:
            self._begin(up, wrists, now)
            return None
        away = np.linalg.norm(wrists - self._anchor, axis=1)[np.array(self._up)]
        if up == self._up and (away <= config.still).all():
            self._anchor = self._anchor + min(elapsed_s / _ANCHOR_S, 1.0) * (wrists - self._anchor)
            self._good_ns, self._against_s = now, 0.0
        elif pose.visibility[list(_WRISTS)].min() >= config.clear:
            self._against_s += (now - self._last_ns) * 1e-9
        if self._against_s > config.grace_s:
            self._begin(up, wrists, now)
            return None
        self._last_ns = now
        if self._said or not any(self._up):
            return None
        signal, needed_s = (
            (Signal.DISENGAGE, config.disengage_s) if all(self._up) else (Signal.ENGAGE, config.engage_s)
        )
        self._said = self._share(needed_s) >= 1.0
        return signal if self._said else None

    def _share(self, needed_s: float) -> float:
        return float(min((self._good_ns - self._since_ns) * 1e-9 / needed_s, 1.0))

    def _begin(self, up: tuple[bool, bool], wrists: Float[np.ndarray, "2 2"], now_ns: int) -> None:
        # A hand that has spoken and only trembled does not speak again before it has been down.
        self._said = self._said and up == self._up and any(up)
        self._up, self._anchor, self._against_s = up, wrists, 0.0
        self._since_ns = self._good_ns = self._last_ns = now_ns

    def _look(self, pose: Pose) -> tuple[tuple[bool, bool], Float[np.ndarray, "2 2"]]:
        """Return which hands are up, both down if the posture is neither, and the wrists seen from the trunk.

        Wrists are given across and up from the middle of the shoulders, in torsos.
        """
        depth = pose.joints[:, 2]
        hips_z = float(pose.hip_center[2])
        if hips_z <= 0 or (depth <= 0).any():
            return (False, False), np.zeros((2, 2))
        flat = pose.joints[:, :2] * (hips_z / depth)[:, None]
        shoulders, hips = flat[_SHOULDERS].mean(axis=0), flat[_HIPS].mean(axis=0)
        torso = float(np.linalg.norm(shoulders - hips))
        if torso < 1e-6:
            return (False, False), np.zeros((2, 2))
        upward = (shoulders - hips) / torso
        axes = np.stack([[-upward[1], upward[0]], upward], axis=1) / torso
        wrists = (flat[list(_WRISTS)] - shoulders) @ axes
        head = float(((flat[Landmark.NOSE] - shoulders) @ axes)[1])
        # A hand above a head that is bowed to the chest is not above the person.
        high = wrists[:, 1] > max(head, 0.25) + self.config.above
        low = wrists[:, 1] < -self.config.hanging
        if high.all() or (high[0] and low[1]) or (high[1] and low[0]):
            return (bool(high[0]), bool(high[1])), wrists
        return (False, False), wrists


__all__ = ["Engagement", "EngagementConfig", "Signal"]
