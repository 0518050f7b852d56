"""Depth of one camera as another camera sees it: for devices that leave that to their user."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, UInt16
from numba import njit

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError


@dataclass(frozen=True, slots=True)
class Extrinsic:
    """Where one camera is, seen from another: ``p_to = rotation @ p_from + translation_m``.

    Raises:
        InputError: If the shapes are wrong, the rotation is none, or the translation is not finite.
    """

    rotation: Float[np.ndarray, "3 3"]
    """From optical frame to optical frame."""
    translation_m: Float[np.ndarray, "3"]

    def __post_init__(self) -> None:
        """Check the matrix: a transposed or scaled one would bend the world quietly."""
        r, t = np.asarray(self.rotation, np.float64), np.asarray(self.translation_m, np.float64)
        if r.shape != (3, 3) or t.shape != (3,) or not np.isfinite(t).all():
            raise InputError(
                "Extrinsic needs a rotation of shape (3, 3) and a finite translation of shape (3,), "
                f"but got {r.shape} and {t.shape} {t.tolist()}."
            )
        if not (np.allclose(r @ r.T, np.eye(3), atol=1e-3) and np.linalg.det(r) > 0):
            raise InputError(f"Extrinsic.rotation must be a rotation matrix, but got {r.tolist()}.")
        object.__setattr__(self, "rotation", r)
        object.__setattr__(self, "translation_m", t)

    @classmethod
    def identity(cls) -> Extrinsic:
        """Return the extrinsic of a camera to itself."""
        return cls(np.eye(3), np.zeros(3))

    def inverse(self) -> Extrinsic:
        """Return the way back."""
        return Extrinsic(self.rotation.T, -self.rotation.T @ self.translation_m)

    def then(self, other: Extrinsic) -> Extrinsic:
        """Return this one followed by ``other``."""
        return Extrinsic(
            other.rotation @ self.rotation, other.rotation @ self.translation_m + other.translation_m
        )


class DepthAligner:
    """Moves a depth image into the picture of a colour camera beside it.

    Each depth pixel is a small square of surface. Two opposite corners are carried over into the colour
    picture, and the pixels between them get its distance *from the colour camera*: a colour picture of
    finer resolution has no holes between them. Where surfaces overlap, the nearest wins, as it does for an
    eye. Squares of unequal distance leave cracks between them; squares larger by a quarter of a pixel
    close these, and count nowhere else. What the depth camera did not measure or does not see, behind an
    edge, stays a hole (0).

    librealsense goes about it likewise, but leaves each pixel its distance from the depth camera, and lets
    every square reach one pixel farther to the right and downwards.

    The cameras may be turned against each other by a few degrees, or by quarters of a turn.

    Args:
        depth: Of the depth camera, without distortion.
        color: Of the colour camera, without distortion.
        depth_to_color: From the depth camera's optical frame to the colour camera's.

    Example:
        >>> import numpy as np
        >>> small, large = Intrinsics(50, 50, 2, 2, 4, 4), Intrinsics(100, 100, 4.5, 4.5, 8, 8)
        >>> aligner = DepthAligner(small, large, Extrinsic.identity())
        >>> int(aligner(np.full((4, 4), 1500, np.uint16))[4, 4])
        1500
    """

    def __init__(self, depth: Intrinsics, color: Intrinsics, depth_to_color: Extrinsic) -> None:
        self.depth, self.color, self.depth_to_color = depth, color, depth_to_color
        r = depth_to_color.rotation
        # The ray through corner (u, v) at z = 1 is across[u] + down[v], in the colour camera's frame already.
        us, vs = np.arange(depth.width + 1) - 0.5, np.arange(depth.height + 1) - 0.5
        middle_u, middle_v = np.arange(depth.width), np.arange(depth.height)
        self._plan = _Plan(
            across=np.outer((us - depth.cx) / depth.fx, r[:, 0]) + r[:, 2],
            down=np.outer((vs - depth.cy) / depth.fy, r[:, 1]),
            across_z=(middle_u - depth.cx) / depth.fx * r[2, 0] + r[2, 2],
            down_z=(middle_v - depth.cy) / depth.fy * r[2, 1],
            t_mm=depth_to_color.translation_m * 1e3,
            fx=color.fx,
            fy=color.fy,
            cx=color.cx,
            cy=color.cy,
        )

    def __call__(self, depth_mm: UInt16[np.ndarray, "h w"]) -> UInt16[np.ndarray, "height width"]:
        """Align one depth image.

        Args:
            depth_mm: As the depth camera gives it; 0 is a hole.

        Returns:
            Of the colour picture's size, along its optical axis; 0 is a hole.

        Raises:
            InputError: If the image is not of the depth camera's size and type.
        """
        expected = (self.depth.height, self.depth.width)
        if depth_mm.dtype != np.uint16 or depth_mm.shape != expected:
            raise InputError(
                f"The depth image to align must be uint16 with the depth camera's shape {expected}, "
                f"but got {depth_mm.dtype} {depth_mm.shape}."
            )
        exact = np.zeros((self.color.height, self.color.width), np.uint16)
        rims = np.zeros_like(exact)
        _align(np.ascontiguousarray(depth_mm), self._plan, exact, rims)
        np.copyto(exact, rims, where=exact == 0)
        return exact


class _Plan(NamedTuple):
    """What the kernel must know beside the image."""

    across: Float[np.ndarray, "columns 3"]
    down: Float[np.ndarray, "rows 3"]
    across_z: Float[np.ndarray, " width"]
    """The same for the middles of pixels, where only the distance matters."""
    down_z: Float[np.ndarray, " height"]
    t_mm: Float[np.ndarray, "3"]
    fx: float
    fy: float
    cx: float
    cy: float


_CRACK_PX = 0.25
"""Less than half, or a hole of one pixel would be closed as if it were a crack."""


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]  # numba ships no types
def _align(depth_mm: np.ndarray, p: _Plan, exact: np.ndarray, rims: np.ndarray) -> None:
    """Fill ``exact`` with what lies within the squares, ``rims`` with what lies around them."""
    height, width = exact.shape
    for v in range(depth_mm.shape[0]):
        for u in range(depth_mm.shape[1]):
            z = float(depth_mm[v, u])
            if z == 0.0:
                continue
            # two opposite corners, in the colour camera's frame, and the distance of the middle
            za = z * (p.across[u, 2] + p.down[v, 2]) + p.t_mm[2]
            zb = z * (p.across[u + 1, 2] + p.down[v + 1, 2]) + p.t_mm[2]
            seen = z * (p.across_z[u] + p.down_z[v]) + p.t_mm[2]
            if za <= 0.0 or zb <= 0.0 or seen < 0.5 or seen >= 65535.5:
                continue
            xa = p.fx * (z * (p.across[u, 0] + p.down[v, 0]) + p.t_mm[0]) / za + p.cx
            ya = p.fy * (z * (p.across[u, 1] + p.down[v, 1]) + p.t_mm[1]) / za + p.cy
            xb = p.fx * (z * (p.across[u + 1, 0] + p.down[v + 1, 0]) + p.t_mm[0]) / zb + p.cx
            yb = p.fy * (z * (p.across[u + 1, 1] + p.down[v + 1, 1]) + p.t_mm[1]) / zb + p.cy
            x0, x1, y0, y1 = min(xa, xb), max(xa, xb), min(ya, yb), max(ya, yb)
            if x1 < -1.0 or y1 < -1.0 or x0 > width or y0 > height:
                continue
            near = np.uint16(seen + 0.5)
            top, bottom = max(0, math.ceil(y0 - _CRACK_PX)), min(height, math.ceil(y1 + _CRACK_PX))
            left, right = max(0, math.ceil(x0 - _CRACK_PX)), min(width, math.ceil(x1 + _CRACK_PX))
            for y in range(top, bottom):
                for x in range(left, right):
                    if x0 <= x < x1 and y0 <= y < y1:
                        if exact[y, x] == 0 or near < exact[y, x]:
                            exact[y, x] = near
                    elif rims[y, x] == 0 or near < rims[y, x]:
                        rims[y, x] = near


__all__ = ["DepthAligner", "Extrinsic"]
