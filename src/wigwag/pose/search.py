"""Where to look for a person next: crops of a picture, and whose turn it is in a stream.

The detector sees people who are 0.33 to 0.9 of its crop tall. The full frame, crops of two thirds and
crops of three eighths of the shorter side together hold everybody from 60 pixels of 480 upwards; seven
twenty-fourths reach down to 50. Each crop a frame would cost a second, so in a stream they take turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from wigwag.pose.region import Region

TILE_SHARES: tuple[float, ...] = (2 / 3, 3 / 8, 7 / 24)
"""Sides of the crops as shares of the picture's shorter side: 320, 180 and 140 px of 480."""
_RATES = (6.0, 1.0, 0.5)
"""How fast a crop's claim to be looked at grows: the full frame's, and a crop's whose side is more or less
than a third of the shorter side. People nearer than 10 m come first."""
_SMALL = 1 / 3
_MIN_CROP = 48.0
"""Pixels; a person in a smaller crop is too small for the landmark network."""
AROUND = 1.5
"""Where a body was, the detector looks at an upright square that is wider than its region by this."""
_YIELD = 0.3
"""How much of a crop's claim goes when one of the same side that covers it wholly has its turn. More
spreads the first round better, but lets some crops starve: with 0.5 one waits for 160 frames."""
_NEAR_GAIN = 8.0
"""How much faster the claim of a crop grows that holds the place where somebody was seen last."""
_SPREAD_PER_FRAME = 0.15
"""So many sides of their region may a lost person have moved in a frame."""


class Search:
    """Says, frame by frame, which crops of the picture to look at; it looks at nothing itself.

    Every crop has a claim that grows with time: fastest the full frame's, faster near the place where
    somebody was seen last, slowest the smallest crops'. The greatest claims get their turn. A crop that
    had it starts from nothing, and what overlaps it loses some of its claim too, so that the picture is
    covered first, and then again in between.

    Args:
        shares: Sides of the crops as shares of the picture's shorter side, greatest first.
        runs: Crops a frame, at most.
        memory_frames: For so many frames a lost person is looked for where they were last: in every
            frame of the first third of them, in every second one after that. Within that time the crops
            around there come first, and farther ones later.

    Example:
        >>> search = Search(runs=2)
        >>> [(region.u, region.side) for region in search.plan(640, 480)]
        [(320.0, 640.0), (320.0, 320.0)]
    """

    def __init__(self, shares: Sequence[float] = TILE_SHARES, runs: int = 2, memory_frames: int = 30) -> None:
        self._shares = tuple(shares)
        self._runs = runs
        self._memory_frames = memory_frames
        self._size = (0, 0)
        self.reset()

    def reset(self) -> None:
        """Forget where anybody was, and begin anew."""
        self._last: Region | None = None
        self._frames = 0
        self._claims: Float[np.ndarray, " crops"] | None = None

    def found(self, region: Region) -> None:
        """Hear that somebody is in ``region``: the next search begins there."""
        self._last = region
        self._frames = 0
        self._claims = None

    def plan(self, width: int, height: int) -> list[Region]:
        """Return the regions of the next frame to look at, each once; nobody was in those before.

        Args:
            width: Of the picture, pixels.
            height: Of the picture, pixels.
        """
        if self._size != (width, height):
            self._lay_out(width, height)
        rates = self._rates * self._nearness()
        # Central crops come a trifle earlier than others of their kind, at the start only.
        claims = self._start * rates if self._claims is None else self._claims + rates
        chosen: list[Region] = []
        if self._last is not None and self._returns():
            chosen.append(self._last.wider(AROUND))
        for _ in range(min(self._runs - len(chosen), len(self._crops))):
            turn = int(np.argmax(claims))
            chosen.append(self._crops[turn])
            claims = claims * (1.0 - self._overlaps[turn])
        self._claims = claims
        self._frames += 1
        return chosen

    def _returns(self) -> bool:
        """Say whether this frame looks where somebody was last: at first always, later now and then."""
        often = 3 * self._frames < self._memory_frames
        return often or (self._frames < self._memory_frames and self._frames % 2 == 0)

    def _lay_out(self, width: int, height: int) -> None:
        """Cut a picture of this size into crops, and see which of the same side overlap."""
        levels = [[Region.whole(width, height)]]
        for share in self._shares:
            known = {crop for level in levels for crop in level}  # in tiny pictures levels are alike
            levels.append([tile for tile in search_tiles(width, height, share) if tile not in known])
        self._size = (width, height)
        self._crops = [crop for level in levels for crop in level]
        big, middle, small = _RATES
        kinds = [big, *(small if share < _SMALL else middle for share in self._shares)]
        self._rates = np.repeat(kinds, [len(level) for level in levels])
        u, v, side = np.array([(crop.u, crop.v, crop.side) for crop in self._crops]).T
        self._places = np.stack([u, v, side], axis=1)
        shared = np.clip(side - np.abs(u[:, None] - u), 0.0, None) / side
        shared = shared * np.clip(side - np.abs(v[:, None] - v), 0.0, None) / side
        self._overlaps = np.where(side[:, None] == side, _YIELD * shared, 0.0)
        np.fill_diagonal(self._overlaps, 1.0)
        away = np.hypot(u - width / 2, v - height / 2) / math.hypot(width, height)
        self._start = 1.0 + 0.1 * (1.0 - away)
        self._claims = None

    def _nearness(self) -> Float[np.ndarray, " crops"]:
        """Return by how much each crop's claim grows faster because somebody was seen near it."""
        if self._last is None or self._frames >= self._memory_frames:
            return np.ones(len(self._crops))
        u, v, side = self._places.T
        last = self._last
        reach = last.side * (1.0 + _SPREAD_PER_FRAME * self._frames)
        outside = np.maximum(np.abs(u - last.u), np.abs(v - last.v)) / reach
        # A body's region is a third wider than the body is tall: this is 0.33 to 0.9 of the crop.
        fits = (last.side > 0.44 * side) & (last.side < 1.2 * side)
        return np.asarray(1.0 + (_NEAR_GAIN - 1.0) * fits * np.exp(-(outside**2)))


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


__all__ = ["AROUND", "TILE_SHARES", "Search", "search_tiles"]
