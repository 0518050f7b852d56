"""Pictures to try pose engines on: photos of people, rendered motion, and the same without anybody."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame
from wigwag.camera.pictures import PICTURES, read_rgb
from wigwag.camera.protocol import Source
from wigwag.errors import DataError
from wigwag.pose.body import Body
from wigwag.pose.engine import Picture, PoseEngine
from wigwag.sim.camera import SimulatedCameraConfig, SimulatedSource
from wigwag.sim.world import World, WorldConfig

MARGIN_PX = 25
"""So much beside the outermost landmark still belongs to the person."""
LEAST_PX = 150
"""Narrower rests of a photo show too little of a room."""
_FAR_BEHIND_M = -200.0


def read_photos(folder: Path) -> list[Picture]:
    """Read every picture in a folder and its folders, in order of their names.

    Raises:
        DataError: If there is none, or one is damaged.
    """
    paths = sorted(p for p in folder.rglob("*") if p.suffix.lower() in PICTURES)
    if not paths:
        raise DataError(f"{folder}: there is no picture in it. Name a folder with photos of people.")
    return [read_rgb(path) for path in paths]


def without_person(photos: Sequence[Picture], finder: PoseEngine) -> list[Picture]:
    """Return rooms: what lies beside the person in each photo, mirrored until the picture is full.

    Photos in which the person is not found, or fills the width, are left out.
    """
    rooms = []
    for photo in photos:
        body = finder.detect(photo)
        if body is not None and (room := _beside(photo, body)) is not None:
            rooms.append(room)
    return rooms


def _beside(photo: Picture, body: Body) -> Picture | None:
    width = photo.shape[1]
    left = int(np.clip(body.points_px[:, 0].min() - MARGIN_PX, 0, width))
    right = int(np.clip(body.points_px[:, 0].max() + MARGIN_PX, 0, width))
    part = photo[:, :left] if left >= width - right else photo[:, right:]
    if part.shape[1] < LEAST_PX:
        return None
    missing = width - part.shape[1]
    return np.asarray(cv2.copyMakeBorder(part, 0, 0, 0, missing, cv2.BORDER_REFLECT))


def moving(seconds: float, seed: int, distance_m: float = 4.0) -> Iterator[Frame]:
    """Render an operator who shows gestures, 30 frames a second, through a real sensor's noise."""
    source = SimulatedSource(SimulatedCameraConfig(seed=seed, distance_m=distance_m, duration_s=seconds))
    source.open()
    while (frame := source.read()) is not None:
        yield frame


class _Absent:
    """An operator who is behind the camera."""

    def step(
        self, t_s: float, dt_s: float, drone_position_m: Float[np.ndarray, " 3"]
    ) -> Float[np.ndarray, "20 3"]:
        """Stay away."""
        return np.linspace([_FAR_BEHIND_M, 0.0, 1.7], [_FAR_BEHIND_M, 0.0, 0.0], 20)


def deserted(seconds: float, seed: int) -> Iterator[Frame]:
    """Render the same surroundings with nobody in them, the drone hovering."""
    world = World(WorldConfig(delay_frames=0), seed, _Absent())
    for _ in range(round(seconds * world.config.rate_hz)):
        yield world.step()


class Endless(Source):
    """A source that shows the same frames forth and back without end, so that nothing jumps.

    Args:
        frames: What is shown, two or more.
        rate_hz: Stamps are so far apart.
    """

    def __init__(self, frames: Sequence[Frame], rate_hz: float) -> None:
        self.address = "endless:"
        self._frames, self._rate_hz = frames, rate_hz
        self._count = 0

    def open(self) -> None:
        """Begin with the first frame."""
        self._count = 0

    def read(self) -> Frame:
        """Return the next frame, stamped by the rate."""
        around = 2 * len(self._frames) - 2
        place = self._count % around
        frame = self._frames[min(place, around - place)]
        self._count += 1
        return replace(frame, stamp_ns=round(self._count * 1e9 / self._rate_hz))

    def close(self) -> None:
        """There is nothing to let go of."""


__all__ = ["Endless", "deserted", "moving", "read_photos", "without_person"]
