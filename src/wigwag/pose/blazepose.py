"""BlazePose through LiteRT: find a person, follow them from frame to frame, find them again.

Detector and landmark network are MediaPipe's (Bazarevsky et al., BlazePose, 2020); the search around
them is ours, because the full frame's 224 pixels lose people beyond some five metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import UInt8

from wigwag.errors import InputError
from wigwag.pose.body import Body
from wigwag.pose.detector import Detection, Detector
from wigwag.pose.landmarker import Landmarker, Sighting
from wigwag.pose.models import DETECTOR, LANDMARKERS, find_model
from wigwag.pose.region import Region

Picture = UInt8[np.ndarray, "height width 3"]


@dataclass(frozen=True, slots=True)
class BlazePoseConfig:
    """How bodies are looked for."""

    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network. 'lite' is wrong on crossed and forward-pointing arms, 'heavy' three times slower."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    threads: int = 1
    """Threads of each interpreter."""
    min_detection: float = 0.5
    """Detections below this score are not looked at."""
    min_presence: float = 0.5
    """A track ends when the network is less sure than this that somebody is there."""
    tile_share: float = 2 / 3
    """Side of a search crop as a share of the picture's shorter side: 320 px of 480."""


class BlazePose:
    """Finds and follows one person in RGB pictures.

    Args:
        config: Options; the defaults suit a drone's camera at 640x480.

    Raises:
        ModelError: If a network file is missing and cannot be fetched, or damaged.
    """

    def __init__(self, config: BlazePoseConfig | None = None) -> None:
        self.config = config = config or BlazePoseConfig()
        landmarks = find_model(LANDMARKERS[config.model], config.models_dir)
        detector = find_model(DETECTOR, config.models_dir)
        self._landmarker = Landmarker(landmarks, config.threads)
        self._detector = Detector(detector, config.threads, config.min_detection)
        self.reset()

    def reset(self) -> None:
        """Forget whom it follows."""
        self._region: Region | None = None
        self._turn = 0

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next frame of a stream, or ``None`` while nobody is found."""
        check_picture(rgb)
        if self._region is not None:
            seen = self._landmarker(rgb, self._region)
            if self._good(seen):
                self._region = seen.region
                return seen.body
        height, width = rgb.shape[:2]
        tiles = search_tiles(width, height, self.config.tile_share)
        regions = [Region.whole(width, height), tiles[self._turn % len(tiles)]]
        self._turn += 1
        found = self._find(rgb, regions)
        self._region = found.region if found else None
        if found is None:
            return None
        self._turn = 0
        return found.body

    def detect(self, rgb: Picture) -> Body | None:
        """Return the body in one picture that stands for itself, or ``None``."""
        check_picture(rgb)
        height, width = rgb.shape[:2]
        found = self._find(rgb, [Region.whole(width, height)])
        if found is None:
            found = self._find(rgb, search_tiles(width, height, self.config.tile_share))
        return found.body if found else None

    def _find(self, rgb: Picture, regions: list[Region]) -> Sighting | None:
        detections: list[Detection] = []
        for region in regions:
            detections += self._detector(rgb, region)
            if detections:
                break
        best: Sighting | None = None
        for detection in sorted(detections, key=lambda d: -d.score)[:2]:
            first = self._landmarker(rgb, detection.region)
            if not self._good(first):
                continue
            seen = self._landmarker(rgb, first.region)
            if self._good(seen) and (best is None or seen.body.score > best.body.score):
                best = seen
        return best

    def _good(self, seen: Sighting) -> bool:
        return seen.body.score >= self.config.min_presence and math.isfinite(seen.region.side)


def search_tiles(width: int, height: int, share: float) -> list[Region]:
    """Return overlapping square crops that cover the picture, the central one first.

    Example:
        >>> [(tile.u, tile.v) for tile in search_tiles(640, 480, 2 / 3)][:3]
        [(320.0, 240.0), (160.0, 160.0), (320.0, 160.0)]
    """
    side = round(min(width, height) * share)

    def centers(length: int) -> list[float]:
        count = max(1, math.ceil(2 * (length - side) / side) + (length > side))
        return (
            [float(c) for c in np.linspace(side / 2, length - side / 2, count)] if count > 1 else [length / 2]
        )

    middle = Region(width / 2, height / 2, float(side))
    grid = [Region(u, v, float(side)) for v in centers(height) for u in centers(width)]
    return [middle, *(tile for tile in grid if (tile.u, tile.v) != (middle.u, middle.v))]


def check_picture(rgb: object) -> None:
    """Raise ``InputError`` unless this is an 8-bit RGB picture."""
    if not isinstance(rgb, np.ndarray) or rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        got = f"{rgb.dtype} {rgb.shape}" if isinstance(rgb, np.ndarray) else type(rgb).__name__
        raise InputError(f"A picture must be uint8 with shape (height, width, 3), RGB, but got {got}.")
