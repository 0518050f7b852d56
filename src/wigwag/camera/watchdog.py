"""Is what the camera shows the world of now? A frozen picture looks like a person who stands still."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from wigwag.camera.frame import Frame
from wigwag.errors import InputError


class Sight(Enum):
    """What a picture is good for."""

    FRESH = "fresh"
    """A new picture of now."""
    REPEATED = "repeated"
    """Nothing new, though not for long: as if no frame had come. Do not look for a pose in it."""
    STALE = "stale"
    """Nothing new for too long: the camera does not show the world of now."""
    DARK = "dark"
    """New, but black: a lid, a covered lens, night."""


@dataclass(frozen=True, slots=True)
class Health:
    """The state of a camera at one moment."""

    sight: Sight
    reason: str
    """In words, for the operator; empty if all is well."""
    depth: bool
    """Whether the newest frame measured enough depth, and depth is not frozen."""
    age_s: float
    """Since the stamp of the newest fresh frame; infinite before the first."""

    @property
    def usable(self) -> bool:
        """Whether a pose may be looked for in the frame that was just handed in."""
        return self.sight is Sight.FRESH


@dataclass(frozen=True, slots=True)
class WatchdogConfig:
    """What counts as stale.

    Raises:
        InputError: If a limit is not positive.
    """

    stale_s: float = 0.3
    """Without a new picture for so long, the camera is stale: nine frames at 30 Hz."""
    late_s: float = 0.5
    """A picture that is older than this when it comes is stale, new or not."""
    dark_level: int = 6
    """A picture without anything brighter than this, of 255, is black."""
    least_depth: float = 0.01
    """With a smaller share of measured pixels there is no depth to speak of."""

    def __post_init__(self) -> None:
        """Check that no limit is always met."""
        if not (self.stale_s > 0 and self.late_s > 0):
            raise InputError(
                f"WatchdogConfig needs stale_s and late_s above 0, but got {self.stale_s} and {self.late_s}."
            )


class Watchdog:
    """Tells fresh from stale: the same bytes again, stamps that do not move, gaps, pictures that come late.

    A sensor has noise, so no two pictures of it have the same bytes; a picture that comes again was not
    taken again. Time is handed in, on the clock of the stamps.

    Args:
        config: What counts as stale.

    Example:
        >>> frame = Frame(np.full((4, 4, 3), 90, np.uint8), None, None, stamp_ns=0)
        >>> watchdog = Watchdog()
        >>> watchdog.see(frame, now_ns=10_000_000).sight.value
        'fresh'
        >>> watchdog.check(now_ns=400_000_000).reason
        'no picture for 0.4 s'
    """

    def __init__(self, config: WatchdogConfig | None = None) -> None:
        self.config = config or WatchdogConfig()
        self._fresh: Frame | None = None
        """The newest frame that was new in bytes and stamp."""
        self._fresh_at_ns = 0
        """When it came."""
        self._depth = False
        self._depth_at_ns = 0
        """When depth was last another one than before."""
        self._why = "no picture"
        """What the frames after it were, if any came."""

    def see(self, frame: Frame, now_ns: int) -> Health:
        """Take the frame that has just come.

        Args:
            frame: Kept until the next; its arrays must not be written to.
            now_ns: The time, on the clock of the frame's stamp.
        """
        before = self._fresh
        if before is not None and frame.stamp_ns <= before.stamp_ns:
            return self._repeated("the stamps do not move", now_ns)
        if before is not None and _same(frame.rgb, before.rgb):
            return self._repeated("the same picture again and again", now_ns)
        self._depth = self._measures(frame, now_ns)
        self._fresh, self._fresh_at_ns, self._why = frame, now_ns, "no picture"
        late_s = (now_ns - frame.stamp_ns) * 1e-9
        if late_s > self.config.late_s:
            return self._health(Sight.STALE, f"the picture is {late_s:.1f} s old", now_ns)
        if int(frame.rgb.max(initial=0)) <= self.config.dark_level:
            return self._health(Sight.DARK, "the picture is black", now_ns)
        return self._health(Sight.FRESH, "", now_ns)

    def check(self, now_ns: int) -> Health:
        """Say how it stands when no frame has come: ask at least as often as frames ought to come.

        Args:
            now_ns: The time, on the clock of the stamps.
        """
        return self._repeated(self._why, now_ns)

    def _measures(self, frame: Frame, now_ns: int) -> bool:
        """Say whether there is depth of now. Colour may come faster, so the same depth twice is no fault."""
        depth, before = frame.depth_mm, None if self._fresh is None else self._fresh.depth_mm
        if depth is None or np.count_nonzero(depth) <= self.config.least_depth * depth.size:
            return False
        if before is None or not _same(depth, before):
            self._depth_at_ns = now_ns
        return now_ns - self._depth_at_ns < self.config.stale_s * 1e9

    def _repeated(self, why: str, now_ns: int) -> Health:
        self._why = why
        if self._fresh is None:
            return self._health(Sight.STALE, "no picture yet", now_ns)
        without_s = (now_ns - self._fresh_at_ns) * 1e-9
        if without_s >= self.config.stale_s:
            return self._health(Sight.STALE, f"{why} for {without_s:.1f} s", now_ns)
        return self._health(Sight.REPEATED, why, now_ns)

    def _health(self, sight: Sight, reason: str, now_ns: int) -> Health:
        age_s = float("inf") if self._fresh is None else (now_ns - self._fresh.stamp_ns) * 1e-9
        return Health(sight, reason, self._depth, age_s)


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    """Compare bytes; pictures that differ nearly always do so in their first few rows."""
    if a is b:
        return True
    if a.shape != b.shape:
        return False
    return bool(np.array_equal(a[::32], b[::32]) and np.array_equal(a, b))


__all__ = ["Health", "Sight", "Watchdog", "WatchdogConfig"]
