"""BlazePose through LiteRT: find a person, follow them from frame to frame, find them again.

Detector and landmark network are MediaPipe's (Bazarevsky et al., BlazePose, 2020). Two things around
them are ours. The search: the detector's 224 pixels lose people beyond some five metres when they must
hold the full frame, so crops are searched as well (``search.py``). The check: in clutter the detector
sees people in two pictures of three and the landmark network agrees with a score of 0.99. Its heat maps
do not, and least of all when it is shown the mirror image: a person is found in the same place again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.pose.body import Body, Picture
from wigwag.pose.detector import Detector
from wigwag.pose.landmarker import Landmarker, Sighting
from wigwag.pose.models import DETECTOR, LANDMARKERS, find_model
from wigwag.pose.region import Region
from wigwag.pose.search import AROUND, TILE_SHARES, Search, search_tiles

_PATIENCE = 16


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
    """A new body below this clarity, as it is or in the mirror, is none. On the half of the operator
    photos that it was checked on (every second folder by name, from the first), people of 64 to 200 px
    in clutter reach 0.69 at least in the lesser of the two, those of 50 px 0.65, where the detector sees
    them at all; 725 detections in 400 pictures of empty rooms reach 0.50 at most."""
    max_disagreement: float = 0.12
    """A new body whose landmarks lie farther than this from their mirror images turned back is none:
    median, in lengths of the torso. The same people stay within 0.06; nine of ten detections in empty
    rooms whose presence is believed do not stay within 0.12."""
    keep_clarity: float = 0.45
    """A body that is followed already is let go below this clarity: blur lowers it for some frames."""
    doubt_frames: int = 3
    """In every so many frames with a clarity between the two, the followed person is detected anew, so
    that a body that went wrong (left and right exchanged, an arm lost) comes right again."""
    max_doubt_frames: int = 45
    """After so many such frames in a row nobody is followed any more: a track that slid from a person who
    left to a chair ends."""
    max_tilt_deg: float = 60.0
    """Bodies tilted more than this in the picture are none: operators stand, cameras roll a little."""
    tile_shares: tuple[float, ...] = TILE_SHARES
    """Sides of the search crops as shares of the picture's shorter side: 320, 180 and 140 px of 480."""
    search_runs: int = 2
    """Crops that the detector looks at in a frame of a stream in which nobody is followed."""
    max_looks: int = 2
    """How many detections in a frame of a stream the landmark network looks at in vain, surest first;
    sixteen times as many in a picture that stands for itself."""
    memory_frames: int = 30
    """For so many frames a lost person is searched where they were last first."""


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
        self._search = Search(config.tile_shares, config.search_runs, config.memory_frames)
        self.reset()

    def reset(self) -> None:
        """Forget whom it follows."""
        self._region: Region | None = None
        self._frames_doubted = 0
        self._search.reset()

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next frame of a stream, or ``None`` while nobody is found.

        A frame costs one run of the landmark network while somebody is followed. Otherwise it costs
        ``search_runs`` of the detector, on crops that change from frame to frame, and mostly none of the
        landmark network: one a detection that turns out to be furniture, ``max_looks`` of these at most,
        and three for a person.
        """
        check_picture(rgb)
        if self._region is not None:
            if seen := self._followed(rgb, self._region):
                self._region = seen.region
                return seen.body
            self._search.found(self._region)
            self._region = None
        height, width = rgb.shape[:2]
        regions = self._search.plan(width, height)
        found = self.find(rgb, regions, every=True, looks=self.config.max_looks)
        if not found:
            return None
        self._region, self._frames_doubted = found[0].region, 0
        return found[0].body

    def _followed(self, rgb: Picture, region: Region) -> Sighting | None:
        """Return the followed person, or ``None`` if they are gone or were doubtful for too long."""
        seen = self.follow(rgb, region)
        if seen is not None:
            seen = self._second_look(rgb, seen)
        return None if self._frames_doubted > self.config.max_doubt_frames else seen

    def _second_look(self, rgb: Picture, seen: Sighting) -> Sighting:
        """Detect a doubtful body anew now and then, and return the clearer of both."""
        if seen.clarity >= self.config.min_clarity:
            self._frames_doubted = 0
            return seen
        self._frames_doubted += 1
        if self._frames_doubted % self.config.doubt_frames != 1 % self.config.doubt_frames:
            return seen
        again = self.find(rgb, [seen.region.wider(AROUND)])
        if not again or again[0].clarity <= seen.clarity:
            return seen
        self._frames_doubted = 0
        return again[0]

    def detect(self, rgb: Picture) -> Body | None:
        """Return the body in one picture that stands for itself, or ``None``.

        The full frame is searched first, then overlapping crops, the larger ones before the smaller.
        Whom ``track`` follows is not touched.
        """
        seen = self.sight(rgb)
        return None if seen is None else seen.body

    def sight(self, rgb: Picture) -> Sighting | None:
        """Return the body in one picture that stands for itself as ``detect`` does, and its region."""
        check_picture(rgb)
        height, width = rgb.shape[:2]
        rounds = [[Region.whole(width, height)]]
        rounds += [search_tiles(width, height, share) for share in self.config.tile_shares]
        for regions in rounds:
            if found := self.find(rgb, regions, every=True):
                return found[0]
        return None

    def find(
        self,
        rgb: Picture,
        regions: Sequence[Region],
        *,
        most: int = 1,
        every: bool = False,
        known: Sequence[Region] = (),
        looks: int | None = None,
    ) -> list[Sighting]:
        """Look at the surest detections in these regions and return those that are people.

        Args:
            rgb: The picture.
            regions: Where to look.
            most: Stop after so many people.
            every: Search all regions before looking closer (for a picture that stands for itself),
                instead of stopping at the first region with a person (for a stream).
            known: Where people are known to be already; detections there are not looked at.
            looks: Stop after so many detections that were nobody; by default after ``max_looks``, or
                sixteen times as many with ``every``.

        Returns:
            Each person once, surest detection first.
        """
        groups = [list(regions)] if every else [[region] for region in regions]
        if looks is None:
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
        """Return the person in a detected region, seen three times, or ``None`` if there is none.

        Furniture mostly costs one run of the landmark network.
        """
        first = self.follow(rgb, region)
        if first is None:
            return None
        # Seen again in the region of its own landmarks, a person becomes clearer.
        second = self._landmarker(rgb, first.region)
        if not self._holds(second, self.config.min_clarity):
            return None
        mirrored = self._landmarker(rgb, second.region, mirrored=True)
        if not self._holds(mirrored, self.config.min_clarity):
            return None
        apart = disagreement(second.body, mirrored.body)
        return second if apart <= self.config.max_disagreement else None

    def silhouette(self, rgb: Picture, region: Region) -> Float[np.ndarray, "height width"]:
        """Return how surely each pixel belongs to the person in ``region``, 0 to 1.

        One run of the landmark network.
        """
        return self._landmarker.silhouette(rgb, region)

    def _holds(self, seen: Sighting, clarity: float) -> bool:
        return (
            seen.score >= self.config.min_presence
            and seen.clarity >= clarity
            and seen.region.usable(self._max_tilt_rad)
        )


def disagreement(body: Body, other: Body) -> float:
    """Return how far apart the landmarks of two looks at one body are.

    Returns:
        Median distance in lengths of the torso; infinite for a body without a torso.
    """
    apart_px = float(np.median(np.linalg.norm(body.points_px - other.points_px, axis=1)))
    return apart_px / body.torso_px if body.torso_px > 0.0 else math.inf


def check_picture(rgb: object) -> None:
    """Raise ``InputError`` unless this is an 8-bit RGB picture."""
    if not isinstance(rgb, np.ndarray) or rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        got = f"{rgb.dtype} {rgb.shape}" if isinstance(rgb, np.ndarray) else type(rgb).__name__
        raise InputError(f"A picture must be uint8 with shape (height, width, 3), RGB, but got {got}.")
