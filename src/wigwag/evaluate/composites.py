"""People far away: real photos of people, shrunk and set on real clutter.

The clutter is what other photos show beside their person: walls, doors, desks, chairs. Three styles say how
much the pasted picture gives itself away: ``cutout`` has no edge but the person's own (their silhouette, as
the landmark network sees it at full size), ``window`` brings some of the photo's wall along, its edges hard
or blended over up to five pixels, ``photo`` is the whole photo made small.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.errors import DataError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body, Point

Picture = UInt8[np.ndarray, "height width 3"]
Style = Literal["cutout", "window", "photo"]
Clutter = Literal["joined", "painted", "part", "collage"]

STYLES: tuple[Style, ...] = ("cutout", "window", "photo")
CLUTTER: tuple[Clutter, ...] = ("joined", "painted", "part", "collage")
"""What a background is: the photo without the column its person stands in, its two sides joined; the photo
with the person painted over from around them; an enlarged part; four or nine photos without their persons
side by side, so that the clutter is as small as a far person."""
SIZE = (640, 480)
"""Width and height of every composite, pixels."""
_CROWN = 1.11
"""Height from crown to toe over that from eyes to toe, as seen from a little above: the median over 114 of
the operator photos with lowered arms and whole bodies is 1.113 (5 to 95 %: 1.097 to 1.146)."""
_INTERPOLATIONS = (cv2.INTER_AREA, cv2.INTER_LINEAR, cv2.INTER_CUBIC, cv2.INTER_LANCZOS4)


@dataclass(frozen=True, slots=True)
class Photo:
    """A photo of one person, and what the networks see in it at its own size."""

    path: Path
    rgb: Picture
    body: Body
    silhouette: Float[np.ndarray, "height width"]
    """How surely a pixel is the person, 0 to 1."""

    @property
    def person_px(self) -> float:
        """Height of the person, crown to toe, pixels; raised arms do not count."""
        return _CROWN * (self._toes - self._eyes)

    @property
    def _eyes(self) -> float:
        return float(self.body.points_px[[Point.LEFT_EYE, Point.RIGHT_EYE], 1].mean())

    @property
    def _toes(self) -> float:
        lowest = [Point.LEFT_HEEL, Point.RIGHT_HEEL, Point.LEFT_FOOT_INDEX, Point.RIGHT_FOOT_INDEX]
        return float(self.body.points_px[lowest, 1].max())

    def box(self, margin: float) -> Float[np.ndarray, " 4"]:
        """Return left, top, right, bottom around the person.

        Args:
            margin: How much wider than the landmarks, as a share of the person's height.
        """
        low, high = self.body.points_px.min(axis=0), self.body.points_px.max(axis=0)
        wider = margin * self.person_px
        crown = (_CROWN - 1.0) * (self._toes - self._eyes)
        return np.array([low[0] - wider, low[1] - crown - wider, high[0] + wider, high[1] + wider])


@dataclass(frozen=True, slots=True)
class Scene:
    """A small person before clutter, to be set wherever they stand at the moment."""

    clutter: Picture
    person: Float[np.ndarray, "rows columns 3"]
    alpha: Float[np.ndarray, "rows columns 1"]
    points_px: Float[np.ndarray, "33 2"]
    """The landmarks seen at full size, in pixels of ``person``."""
    style: Style
    kind: Clutter
    jpeg: int | None
    """Quality at which the composite is compressed and unpacked again."""

    @property
    def room(self) -> tuple[int, int]:
        """How far right and down the person's picture may lie; negative where it is the larger one."""
        return SIZE[0] - self.person.shape[1], SIZE[1] - self.person.shape[0]

    def at(self, u: int, v: int) -> tuple[Picture, Float[np.ndarray, "33 2"]]:
        """Return the composite with the person's upper left corner at ``(u, v)``, and the landmarks in it."""
        rows, columns = self.alpha.shape[:2]
        left, top = max(u, 0), max(v, 0)
        right, bottom = min(u + columns, SIZE[0]), min(v + rows, SIZE[1])
        rgb = self.clutter.copy()
        if left < right and top < bottom:
            cut = (slice(top - v, bottom - v), slice(left - u, right - u))
            alpha, place = self.alpha[cut], (slice(top, bottom), slice(left, right))
            mixed = rgb[place] * (1.0 - alpha) + self.person[cut] * alpha
            rgb[place] = np.clip(np.rint(mixed), 0, 255).astype(np.uint8)
        return self.taken(rgb), self.points_px + np.array([u, v])

    def taken(self, rgb: Picture) -> Picture:
        """Return the picture as it comes out of the camera's compression."""
        if self.jpeg is None:
            return rgb
        _, data = cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, self.jpeg])
        return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR))


