"""Landmarks in the picture plus a depth picture become a 3-D pose (paper, section 1, steps 3 to 5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, UInt16
from numba import njit

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError
from wigwag.skeleton import LANDMARKS, N_LANDMARKS, Landmark

Statistic = Literal["quartile", "median", "pixel"]
"""How the depths of a landmark's window become one number; see :class:`LiftConfig`."""

STATISTICS: tuple[Statistic, ...] = get_args(Statistic)

_CODES: dict[str, int] = {name: i for i, name in enumerate(STATISTICS)}
_QUARTILE, _MEDIAN, _PIXEL = range(3)

SURFACE_TO_JOINT_MM: dict[str, tuple[float, ...]] = {
    "quartile": (126, 96, 96, 61, 61, 43, 43, 115, 115, 106, 106, 66, 66),
    "median": (116, 69, 69, 41, 41, 22, 22, 100, 100, 84, 84, 49, 49),
    "pixel": (120, 72, 72, 42, 42, 26, 26, 101, 101, 90, 90, 47, 47),
}
"""How far behind the surface each joint lies, by statistic, in the order of ``LANDMARKS``."""

_KIN: tuple[tuple[int, ...], ...] = (
    (1, 2), (2, 7), (1, 8), (1, 2), (2, 1), (3, 1), (4, 2), (8, 1), (7, 2), (7, 8), (8, 7), (9, 7), (10, 8),
)  # fmt: skip
"""For each landmark, where its depth comes from when it has none itself: nearest first."""


