"""Only pictures of now: a camera behind its watchdog, for every loop that looks for a person."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from wigwag.camera.frame import Frame
from wigwag.camera.protocol import Camera
from wigwag.camera.watchdog import Health, Watchdog


@dataclass(frozen=True, slots=True)
class Glimpse:
    """One turn of a loop that looks through a camera."""

    frame: Frame | None
    """A new picture of now; ``None`` if none came, or what came was frozen, stale or black. Frozen depth is
    all holes: a person must not seem to stand still because their distance does."""
    health: Health
    """How it stands with the camera."""
    now_ns: int
    """The time on the clock of the stamps, nanoseconds."""


def fresh(camera: Camera, watchdog: Watchdog | None = None, timeout_s: float = 0.1) -> Iterator[Glimpse]:
    """Yield a glimpse for every frame, and one whenever none has come for ``timeout_s``.

    A loop over this goes on while a camera is lost: whoever flies must know that time passes.

    Args:
        camera: Where frames come from. Its end ends the iteration.
        watchdog: Judges each frame; one with default limits if ``None``.
        timeout_s: How long to wait for a frame.

    Raises:
        CameraError: If the camera was lost and did not come back.
        DataError: If a recording is damaged.

    Example:
        >>> from wigwag.cameras import open_camera
        >>> with open_camera("sim:?duration_s=0.1") as camera:
        ...     [glimpse.health.sight.value for glimpse in fresh(camera)]
        ['fresh', 'fresh', 'fresh']
    """
    watchdog = watchdog or Watchdog()
    while True:
        over = camera.ended  # asked first, so that a failure in between is raised by the next turn
        frame = camera.latest(timeout_s)
        now_ns = camera.now_ns
        if frame is not None:
            health = watchdog.see(frame, now_ns)
            if frame.depth_mm is not None and not health.depth:
                frame = replace(frame, depth_mm=np.zeros_like(frame.depth_mm))
            yield Glimpse(frame if health.usable else None, health, now_ns)
        elif over or camera.ended:
            return
        else:
            yield Glimpse(None, watchdog.check(now_ns), now_ns)


__all__ = ["Glimpse", "fresh"]
