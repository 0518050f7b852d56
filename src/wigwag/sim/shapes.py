"""Solid shapes a scene is made of: tapered capsules and boxes, each seen through a linear map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int


class Surface(IntEnum):
    """How the renderer paints a shape."""

    PLAIN = 0
    """Colour 0 up to ``cut`` along the axis, colour 1 beyond: a sleeve and the skin after it."""
    FACE = 1
    """Eyes, brows, mouth, cheeks on skin, hair in colour 1; a beard if ``cut`` is 1. Turns with the head."""
    SHOE = 2
    """Colour 0 above, colour 1 on the sole."""
    LEAVES = 3
    """Colour 0 and colour 1 mixed by noise that is fixed to the world."""
    PLANKS = 4
    """Colour 0 with thin lines of colour 1, for boxes."""


@dataclass(frozen=True, slots=True)
class Shapes:
    """Many shapes, one a row, ready for the compiled renderer.

    A shape is what the points of a simple solid become under a linear map. The solid of a tapered
    capsule is the hull of two spheres (centres ``a`` and ``b``, radii ``ra`` and ``rb``); if the two
    centres are one point it is a sphere, which the map turns into an ellipsoid. A box is the cube of
    half-width 1 around ``a``. Mapping the ray instead of the solid keeps the distance along the ray,
    so one intersection serves them all.
    """

    a: Float[np.ndarray, "shapes 3"]
    """First end, metres, world frame ENU."""
    b: Float[np.ndarray, "shapes 3"]
    """Second end, metres, world frame ENU; the centre again for a sphere or a box."""
    radii: Float[np.ndarray, "shapes 2"]
    """Radius at each end in the local frame, metres. A box holds its circumscribed radius in metres."""
    maps: Float[np.ndarray, "shapes 3 3"]
    """World directions into the local frame: rows forward, left, up, each divided by its stretch."""
    is_box: Bool[np.ndarray, " shapes"]
    surface: Int[np.ndarray, " shapes"]
    """A ``Surface`` each."""
    colours: Float[np.ndarray, "shapes 2 3"]
    """Linear RGB, 0 to 1."""
    cut: Float[np.ndarray, " shapes"]
    """Where along the axis, 0 to 1, colour 0 gives way to colour 1."""

    def __len__(self) -> int:
        return len(self.a)

    @property
    def paint(self) -> Float[np.ndarray, "shapes 9"]:
        """What the compiled renderer needs to paint each: box or not, surface, cut, two colours."""
        head = np.stack([self.is_box, self.surface, self.cut], axis=1).astype(np.float64)
        return np.concatenate([head, self.colours.reshape(-1, 6)], axis=1)

    @classmethod
    def joined(cls, groups: Sequence[Self]) -> Self:
        """Put several groups of shapes into one."""
        if len(groups) == 1:
            return groups[0]
        return cls(*(np.concatenate([getattr(g, f) for g in groups]) for f in cls.__slots__))

    @classmethod
    def capsules(
        cls,
        a: Float[np.ndarray, "shapes 3"],
        b: Float[np.ndarray, "shapes 3"],
        radii: Float[np.ndarray, "shapes 2"],
        colours: Float[np.ndarray, "shapes 2 3"],
        surface: Surface = Surface.PLAIN,
    ) -> Self:
        """Tapered capsules in the world frame, painted in colour 0."""
        n = len(a)
        return cls(
            np.asarray(a, float), np.asarray(b, float), np.asarray(radii, float),
            np.broadcast_to(np.eye(3), (n, 3, 3)).copy(), np.zeros(n, bool),
            np.full(n, int(surface)), np.asarray(colours, float), np.ones(n),
        )  # fmt: skip

    @classmethod
    def box(
        cls,
        centre: Float[np.ndarray, 3],
        half_size: Float[np.ndarray, 3],
        heading_rad: float,
        colours: Float[np.ndarray, "2 3"],
        surface: Surface = Surface.PLANKS,
    ) -> Self:
        """Build one upright box, metres, turned about the vertical by ``heading_rad``."""
        c, s = np.cos(heading_rad), np.sin(heading_rad)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        half = np.asarray(half_size, float)
        around = float(np.linalg.norm(half))
        return cls(
            np.asarray(centre, float)[None], np.asarray(centre, float)[None],
            np.array([[around, around]]), (turn / half[:, None])[None], np.ones(1, bool),
            np.full(1, int(surface)), np.asarray(colours, float)[None], np.ones(1),
        )  # fmt: skip


def linear_rgb(hex_colour: str) -> tuple[float, float, float]:
    """Turn a display colour (sRGB, ``"#rrggbb"``) into linear light, 0 to 1.

    Example:
        >>> linear_rgb("#ff0080")[0]
        1.0
    """
    parts = (int(hex_colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return r, g, b