@dataclass(frozen=True, slots=True)
class LiftConfig:
    """How landmarks get their depth. The defaults are the ones that measured best; see ``benchmark lift``.

    Raises:
        InputError: If a value is out of range; the message names it.
    """

    statistic: Statistic = "median"
    """``"quartile"``: the mean of the nearest quarter of the window; ``"median"`` of the window;
    ``"pixel"``: the depth at the landmark alone."""
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
            visibility: 0 to 1 each.
            depth_mm: Depth aligned to the picture, millimetres, 0 where there is none.
            intrinsics: Of the picture that depth and landmarks share.

        Returns:
            The points, or ``None`` if there is no depth where the person is.

        Raises:
            InputError: If a shape or type is wrong, a landmark is not finite or there is no depth picture.
        """
        points = _checked(points_px, visibility, depth_mm)
        z_mm, measured, distance_mm = _lift(
            depth_mm,
            points,
            intrinsics.fx,
            intrinsics.fy,
            self.config.window_mm,
            self.config.reach_mm,
            _CODES[self.config.statistic],
        )
        if distance_mm <= 0.0:
            return None
        z_mm = _filled(z_mm + self._offsets_mm, measured, distance_mm)
        points_m = intrinsics.deproject(points, z_mm * 1e-3)
        seen = np.where(measured, np.asarray(visibility, dtype=np.float64), 0.0)
        return Lifted(points_m, seen, measured, float(distance_mm) * 1e-3)


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


def _filled(z_mm: Float[np.ndarray, 13], measured: Bool[np.ndarray, 13], distance_mm: float) -> Any:
    """Give every landmark without a depth that of its nearest neighbour in the body."""
    if measured.all():
        return z_mm
    filled = z_mm.copy()
    known = measured.copy()
    for i in range(N_LANDMARKS):  # parents stand before their children in LANDMARKS
        if known[i]:
            continue
        source = [z_mm[j] for j in _KIN[i] if known[j]]
        filled[i] = source[0] if source else distance_mm
    return filled


@njit(cache=True)  # type: ignore[untyped-decorator]  # numba ships no types
def _lift(  # noqa: PLR0917
    depth: Any, points: Any, fx: float, fy: float, window_mm: float, reach_mm: float, code: int
) -> tuple[Any, Any, float]:
    z = np.zeros(len(points))
    measured = np.zeros(len(points), dtype=np.bool_)
    values = np.empty(4096, dtype=np.float64)
    distance = _body_distance(depth, points, values)
    if distance <= 0.0:
        return z, measured, 0.0
    # eq. window: 90 mm x f / Z
    half_u = max(0.5 * window_mm * fx / distance, 1.0)
    half_v = max(0.5 * window_mm * fy / distance, 1.0)
    for i in range(len(points)):
        z[i] = _window(depth, points[i, 0], points[i, 1], half_u, half_v, distance, reach_mm, code, values)
        measured[i] = z[i] > 0.0
    return z, measured, distance


@njit(cache=True)  # type: ignore[untyped-decorator]
def _body_distance(depth: Any, points: Any, values: Any) -> float:
    """First-quartile mean of the depths between shoulders and hips, 0 if there are none."""
    height, width = depth.shape
    quad = np.array([1, 2, 8, 7])
    u0, u1 = points[quad, 0].min(), points[quad, 0].max()
    v0, v1 = points[quad, 1].min(), points[quad, 1].max()
    low_u, high_u = max(int(np.floor(u0)), 0), min(int(np.ceil(u1)), width - 1)
    low_v, high_v = max(int(np.floor(v0)), 0), min(int(np.ceil(v1)), height - 1)
    area = max(high_u - low_u + 1, 0) * max(high_v - low_v + 1, 0)
    stride = max(int(np.ceil(np.sqrt(area / 1000.0))), 1)
    for inside_only in (True, False):  # a trunk seen from the side has no inside: take its box
        n = 0
        for v in range(low_v, high_v + 1, stride):
            for u in range(low_u, high_u + 1, stride):
                if depth[v, u] > 0 and n < len(values) and (not inside_only or _inside(points, quad, u, v)):
                    values[n] = depth[v, u]
                    n += 1
        if n >= 8:
            return _first_quartile_mean(values[:n])
    return 0.0


@njit(cache=True)  # type: ignore[untyped-decorator]
def _inside(points: Any, quad: Any, u: float, v: float) -> bool:
    inside = False
    for a in range(len(quad)):
        ua, va = points[quad[a], 0], points[quad[a], 1]
        ub, vb = points[quad[a - 1], 0], points[quad[a - 1], 1]
        if (va > v) != (vb > v) and u < (ub - ua) * (v - va) / (vb - va) + ua:
            inside = not inside
    return inside


@njit(cache=True)  # type: ignore[untyped-decorator]
def _first_quartile_mean(values: Any) -> float:
    values.sort()
    mean: float = values[: max((len(values) + 3) // 4, 1)].mean()
    return mean


@njit(cache=True)  # type: ignore[untyped-decorator]
def _window(  # noqa: PLR0917
    depth: Any, u: float, v: float, half_u: float, half_v: float, body: float, reach: float, code: int,
    values: Any,
) -> float:  # fmt: skip
    """Depth of one landmark, 0 if its window has none."""
    height, width = depth.shape
    if not (-0.5 <= u < width - 0.5 and -0.5 <= v < height - 0.5):
        return 0.0
    if code == _PIXEL:
        z = float(depth[int(np.floor(v + 0.5)), int(np.floor(u + 0.5))])
        return z if abs(z - body) <= reach else 0.0
    for widen in (1.0, 2.0):
        n = _gather(depth, u, v, half_u * widen, half_v * widen, body, reach, values)
        if n > 0:
            if code == _MEDIAN:
                middle: float = np.median(values[:n])
                return middle
            return _first_quartile_mean(values[:n])
    return 0.0


@njit(cache=True)  # type: ignore[untyped-decorator]
def _gather(  # noqa: PLR0917
    depth: Any, u: float, v: float, half_u: float, half_v: float, body: float, reach: float, values: Any
) -> int:
    """Collect the person's depths around (u, v); large windows are thinned to bound the time."""
    height, width = depth.shape
    u0, u1 = max(int(np.ceil(u - half_u)), 0), min(int(np.floor(u + half_u)), width - 1)
    v0, v1 = max(int(np.ceil(v - half_v)), 0), min(int(np.floor(v + half_v)), height - 1)
    stride = max((max(u1 - u0, v1 - v0) + 20) // 20, 1)
    n = 0
    for y in range(v0, v1 + 1, stride):
        for x in range(u0, u1 + 1, stride):
            z = float(depth[y, x])
            if z > 0.0 and abs(z - body) <= reach:
                values[n] = z
                n += 1
    return n


__all__ = ["LANDMARKS", "STATISTICS", "Landmark", "LiftConfig", "Lifted", "Lifter", "Statistic"]
