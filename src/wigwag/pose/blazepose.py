"""BlazePose through LiteRT: find a person, follow them from frame to frame, find them again.

Detector and landmark network are MediaPipe's (Bazarevsky et al., BlazePose, 2020). Two things around
them are ours. The search: the detector's 224 pixels lose people beyond some five metres when they must
hold the full frame, so crops are searched as well. The check: in clutter the detector sees people in
every third picture and the landmark network agrees with a score of 0.99; its heat maps do not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import UInt8

from wigwag.errors import InputError
from wigwag.pose.body import Body
from wigwag.pose.detector import Detector
from wigwag.pose.landmarker import Landmarker, Sighting
from wigwag.pose.models import DETECTOR, LANDMARKERS, find_model
from wigwag.pose.region import Region

_CROP_SCALE = 1.5
"""Where a body was, the detector looks at an upright square that is wider than its region by this."""
_PATIENCE = 4
_MIN_CROP = 48.0
"""Pixels; a person in a smaller crop is too small for the landmark network."""

Picture = UInt8[np.ndarray, "height width 3"]


@dataclass(frozen=True, slots=True)
class BlazePoseConfig:
    """How bodies are looked for."""

    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network. 'lite' gets crossed and forward-pointing arms wrong, 'heavy' takes three times
    as long."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    threads: int = 1
    """Threads of each interpreter."""
    min_detection: float = 0.5
    """Detections below this score are not looked at."""
    min_presence: float = 0.5
    """A body below this score is none."""
    min_clarity: float = 0.6
    """A new body below this clarity is none. Chosen on one half of the operator photos, where whole
    people reach 0.76 and upper bodies 0.72 in 98 of 100 cases, and the empty rooms 0.57 at most (583
    false detections that pass ``min_presence``, both halves together)."""
    keep_clarity: float = 0.45
    """A body that is followed already is let go below this clarity: blur lowers it for some frames."""
    doubt_frames: int = 3
    """In every so many frames with a clarity between the two, the followed person is detected anew, so
    that a body that went wrong (left and right exchanged, an arm lost) comes right again."""
    max_tilt_deg: float = 60.0
    """Bodies tilted more than this in the picture are none: operators stand, cameras roll a little."""
    tile_shares: tuple[float, ...] = (2 / 3, 1 / 2)
    """Sides of the search crops as shares of the picture's shorter side: 320 and 240 px of 480."""
    max_looks: int = 2
    """How many detections in a frame of a stream the landmark network looks at, surest first; four
    times as many in a picture that stands for itself."""
    memory_frames: int = 30
    """For so many frames a lost person is searched where they were last as well."""