def load_photos(
    folder: Path, pose: BlazePose, progress: Callable[[int, int], None] | None = None
) -> tuple[list[Photo], list[Path]]:
    """Read ``folder/*/*.jpg`` and find the person in each photo at its own size.

    Returns:
        The photos with somebody in them, and the paths of those in which nobody was found.

    Raises:
        DataError: If there are no photos, or one cannot be read.
    """
    paths = sorted(folder.glob("*/*.jpg"))
    if not paths:
        raise DataError(f"{folder}: expected photos of people, FOLDER/*.jpg, but there are none.")
    photos, empty = [], []
    for done, path in enumerate(paths):
        bgr = cv2.imread(str(path))
        if bgr is None:
            raise DataError(f"{path}: cannot be read as a picture. Fetch it anew or take it away.")
        rgb = np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB))
        seen = pose.sight(rgb)
        if seen is None:
            empty.append(path)
        else:
            photos.append(Photo(path, rgb, seen.body, pose.silhouette(rgb, seen.region)))
        if progress:
            progress(done + 1, len(paths))
    return photos, empty


def empty_parts(photo: Photo, least_px: int = 120) -> list[Picture]:
    """Return what is left and right of the person, if it is at least so wide."""
    left, _, right, _ = photo.box(0.12)
    width = photo.rgb.shape[1]
    parts = [photo.rgb[:, : max(int(left), 0)], photo.rgb[:, min(int(np.ceil(right)), width) :]]
    return [part for part in parts if part.shape[1] >= least_px]


def joined(photo: Photo) -> Picture:
    """Return the photo without the column its person stands in; one side mirrored if there is no other.

    Raises:
        DataError: If the person leaves less than 60 pixels on both sides.
    """
    parts = empty_parts(photo, 60)
    if not parts:
        raise DataError(f"{photo.path}: the person fills it; nothing of the room is left to make clutter of.")
    return _beside(parts[0], parts[1] if len(parts) == 2 else parts[0][:, ::-1])


def painted_over(photo: Photo) -> Picture:
    """Return the photo with the person painted over from what is around them (Telea, 2004)."""
    mask = cv2.dilate((photo.silhouette > 0.08).astype(np.uint8), np.ones((15, 15), np.uint8))
    return np.asarray(cv2.inpaint(photo.rgb, mask, 7, cv2.INPAINT_TELEA))


