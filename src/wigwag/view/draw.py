"""Drawing what the pose network saw onto a picture: for ``wigwag pose``, the demo's film, the report."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.pose.body import BODY_BONES, N_POINTS, Body, Point
from wigwag.skeleton import BONES, LANDMARKS

Picture = UInt8[np.ndarray, "height width 3"]
Color = tuple[int, int, int]

LEFT: Color = (64, 156, 255)
"""RGB of the person's left side."""
RIGHT: Color = (255, 140, 40)
"""RGB of the person's right side."""
MIDDLE: Color = (120, 230, 140)
"""RGB of what joins both sides, and of the face."""
MISSING: Color = (255, 96, 96)
"""RGB of a banner that says that something is not there."""
_OUTLINE: Color = (20, 24, 30)
_DOT: Color = (250, 250, 250)
_FONT = cv2.FONT_HERSHEY_DUPLEX
_SHIFT = 3  # OpenCV draws at eighths of a pixel, so that a slowly moving skeleton does not tremble.

_LABELLED = tuple(
    point
    for point in Point
    if point.name.endswith(("NOSE", "SHOULDER", "ELBOW", "WRIST", "HIP", "KNEE", "ANKLE"))
)
BODY_NAMES = tuple(name.lower() for name in Point.__members__)
"""Names of BlazePose's 33 landmarks, in order."""


def draw_body(picture: Picture, body: Body, names: bool = False) -> None:
    """Draw BlazePose's 33 landmarks and their bones into ``picture``, in place.

    Args:
        picture: RGB.
        body: What was found in a picture of this size.
        names: Whether the landmarks' names stand beside them.
    """
    draw_skeleton(picture, body.points_px, body.visibility, BODY_BONES, BODY_NAMES)
    if names:
        _names(picture, body)