class BlazePose:
    """Finds and follows one person in RGB pictures.

    Args:
        config: Options; the defaults suit a drone's camera at 640x480.

    Raises:
        ModelError: If a network file is missing and cannot be fetched, or is damaged.
    """

    def __init__(self, config: BlazePoseConfig | None = None) -> None:
        self.config = config = config or BlazePoseConfig()
        landmarks = find_model(LANDMARKERS[config.model], config.models_dir)
        detector = find_model(DETECTOR, config.models_dir)
        self._landmarker = Landmarker(landmarks, config.threads)
        self._detector = Detector(detector, config.threads, config.min_detection)
        self._max_tilt_rad = math.radians(config.max_tilt_deg)
        self.reset()

    def reset(self) -> None:
        """Forget whom it follows."""
        self._region: Region | None = None
        self._last: Region | None = None
        self._frames_lost = 0
        self._frames_doubted = 0

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next frame of a stream, or ``None`` while nobody is found.

        A frame costs one run of the landmark network while somebody is followed; otherwise two runs of
        the detector at most, on the full frame and on one crop that changes from frame to frame, and
        ``max_looks + 1`` runs of the landmark network at most, if somebody seems to be there.
        """
        check_picture(rgb)
        if self._region is not None:
            if seen := self.follow(rgb, self._region):
                seen = self._second_look(rgb, seen)
                self._last = self._region = seen.region
                return seen.body
            self._region, self._frames_lost = None, 0
        found = self.find(rgb, self._next_regions(rgb))
        self._frames_lost += 1
        if not found:
            return None
        self._last = self._region = found[0].region
        self._frames_lost = 0
        return found[0].body

    def _second_look(self, rgb: Picture, seen: Sighting) -> Sighting:
        """Detect a doubtful body anew now and then, and return the clearer of both."""
        if seen.clarity >= self.config.min_clarity:
            self._frames_doubted = 0
            return seen
        self._frames_doubted += 1
        if self._frames_doubted % self.config.doubt_frames != 1 % self.config.doubt_frames:
            return seen
        again = self.find(rgb, [seen.region.wider(_CROP_SCALE)])
        return again[0] if again and again[0].clarity > seen.clarity else seen

    def detect(self, rgb: Picture) -> Body | None:
        """Return the body in one picture that stands for itself, or ``None``.

        The full frame is searched first, then overlapping crops, the larger ones before the smaller.
        Whom ``track`` follows is not touched.
        """
        check_picture(rgb)
        height, width = rgb.shape[:2]
        rounds = [[Region.whole(width, height)]]
        rounds += [search_tiles(width, height, share) for share in self.config.tile_shares]
        for regions in rounds:
            if found := self.find(rgb, regions, every=True):
                return found[0].body
        return None

    def _next_regions(self, rgb: Picture) -> list[Region]:
        """Return the full frame and one crop: where the person was last, or the next of all crops."""
        height, width = rgb.shape[:2]
        turn = self._frames_lost
        if self._last is not None and turn < self.config.memory_frames:
            if turn % 2 == 0:
                return [Region.whole(width, height), self._last.wider(_CROP_SCALE)]
            turn //= 2
        tiles = [tile for share in self.config.tile_shares for tile in search_tiles(width, height, share)]
        return [Region.whole(width, height), tiles[turn % len(tiles)]]

    def find(
        self,
        rgb: Picture,
        regions: Sequence[Region],
        *,
        most: int = 1,
        every: bool = False,
        known: Sequence[Region] = (),
    ) -> list[Sighting]:
        """Look at the surest detections in these regions and return those that are people.

        Args:
            rgb: The picture.
            regions: Where to look.
            most: Stop after so many people.
            every: Search all regions before looking closer (for a picture that stands for itself),
                instead of stopping at the first region with a person (for a stream).
            known: Where people are known to be already; detections there are not looked at.

        Returns:
            Each person once, surest detection first.
        """
        groups = [list(regions)] if every else [[region] for region in regions]
        looks = self.config.max_looks * (_PATIENCE if every else 1)
        people: list[Sighting] = []
        seen_already = list(known)
        rejected = 0
        for group in groups:
            detections = [found for region in group for found in self._detector(rgb, region)]
            for detection in sorted(detections, key=lambda found: -found.score):
                place = detection.region
                if not place.usable(self._max_tilt_rad) or any(place.resembles(r) for r in seen_already):
                    continue
                if rejected == looks:
                    return people
                seen_already.append(place)
                seen = self.look(rgb, place)
                if seen is None:
                    rejected += 1
                elif not any(seen.region.resembles(r) for r in [*known, *(p.region for p in people)]):
                    people.append(seen)
                    seen_already.append(seen.region)
                if len(people) == most:
                    return people
        return people

    def follow(self, rgb: Picture, region: Region) -> Sighting | None:
        """Return the person in the region that the frame before told of, or ``None`` if there is none.

        One run of the landmark network. Whom ``track`` follows is not touched.
        """
        seen = self._landmarker(rgb, region)
        return seen if self._holds(seen, self.config.keep_clarity) else None

    def look(self, rgb: Picture, region: Region) -> Sighting | None:
        """Return the person in a detected region, seen twice, or ``None`` if there is none."""
        first = self.follow(rgb, region)
        if first is None:
            return None
        # Seen again in the region of its own landmarks, a person becomes clearer.
        second = self._landmarker(rgb, first.region)
        return second if self._holds(second, self.config.min_clarity) else None

    def _holds(self, seen: Sighting, clarity: float) -> bool:
        return (
            seen.score >= self.config.min_presence
            and seen.clarity >= clarity
            and seen.region.usable(self._max_tilt_rad)
        )


def search_tiles(width: int, height: int, share: float) -> list[Region]:
    """Return square crops that cover the picture and overlap by half, the central one first.

    Args:
        width: Of the picture, pixels.
        height: Of the picture, pixels.
        share: Side of a crop as a share of the picture's shorter side.

    Example:
        >>> [(tile.u, tile.v) for tile in search_tiles(640, 480, 2 / 3)][:3]
        [(320.0, 240.0), (160.0, 160.0), (320.0, 160.0)]
    """
    side = float(round(min(width, height) * share))
    middle = Region(width / 2, height / 2, max(side, _MIN_CROP))
    if side < _MIN_CROP:
        return [middle]

    def centers(length: int) -> list[float]:
        count = 1 + math.ceil(2 * (length - side) / side)
        return [float(center) for center in np.linspace(side / 2, length - side / 2, count)]

    grid = [Region(u, v, side) for v in centers(height) for u in centers(width)]
    return [middle, *(tile for tile in grid if (tile.u, tile.v) != (middle.u, middle.v))]


def check_picture(rgb: object) -> None:
    """Raise ``InputError`` unless this is an 8-bit RGB picture."""
    if not isinstance(rgb, np.ndarray) or rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        got = f"{rgb.dtype} {rgb.shape}" if isinstance(rgb, np.ndarray) else type(rgb).__name__
        raise InputError(f"A picture must be uint8 with shape (height, width, 3), RGB, but got {got}.")