def make_clutter(rng: np.random.Generator, photos: Sequence[Photo], kind: Clutter) -> Picture:
    """Return a picture of ``SIZE`` of rooms without their people."""
    width, height = SIZE
    if kind == "joined":
        picture = joined(_pick(rng, photos))
    elif kind == "painted":
        picture = painted_over(_pick(rng, photos))
    elif kind == "part":
        picture = random_part(rng, photos, SIZE)
    else:
        n = int(rng.integers(2, 4))
        tile = (width // n + 20, height // n + 20)
        rows = [
            _side_by_side([cv2.resize(_turned(rng, joined(_pick(rng, photos))), tile) for _ in range(n)])
            for _ in range(n)
        ]
        picture = _side_by_side([row.transpose(1, 0, 2) for row in rows]).transpose(1, 0, 2)
    enlarged = picture.shape[1] < width
    return np.ascontiguousarray(
        cv2.resize(_turned(rng, picture), SIZE, interpolation=cv2.INTER_CUBIC if enlarged else cv2.INTER_AREA)
    )


def random_part(rng: np.random.Generator, photos: Sequence[Photo], shape: tuple[int, int]) -> Picture:
    """Cut a rectangle of the proportions of ``shape`` (width, height) out of what is beside a person."""
    parts: list[Picture] = []
    while not parts:
        parts = empty_parts(_pick(rng, photos), 160)
    part = parts[rng.integers(len(parts))]
    height, width = part.shape[:2]
    columns = min(rng.uniform(0.6, 1.0) * width, height * shape[0] / shape[1])
    rows = int(columns * shape[1] / shape[0])
    u = int(rng.integers(width - int(columns) + 1))
    v = int(rng.integers(height - rows + 1))
    return np.asarray(part[v : v + rows, u : u + int(columns)])


def make_scene(
    rng: np.random.Generator,
    photo: Photo,
    others: Sequence[Photo],
    person_px: float,
    *,
    style: Style,
    kind: Clutter,
) -> Scene:
    """Shrink a photo's person and set them before clutter from other photos.

    Args:
        rng: Margins, blending, interpolation, compression and clutter are random.
        photo: Whose person.
        others: Photos the clutter is made of; ``photo`` itself is left out.
        person_px: Height of the person in the composite, crown to toe, pixels.
        style: What is pasted.
        kind: What it is pasted on.
    """
    height, width = photo.rgb.shape[:2]
    share = person_px / photo.person_px
    if style == "photo":
        box = np.array([0, 0, width, height])
    else:
        box = photo.box(0.1 if style == "cutout" else float(rng.uniform(0.08, 0.5)))
        box = np.clip(np.rint(box), 0, (width, height, width, height)).astype(int)
    cut = (slice(int(box[1]), int(box[3])), slice(int(box[0]), int(box[2])))
    rows, columns = photo.rgb[cut].shape[:2]
    small = (max(round(columns * share), 1), max(round(rows * share), 1))
    how = int(rng.choice(_INTERPOLATIONS))
    alpha = np.ones((small[1], small[0]))
    if style == "cutout":
        # A pixel wider than the silhouette: half of the outline's pixels are hair and sleeves.
        silhouette = cv2.dilate(photo.silhouette[cut], np.ones((3, 3), np.uint8))
        alpha = np.clip(cv2.resize(silhouette, small, interpolation=cv2.INTER_AREA), 0.0, 1.0)
    elif style == "window":
        alpha = _blended(small, int(rng.integers(6)))
    step = np.array([small[0] / columns, small[1] / rows])
    return Scene(
        clutter=make_clutter(rng, [other for other in others if other.path != photo.path], kind),
        person=cv2.resize(photo.rgb[cut], small, interpolation=how).astype(np.float64),
        alpha=alpha[:, :, None],
        points_px=(photo.body.points_px - box[:2] + 0.5) * step - 0.5,
        style=style,
        kind=kind,
        jpeg=int(rng.integers(60, 96)) if rng.random() < 0.5 else None,
    )


def _blended(size: tuple[int, int], pixels: int) -> Float[np.ndarray, "rows columns"]:
    """Return how much of a picture of this size is seen: less over the last pixels before its edges."""
    across, down = (
        np.minimum(1.0, (np.minimum(np.arange(n), np.arange(n)[::-1]) + 1.0) / (pixels + 1.0)) for n in size
    )
    return np.asarray(np.minimum(down[:, None], across[None, :]))


def _pick(rng: np.random.Generator, photos: Sequence[Photo]) -> Photo:
    return photos[int(rng.integers(len(photos)))]


def _turned(rng: np.random.Generator, picture: Picture) -> Picture:
    return np.ascontiguousarray(picture[:, ::-1] if rng.random() < 0.5 else picture)


def _beside(left: Picture, right: Picture, blend: int = 20) -> Picture:
    """Join two pictures of one height, blended where they meet."""
    blend = min(blend, left.shape[1], right.shape[1])
    weight = np.linspace(0.0, 1.0, blend)[None, :, None]
    seam = left[:, left.shape[1] - blend :] * (1.0 - weight) + right[:, :blend] * weight
    return np.hstack([left[:, : left.shape[1] - blend], seam.astype(np.uint8), right[:, blend:]])


def _side_by_side(pictures: Sequence[Picture]) -> Picture:
    joined_up = pictures[0]
    for picture in pictures[1:]:
        joined_up = _beside(joined_up, picture)
    return joined_up


__all__ = [
    "CLUTTER",
    "SIZE",
    "STYLES",
    "Clutter",
    "Photo",
    "Scene",
    "Style",
    "empty_parts",
    "joined",
    "load_photos",
    "make_clutter",
    "make_scene",
    "painted_over",
    "random_part",
]