def draw_skeleton(
    picture: Picture,
    points_px: Float[np.ndarray, "points 2"],
    visibility: Float[np.ndarray, " points"] | None = None,
    bones: Sequence[tuple[int, int]] = BONES,
    names: Sequence[str] = LANDMARKS,
) -> None:
    """Draw landmarks and bones into ``picture``, in place: the person's left blue, right orange.

    Args:
        picture: RGB.
        points_px: Pixels (u, v); a landmark that is not finite is left out.
        visibility: 0 to 1 each; what is hardly visible is drawn faintly. By default all is visible.
        bones: Pairs of landmarks to join; the 13 landmarks' bones by default.
        names: A name a landmark, which tells its side.
    """
    points = np.asarray(points_px, dtype=np.float64)
    seen = np.ones(len(points)) if visibility is None else np.asarray(visibility, dtype=np.float64)
    # Far outside of the picture OpenCV's integers would overflow, and nothing is to be seen there.
    usable = np.all(np.isfinite(points) & (np.abs(points) < 1e5), axis=1)
    eighths = np.round(np.where(usable[:, None], points, 0.0) * 2**_SHIFT).astype(int).tolist()
    places = [(u, v) for u, v in eighths]
    width = _line_width(picture, points[usable])
    sides = [_side(name) for name in names]
    lines = [(a, b) for a, b in bones if usable[a] and usable[b]]
    colors = dict(zip(bones, bone_colors(bones, names), strict=True))
    for a, b in lines:
        cv2.line(picture, places[a], places[b], _OUTLINE, width + max(2, width // 2), cv2.LINE_AA, _SHIFT)
    for a, b in lines:
        color = _faded(colors[a, b], min(seen[a], seen[b]))
        cv2.line(picture, places[a], places[b], color, width, cv2.LINE_AA, _SHIFT)
    for i in range(len(points)):
        if not usable[i]:
            continue
        # BlazePose's eleven points of the face would hide it.
        small = len(points) == N_POINTS and sides[i] == MIDDLE
        radius = (0.4 * width if small else 1.1 * width + 0.6) * 2**_SHIFT
        cv2.circle(picture, places[i], round(radius), _OUTLINE, -1, cv2.LINE_AA, _SHIFT)
        dot = _faded(_DOT, seen[i])
        cv2.circle(picture, places[i], round(0.66 * radius), dot, -1, cv2.LINE_AA, _SHIFT)


def bone_colors(bones: Sequence[tuple[int, int]], names: Sequence[str]) -> list[Color]:
    """Return a colour a bone: the person's left blue, right orange, what joins both green.

    Example:
        >>> bone_colors([(0, 2), (0, 1)], ["left_hip", "right_hip", "left_knee"]) == [LEFT, MIDDLE]
        True
    """
    return [_side(names[a]) if _side(names[a]) == _side(names[b]) else MIDDLE for a, b in bones]


def draw_banner(picture: Picture, text: str, detail: str = "", color: Color = MIDDLE) -> None:
    """Write a line of text on a dark band along the upper edge of ``picture``, in place.

    Args:
        picture: RGB.
        text: Stands on the left, in ``color``.
        detail: Stands on the right, in grey.
        color: RGB of the text and of the line under the band.
    """
    height, width = picture.shape[:2]
    scale = max(0.4, min(height, width) / 800)
    band = max(16, round(44 * scale))
    strip = picture[:band]
    np.copyto(strip, (strip >> 2) + np.array([12, 14, 18], np.uint8))
    picture[band - max(1, round(2 * scale)) : band] = color
    baseline = round(band * 0.66)
    cv2.putText(picture, text, (round(12 * scale), baseline), _FONT, scale, color, 1, cv2.LINE_AA)
    if detail:
        (wide, _), _ = cv2.getTextSize(detail, _FONT, scale * 0.8, 1)
        place = (width - wide - round(12 * scale), baseline)
        cv2.putText(picture, detail, place, _FONT, scale * 0.8, (200, 205, 210), 1, cv2.LINE_AA)


def _names(picture: Picture, body: Body) -> None:
    """Write the landmarks' names beside them, away from the body, where there is room."""
    scale = max(0.3, min(picture.shape[:2]) / 1500)
    height, width = picture.shape[:2]
    middle = (float(body.points_px[Point.LEFT_HIP, 0]) + float(body.points_px[Point.RIGHT_HIP, 0])) / 2
    taken: list[tuple[float, float, float, float]] = []
    for point in _LABELLED:
        u, v = (float(x) for x in body.points_px[point])
        if body.visibility[point] < 0.5 or not (0 <= u < width and 0 <= v < height):
            continue
        text = point.name.lower().removeprefix("left_").removeprefix("right_")
        (wide, high), _ = cv2.getTextSize(text, _FONT, scale, 1)
        u = u + 7 if u >= middle else u - wide - 7
        box = (u, v - high, u + wide, v + high)
        if any(box[0] < o[2] and o[0] < box[2] and box[1] < o[3] and o[1] < box[3] for o in taken):
            continue
        taken.append(box)
        place = (round(u), round(v + high / 2))
        cv2.putText(picture, text, place, _FONT, scale, _OUTLINE, 3, cv2.LINE_AA)
        cv2.putText(picture, text, place, _FONT, scale, _DOT, 1, cv2.LINE_AA)


def _line_width(picture: Picture, points: Float[np.ndarray, "points 2"]) -> int:
    """Return a width that suits the picture, thinner on a small person."""
    by_picture = min(picture.shape[:2]) / 160
    tall = float(np.ptp(points[:, 1])) if len(points) else 0.0
    return max(1, round(float(min(by_picture, max(tall / 70, by_picture / 3)))))


def _side(name: str) -> Color:
    if name == "nose" or any(part in name for part in ("eye", "ear", "mouth")):
        return MIDDLE
    return LEFT if name.startswith("left") else RIGHT if name.startswith("right") else MIDDLE


def _faded(color: Color, visibility: float) -> Color:
    """Mix a colour with the outline's: a landmark that is hardly visible all but vanishes."""
    share = 0.25 + 0.75 * min(max(float(visibility), 0.0), 1.0)
    red, green, blue = (round(share * c + (1 - share) * o) for c, o in zip(color, _OUTLINE, strict=True))
    return red, green, blue


__all__ = [
    "BODY_NAMES", "LEFT", "MIDDLE", "MISSING", "RIGHT", "Color", "bone_colors", "draw_banner", "draw_body",
    "draw_skeleton",
]  # fmt: skip
