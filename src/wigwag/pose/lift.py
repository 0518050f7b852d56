"""Landmarks in the picture plus a depth picture become a 3-D pose (paper, section 1, steps 3 to 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, UInt16

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError
from wigwag.pose.lift_kernels import DEPTH, FILL, SPREAD, WIDENED, Task, lift_depths
from wigwag.pose.uncertainty import lifted_sigma_m
from wigwag.skeleton import LANDMARKS, N_LANDMARKS

Statistic = Literal["surface", "quartile", "median", "pixel"]
"""How the depths of a landmark's window become one number; see :class:`LiftConfig`."""

STATISTICS: tuple[Statistic, ...] = get_args(Statistic)

SURFACE_TO_JOINT_MM: dict[str, tuple[float, ...]] = {
    "surface": (115, 66, 66, 40, 40, 30, 30, 99, 99, 80, 80, 49, 49),
    "quartile": (126, 96, 96, 61, 61, 43, 43, 115, 115, 105, 105, 66, 66),
    "median": (116, 69, 69, 40, 40, 22, 22, 100, 100, 84, 84, 49, 49),
    "pixel": (120, 73, 73, 41, 41, 25, 25, 101, 101, 89, 89, 46, 46),
}
"""How far behind the surface each joint lies, millimetres, by statistic, in the order of ``LANDMARKS``.

Fitted on the UTD-MHAD depth of subjects 1, 3, 5 and 7, left and right together (the column ``refit`` of
``wigwag benchmark lift --data DIR``). A Kinect's head joint lies in the middle of the head, so the nose's
offset reaches there.
"""

_NEIGHBOURS: tuple[tuple[int, ...], ...] = (
    (1, 2, 7, 8), (2, 7, 8), (1, 8, 7), (1, 7, 2), (2, 8, 1), (3, 1, 7), (4, 2, 8),
    (8, 1, 2), (7, 2, 1), (7, 8, 11), (8, 7, 12), (9, 7, 8), (10, 8, 7),
)  # fmt: skip
"""For each landmark, the ones its depth comes from when it has none itself, nearest in the body first."""


@dataclass(frozen=True, slots=True)
class LiftConfig:
    """How landmarks get their depth. The defaults are the ones that measured best; see ``benchmark lift``.

    Raises:
        InputError: If a value is out of range; the message names it.
    """

    statistic: Statistic = "surface"
    """``"surface"``: split the window into surfaces and take the landmark's own (what tells an arm before
    the chest from the chest); ``"quartile"``: the mean of the nearest quarter of the window;
    ``"median"`` of the window; ``"pixel"``: the depth at the landmark alone."""
    window_mm: float = 90.0
    """Side of the square window around a landmark, millimetres at the body's distance."""
    reach_mm: float = 1000.0
    """Depths farther than this from the body's distance, before or behind, are not the person's."""
    surface_to_joint: bool = True
    """Whether to add the constant distance from the body's surface to the joint inside it."""

    def __post_init__(self) -> None:
        """Check ranges once, where the configuration enters."""
        if self.statistic not in STATISTICS:
            raise InputError(f"LiftConfig.statistic must be one of {STATISTICS}, but got {self.statistic!r}.")
        for name in ("window_mm", "reach_mm"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"LiftConfig.{name} must be above 0 mm, but got {getattr(self, name)}.")


@dataclass(frozen=True, slots=True)
class Lifted:
    """Thirteen landmarks in space."""

    points_m: Float[np.ndarray, "13 3"]
    """Metres, camera optical frame. Always finite: what could not be measured is filled in."""
    visibility: Float[np.ndarray, 13]
    """The visibility that came in, 0 where a landmark was filled in."""
    measured: Bool[np.ndarray, 13]
    """Whether the landmark's depth was measured (true) or filled in from its neighbours (false)."""
    widened: Bool[np.ndarray, 13]
    """Whether it took a window twice as wide to measure it (a hole at the landmark, or an arm before it)."""
    spread_m: Float[np.ndarray, 13]
    """Spread of the depths of the landmark's surface within its window, metres; 0 where filled in."""
    fill: Float[np.ndarray, 13]
    """Share of the window's pixels that this surface fills; holes and all else take the rest."""
    sigma_m: Float[np.ndarray, 13]
    """One standard deviation of the landmark's place along its worst axis, metres."""
    distance_m: float
    """The body's distance along the optical axis: the paper's first-quartile mean over the trunk."""


