"""What somebody looks like: the colours of chest, belly and thighs, as far as light leaves them alone.

A colour is kept as its share of red, green and blue in linear light, which neither shade nor exposure
changes, and as its brightness against the person's other parts. Means over some hundred pixels are kept and
not histograms: in the dark, noise spreads the colour of a single pixel over half of any histogram.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, UInt8, UInt16

from wigwag.pose.body import Body, Point

_ACROSS, _ALONG = 9, 12
_MIN_SAMPLES = 25
"""Of the 108 pixels of a part; with fewer of the person's own, the part's colour is not known."""
_FLOOR = 0.06
"""Of the brightest part's light: added to every part, so that what is nearly black has no colour."""
_REACH_M = 0.35
"""Pixels whose depth differs by more from the body's are somebody else's, or of what stands around."""
_ARM = 0.15
"""Torsos: what lies nearer to a forearm or hand in the picture may be bare skin before the clothes."""
_CHROMA = 0.045
_BRIGHTNESS = 0.45
"""What counts as one unit of difference: shares of a colour, and the logarithm of a brightness. The same
person's parts differ by less than one from frame to frame and from sun to shade."""

_LINEAR = (np.arange(256, dtype=np.float32) / 255) ** np.float32(2.2)


@dataclass(frozen=True, slots=True)
class Appearance:
    """The colours of one person's clothes.

    Example:
        >>> shades = np.array([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], [0.2, 0.2, 0.2]])
        >>> one, dimmed = Appearance.of(shades), Appearance.of(0.02 * shades)
        >>> one.difference(dimmed) < 1e-6
        True
    """

    values: Float[np.ndarray, "3 4"]
    """Chest, belly, thighs; shares of red, green and blue, and the logarithm of the brightness against the
    brightest part. NaN where a part was not seen."""

    @classmethod
    def of(cls, light: Float[np.ndarray, "3 3"]) -> Appearance:
        """Build it from the mean linear light of chest, belly and thighs (RGB; NaN: not seen)."""
        light = np.asarray(light, dtype=np.float64)
        total = light.sum(axis=1, keepdims=True)
        top = float(np.nanmax(total)) if np.isfinite(total).any() else np.nan
        floor = _FLOOR * max(top, 1e-9)
        shares = (light + floor / 3) / (total + floor)
        return cls(np.column_stack([shares, np.log((total + floor) / (top + floor))]))

    @property
    def known(self) -> bool:
        """Whether any part was seen."""
        return bool(np.isfinite(self.values).any())

    def difference(self, other: Appearance) -> float:
        """Return how different two people look: below about 1 for the same one, 0 if no part is common.

        The root of the mean over the parts that both have seen of the squared differences.
        """
        scale = np.array([_CHROMA] * 3 + [_BRIGHTNESS])
        off = ((self.values - other.values) / scale) ** 2
        parts = off.sum(axis=1)
        parts = parts[np.isfinite(parts)]
        return float(np.sqrt(parts.mean())) if len(parts) else 0.0

    def towards(self, other: Appearance, share: float) -> Appearance:
        """Return this moved towards ``other`` by ``share``; a part that one has not seen is the other's."""
        moved = self.values + share * (other.values - self.values)
        either = np.where(np.isfinite(self.values), self.values, other.values)
        return Appearance(np.where(np.isfinite(moved), moved, either))


def appearance_of(
    rgb: UInt8[np.ndarray, "height width 3"],
    depth_mm: UInt16[np.ndarray, "height width"] | None,
    body: Body,
    distance_m: float,
) -> Appearance | None:
    """Look at somebody's clothes.

    Args:
        rgb: The picture.
        depth_mm: Aligned depth; pixels off the body's distance are left out. ``None``: all are taken.
        body: Where the person is in the picture.
        distance_m: Of the body along the optical axis.

    Returns:
        Their appearance, or ``None`` if too little of them is seen.
    """
    points = body.points_px
    shoulders, hips = points[[11, 12]].mean(axis=0), points[[23, 24]].mean(axis=0)
    torso = float(np.linalg.norm(shoulders - hips))
    if not 4.0 < torso < 1e4:
        return None
    shoulder_width = float(np.linalg.norm(points[11] - points[12]))
    # Seen from the side, shoulders are narrow and the trunk is not.
    half = float(np.clip(0.36 * shoulder_width, 0.13 * torso, 0.3 * torso))
    belly = shoulders + 0.5 * (hips - shoulders)
    thighs = []
    for hip, knee in ((Point.LEFT_HIP, Point.LEFT_KNEE), (Point.RIGHT_HIP, Point.RIGHT_KNEE)):
        span = points[knee] - points[hip]
        if np.linalg.norm(span) > 0.2 * torso:
            thighs.append(
                _grid(points[hip] + 0.2 * span, points[hip] + 0.75 * span, 0.09 * torso, _ALONG // 2)
            )
    parts = [
        _grid(shoulders + 0.12 * (hips - shoulders), belly, half, _ALONG),
        _grid(belly, shoulders + 0.88 * (hips - shoulders), half, _ALONG),
        np.concatenate(thighs) if thighs else np.zeros((0, 2)),
    ]
    clear = [places[_off_arms(places, points, _ARM * torso)] for places in parts]
    found = Appearance.of(np.stack([_light(rgb, depth_mm, places, distance_m) for places in clear]))
    return found if found.known else None


def _grid(
    start: Float[np.ndarray, " 2"], end: Float[np.ndarray, " 2"], half_px: float, steps: int
) -> Float[np.ndarray, "places 2"]:
    """Return places in the picture along an axis and to both sides of it."""
    along = end - start
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-6)
    forth = np.linspace(0.0, 1.0, steps)[:, None, None] * along
    aside = np.linspace(-half_px, half_px, _ACROSS)[None, :, None] * across
    return np.asarray((start + forth + aside).reshape(-1, 2))


def _off_arms(
    places: Float[np.ndarray, "places 2"], points: Float[np.ndarray, "33 2"], radius_px: float
) -> Bool[np.ndarray, " places"]:
    """Say which places are clear of both forearms and hands."""
    clear = np.ones(len(places), bool)
    for elbow, tip in ((Point.LEFT_ELBOW, Point.LEFT_INDEX), (Point.RIGHT_ELBOW, Point.RIGHT_INDEX)):
        span = points[tip] - points[elbow]
        share = np.clip((places - points[elbow]) @ span / max(float(span @ span), 1e-6), 0.0, 1.0)
        away = places - points[elbow] - share[:, None] * span
        clear &= np.hypot(away[:, 0], away[:, 1]) > radius_px
    return clear


def _light(
    rgb: UInt8[np.ndarray, "height width 3"],
    depth_mm: UInt16[np.ndarray, "height width"] | None,
    places: Float[np.ndarray, "places 2"],
    distance_m: float,
) -> Float[np.ndarray, " 3"]:
    """Return the mean linear light of the person's own pixels at some places, NaN if there are too few."""
    height, width = rgb.shape[:2]
    u, v = np.round(places).astype(np.intp).T
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    u, v = u[inside], v[inside]
    if depth_mm is not None:
        depth = depth_mm[v, u]
        own = (depth > 0) & (np.abs(depth * 1e-3 - distance_m) < _REACH_M)
        u, v = u[own], v[own]
    if len(u) < _MIN_SAMPLES:
        return np.full(3, np.nan)
    return np.asarray(_LINEAR[rgb[v, u]].mean(axis=0, dtype=np.float64))


__all__ = ["Appearance", "appearance_of"]
