"""BlazePose's landmark network: the 33 landmarks of the person in a region of the picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.pose.body import N_POINTS, Body, Point
from wigwag.pose.network import PictureNetwork
from wigwag.pose.region import Region
from wigwag.pose.sides import other_side
from wigwag.skeleton import from_blazepose33

_N_ALL = 39  # 33 landmarks, two alignment points for the next region, four that nobody uses
_LANDMARKS, _WORLD, _SCORE, _HEAT = (1, _N_ALL * 5), (1, _N_ALL * 3), (1, 1), (1, 64, 64, _N_ALL)
_MIRRORED = np.array([*(other_side(point) for point in Point), *range(N_POINTS, _N_ALL)])
_MIN_INSIDE = 5  # landmarks: head, shoulders and elbows are the least that is a person
_REACH = 3  # of the 7 x 7 window in which a landmark is refined


class Sighting(NamedTuple):
    """A body, and the region to look at next."""

    body: Body
    region: Region

    @property
    def score(self) -> float:
        """``Body.score``, which is known here."""
        return self.body.score or 0.0

    @property
    def clarity(self) -> float:
        """``Body.clarity``, which is known here."""
        return self.body.clarity or 0.0


class Landmarker:
    """Finds the landmarks of the one person in a region.

    Args:
        path: ``pose_landmark_lite.tflite``, ``..._full...`` or ``..._heavy...``.
        threads: Threads of the interpreter.
    """

    def __init__(self, path: Path, threads: int = 1) -> None:
        # Not among them: a mask of the person, which takes two fifths of the network's time.
        outputs = (_LANDMARKS, _HEAT, _WORLD, _SCORE)
        self._network = PictureNetwork(
            path, threads, low=0.0, high=1.0, border=cv2.BORDER_REPLICATE, outputs=outputs
        )
        self._path, self._threads = path, threads
        self._whole: PictureNetwork | None = None

    def __call__(
        self, rgb: UInt8[np.ndarray, "height width 3"], region: Region, *, mirrored: bool = False
    ) -> Sighting:
        """Return the landmarks in ``region``, whether or not a person is there: see ``body.clarity``.

        Args:
            rgb: The picture.
            region: Where to look.
            mirrored: Show the network the mirror image. What is returned is turned back: it differs from
                the other look by what the network is unsure of.
        """
        self._network.run(rgb, region, mirrored=mirrored)
        raw = self._network.output(*_LANDMARKS)[0].reshape(_N_ALL, 5).astype(np.float64)
        heat = self._network.output(*_HEAT)[0]
        points, peaks = refine(raw[:, :2] / self._network.pixels, heat)
        world = self._network.output(*_WORLD)[0].reshape(_N_ALL, 3)[:N_POINTS].astype(np.float64)
        if mirrored:
            points = points[_MIRRORED] * (-1.0, 1.0) + (1.0, 0.0)
            world = world[_MIRRORED[:N_POINTS]] * (-1.0, 1.0, 1.0)
            raw, peaks = raw[_MIRRORED], peaks[_MIRRORED]
        placed = region.to_picture(points)
        c, s = math.cos(region.angle_rad), math.sin(region.angle_rad)
        world[:, :2] = world[:, :2] @ np.array([[c, s], [-s, c]])
        body = Body(
            points_px=placed[:N_POINTS],
            visibility=sigmoid(raw[:N_POINTS, 3]),
            world_m=world,
            score=float(self._network.output(*_SCORE)[0, 0]),
            clarity=clarity(placed[:N_POINTS], peaks[:N_POINTS], rgb.shape[1], rgb.shape[0]),
        )
        return Sighting(body, Region.around(placed[N_POINTS], placed[N_POINTS + 1]))

    def silhouette(
        self, rgb: UInt8[np.ndarray, "height width 3"], region: Region
    ) -> Float[np.ndarray, "height width"]:
        """Return how surely each pixel of the picture belongs to the person in ``region``, 0 to 1."""
        if self._whole is None:
            self._whole = PictureNetwork(self._path, self._threads, 0.0, 1.0, cv2.BORDER_REPLICATE)
        whole = self._whole
        whole.run(rgb, region)
        mask = sigmoid(whole.output(1, whole.pixels, whole.pixels, 1)[0, :, :, 0])
        size = (rgb.shape[1], rgb.shape[0])
        return np.asarray(cv2.warpAffine(mask, region.matrix(whole.pixels), size))


def clarity(
    points_px: Float[np.ndarray, "33 2"], peaks: Float[np.ndarray, " 33"], width: int, height: int
) -> float:
    """Return ``Body.clarity``: the median peak of wigwag's 13 landmarks, of those in the picture.

    A landmark outside of the picture has no heat, though the person is there: legs below the lower edge
    must not make a person unlikely.
    """
    u, v = from_blazepose33(points_px).T
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    if inside.sum() < _MIN_INSIDE:
        return 0.0
    return float(np.median(from_blazepose33(peaks[:, None])[inside, 0]))


def sigmoid(values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """Map the network's raw outputs to shares between 0 and 1."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(values, -60.0, 60.0))))


def refine(
    points: Float[np.ndarray, "points 2"],
    heat: Float[np.ndarray, "rows columns points"],
    min_peak: float = 0.5,
) -> tuple[Float[np.ndarray, "points 2"], Float[np.ndarray, " points"]]:
    """Move each landmark to the centre of mass of its heat map in a 7 x 7 window around it.

    MediaPipe does the same; without it landmarks are off by 1.7 px on pictures of 640x480.

    Args:
        points: Landmarks as shares of the crop's side.
        heat: A raw heat map a landmark.
        min_peak: A window whose greatest heat (0 to 1) lies below leaves its landmark where it is.

    Returns:
        The refined landmarks, as shares of the crop's side, and the greatest heat in each one's window.
    """
    rows, columns, _ = heat.shape
    offsets = np.arange(-_REACH, _REACH + 1)
    cells = np.floor(points * (columns, rows)).astype(np.intp)
    inside = ((cells >= 0) & (cells < (columns, rows))).all(axis=1)
    u = cells[:, 0, None] + offsets
    v = cells[:, 1, None] + offsets
    valid = ((v >= 0) & (v < rows))[:, :, None] & ((u >= 0) & (u < columns))[:, None, :]
    window = heat[
        np.clip(v, 0, rows - 1)[:, :, None],
        np.clip(u, 0, columns - 1)[:, None, :],
        np.arange(len(points))[:, None, None],
    ]
    heats = sigmoid(window) * valid
    peak, total = heats.max(axis=(1, 2)), heats.sum(axis=(1, 2))
    moved = inside & (peak >= min_peak)
    total = np.where(moved, total, 1.0)
    centers = np.stack(
        [
            (heats.sum(axis=1) * u).sum(axis=1) / (total * columns),
            (heats.sum(axis=2) * v).sum(axis=1) / (total * rows),
        ],
        axis=1,
    )
    return np.where(moved[:, None], centers, points), np.where(inside, peak, 0.0)