class Lifter:
    """Turns 13 landmarks in the picture and its depth into 13 points in space.

    The body's distance is the mean of the nearest quarter of the depths between shoulders and hips
    (``distance_m``). Around each landmark as many pixels as cover 90 mm at that distance give its depth
    by ``config.statistic``; depths that are out of the body's reach are not the person's. x and y follow
    from the pixel, the depth and the intrinsics. A landmark without any depth, or outside the picture,
    takes the depth of its nearest measured neighbour in the body; its visibility becomes 0.

    Example:
        >>> import numpy as np
        >>> from wigwag import Intrinsics
        >>> wall = np.full((480, 640), 3000, dtype=np.uint16)
        >>> square = np.array([[300, 200], [340, 200], [300, 280], [340, 280]], dtype=float)
        >>> points = square[[0, 0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3]]
        >>> Lifter()(points, np.ones(13), wall, Intrinsics()).distance_m
        3.0
    """

    def __init__(self, config: LiftConfig = LiftConfig()) -> None:
        self.config = config
        offsets = np.array(SURFACE_TO_JOINT_MM[config.statistic]) * config.surface_to_joint
        self._offsets_mm = offsets

    def __call__(
        self,
        points_px: Float[np.ndarray, "13 2"],
        visibility: Float[np.ndarray, 13],
        depth_mm: UInt16[np.ndarray, "height width"],
        intrinsics: Intrinsics,
    ) -> Lifted | None:
        """Lift one person's landmarks.

        Args:
            points_px: Landmarks in pixels (u right, v down), the order of ``LANDMARKS``; may lie outside
                the picture.
            visibility: 0 to 1 each; NaN counts as 0.
            depth_mm: Depth aligned to the picture, millimetres, 0 where there is none.
            intrinsics: Of the picture that depth and landmarks share.

        Returns:
            The points, or ``None`` if there is no depth where the person is.

        Raises:
            InputError: If a shape or type is wrong, a landmark is not finite or there is no depth picture.
        """
        points = _checked(points_px, visibility, depth_mm)
        config = self.config
        code = STATISTICS.index(config.statistic)
        task = Task(
            float(intrinsics.fx), float(intrinsics.fy), float(config.window_mm), float(config.reach_mm), code
        )
        found, distance_mm = lift_depths(_one_kind(depth_mm), points, task)
        if distance_mm <= 0.0:
            return None
        measured = found[:, DEPTH] > 0.0
        z_mm = _filled(found[:, DEPTH] + self._offsets_mm, measured, distance_mm + self._offsets_mm)
        visibility = np.nan_to_num(np.asarray(visibility, dtype=np.float64), nan=0.0)
        return Lifted(
            points_m=intrinsics.deproject(points, z_mm * 1e-3),
            visibility=np.where(measured, visibility, 0.0),
            measured=measured,
            widened=found[:, WIDENED] > 0.0,
            spread_m=found[:, SPREAD] * 1e-3,
            fill=found[:, FILL],
            sigma_m=lifted_sigma_m(found, measured, z_mm, visibility),
            distance_m=float(distance_mm) * 1e-3,
        )


def _checked(points_px: Any, visibility: Any, depth_mm: Any) -> Float[np.ndarray, "13 2"]:
    points = np.ascontiguousarray(points_px, dtype=np.float64)
    if points.shape != (N_LANDMARKS, 2):
        raise InputError(f"points_px must have shape (13, 2), but got {points.shape}.")
    if np.shape(visibility) != (N_LANDMARKS,):
        raise InputError(f"visibility must have shape (13,), but got {np.shape(visibility)}.")
    if not np.isfinite(points).all():
        bad = LANDMARKS[int(np.argmin(np.isfinite(points).all(axis=1)))]
        raise InputError(f"points_px holds NaN or infinity, first at {bad}; pixels are expected.")
    if not isinstance(depth_mm, np.ndarray) or depth_mm.dtype != np.uint16 or depth_mm.ndim != 2:
        got = f"{depth_mm.dtype} {depth_mm.shape}" if isinstance(depth_mm, np.ndarray) else repr(depth_mm)
        raise InputError(
            f"depth_mm must be uint16 millimetres with shape (height, width), but got {got}. "
            "A frame without depth cannot be lifted: use a camera that gives depth aligned to colour."
        )
    return points


def _one_kind(depth_mm: UInt16[np.ndarray, "height width"]) -> UInt16[np.ndarray, "height width"]:
    """Show any depth picture to the compiler as one type: another would be compiled anew, in flight."""
    depth = np.ascontiguousarray(depth_mm).view()
    depth.flags.writeable = False
    return depth


def _filled(
    z_mm: Float[np.ndarray, 13], measured: Bool[np.ndarray, 13], otherwise_mm: Float[np.ndarray, 13]
) -> Float[np.ndarray, 13]:
    """Give every landmark without a depth that of its nearest measured neighbour in the body."""
    filled = z_mm.copy()
    for i in np.flatnonzero(~measured):
        filled[i] = next((z_mm[j] for j in _NEIGHBOURS[i] if measured[j]), otherwise_mm[i])
    return filled


__all__ = ["STATISTICS", "SURFACE_TO_JOINT_MM", "LiftConfig", "Lifted", "Lifter", "Statistic"]
