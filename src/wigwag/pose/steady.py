"""What is handed on becomes steady: with depth only what is hardly seen, without depth all of it.

Recognisers hear poses as they are measured by depth: beside that, on the demo's flights, ``PoseFilter`` had
commands decided a tenth of a second earlier and missed as many or one more (``smooth="always"`` turns it
on). Without depth a person's distance jitters by a share of itself, and every landmark with it; there it is
needed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.pose.filter import FilterConfig, PoseFilter
from wigwag.skeleton import Pose

WHEN = ("never", "monocular", "always")
_BEGIN_ANEW_S = 0.5
"""After a gap this long in what is handed on, steadying forgets."""


@dataclass(frozen=True, slots=True)
class SteadyConfig:
    """How poses are made steady.

    Raises:
        InputError: If ``smooth`` is unknown, or a value is out of range; the message names it.
    """

    smooth: Literal["never", "monocular", "always"] = "monocular"
    """Which poses go through ``PoseFilter``: those without depth, all, or none. The others are steadied by
    visibility alone."""
    filter: FilterConfig = field(default_factory=FilterConfig)
    """How those are smoothed."""
    trusted: tuple[float, float] = (0.3, 0.8)
    """From the lower visibility to the upper one, trust in what is measured grows from least to full."""
    least_trust: float = 0.08
    """How far a landmark that is not seen moves towards each new guess."""

    def __post_init__(self) -> None:
        """Check once, where the configuration enters."""
        if self.smooth not in WHEN:
            raise InputError(
                f"SteadyConfig.smooth must be one of {', '.join(WHEN)}, but got {self.smooth!r}."
            )
        if not self.trusted[0] < self.trusted[1]:
            raise InputError(f"SteadyConfig.trusted must rise, but got {self.trusted}.")
        if not 0 < self.least_trust <= 1:
            raise InputError(
                f"SteadyConfig.least_trust must be above 0 and at most 1, but got {self.least_trust}."
            )


class Steadier:
    """Makes the poses of whoever is the operator steady; another operator's begin anew.

    Args:
        config: How.
    """

    def __init__(self, config: SteadyConfig | None = None) -> None:
        self.config = config or SteadyConfig()
        self._filter = PoseFilter(self.config.filter)
        self.reset()

    def reset(self) -> None:
        """Forget everybody."""
        self._number: int | None = None
        self._begin()

    def _begin(self) -> None:
        self._filter.reset()
        self._smoothed = False
        self._stamp_ns: int | None = None
        self._relative_m: Float[np.ndarray, "13 3"] | None = None

    def __call__(self, pose: Pose, number: int) -> Pose:
        """Return the pose made steady.

        Args:
            pose: As measured.
            number: Whose it is.
        """
        smooth = self.config.smooth == "always" or (self.config.smooth == "monocular" and pose.monocular)
        if number != self._number or smooth != self._smoothed:
            self._begin()
            self._number, self._smoothed = number, smooth
        return self._filter(pose) if smooth else self._by_visibility(pose)

    def _by_visibility(self, pose: Pose) -> Pose:
        """Let landmarks that are hardly seen follow slowly, relative to the hips; others stay as measured.

        Feet below the picture's edge are guessed anew in every frame, and jump by a decimetre.
        """
        if self._stamp_ns is not None and (pose.stamp_ns - self._stamp_ns) * 1e-9 > _BEGIN_ANEW_S:
            self._relative_m = None
        self._stamp_ns = pose.stamp_ns
        low, high = self.config.trusted
        relative = pose.joints - pose.hip_center
        if self._relative_m is not None:
            trust = np.clip((pose.visibility - low) / (high - low), self.config.least_trust, 1.0)
            relative = self._relative_m + trust[:, None] * (relative - self._relative_m)
        self._relative_m = relative
        return replace(pose, joints=relative + pose.hip_center)


__all__ = ["Steadier", "SteadyConfig"]
