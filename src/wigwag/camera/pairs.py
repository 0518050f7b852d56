"""Pairs of pictures, colour and depth, as tools for the Azure Kinect and others write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jaxtyping import UInt16

from wigwag.camera.align import DepthAligner
from wigwag.camera.calibration import Calibration, check_intrinsics, read_calibration
from wigwag.camera.frame import Frame
from wigwag.camera.pictures import picture_files, read_depth, read_rgb
from wigwag.camera.protocol import Source
from wigwag.errors import DataError, InputError

_COLOR, _DEPTH = ("color", "rgb", "colour"), ("depth",)
_CALIBRATION = ("camera.json", "intrinsic.json")


class PairsSource(Source):
    """Frames with depth from ``DIR/color/NAME.png|jpg`` and ``DIR/depth/NAME.png``.

    ``DIR/camera.json`` (or Open3D's ``intrinsic.json``) has the intrinsics. If it has some for depth too,
    depth is aligned to colour here. A colour picture without its depth becomes a frame without depth.

    Args:
        path: The folder.
        rate_hz: Pictures a second, for their stamps; ``None``: what the JSON says, or 30.

    Raises:
        InputError: If the rate is none.
    """

    def __init__(self, path: str | Path, rate_hz: float | None = None) -> None:
        self.address = f"pairs:{path}"
        if rate_hz is not None and not 0 < rate_hz < 10_000:
            raise InputError(f"{self.address}: rate_hz must be above 0, but got {rate_hz}.")
        self._path, self._asked_hz = Path(path), rate_hz
        self._color: list[Path] = []
        self._depth: dict[str, Path] = {}
        self._next = 0

    def open(self) -> None:
        """Read the calibration and list both folders.

        Raises:
            DataError: If a folder or the calibration is missing or wrong, or nothing fits together.
        """
        self._name = self._part(_CALIBRATION)
        self._calibration = read_calibration(self._name)
        self._rate_hz = self._asked_hz or self._calibration.rate_hz or 30.0
        self._aligner = _aligner(self._calibration)
        self._color, self._next = picture_files(self._part(_COLOR)), 0
        self._depth = {f.stem: f for f in picture_files(self._part(_DEPTH))}
        if not any(f.stem in self._depth for f in self._color):
            raise DataError(
                f"{self._path}: no picture of colour and no picture of depth have the same name; the first "
                f"are {self._color[0].name} and {next(iter(self._depth.values())).name}."
            )

    def read(self) -> Frame | None:
        """Return the next pair, ``None`` after the last.

        Raises:
            DataError: If a file is damaged, of the wrong kind, or not of the calibration's size.
        """
        if self._next >= len(self._color):
            return None
        index, self._next = self._next, self._next + 1
        rgb = read_rgb(self._color[index])
        intrinsics = check_intrinsics(self._calibration.color, rgb.shape, str(self._name))
        depth = self._depth.get(self._color[index].stem)
        aligned = None if depth is None else self._aligned(depth, rgb.shape)
        return Frame(rgb, aligned, intrinsics, round(index * 1e9 / self._rate_hz))

    def close(self) -> None:
        """Forget the lists."""
        self._color, self._depth = [], {}

    def _aligned(self, path: Path, shape: tuple[int, ...]) -> UInt16[np.ndarray, "height width"]:
        depth = read_depth(path, self._calibration.depth_unit_m)
        if self._aligner is not None:
            try:
                return self._aligner(depth)
            except InputError as error:
                raise DataError(f"{path}: {error}") from error
        if depth.shape != shape[:2]:
            raise DataError(
                f"{path}: depth is {depth.shape[1]} x {depth.shape[0]}, colour {shape[1]} x {shape[0]}. "
                f'Give "depth" and "depth_to_color" in {self._name.name}, and it is aligned here; '
                "see docs/cameras.md."
            )
        return depth

    def _part(self, names: tuple[str, ...]) -> Path:
        for name in names:
            if (self._path / name).exists():
                return self._path / name
        raise DataError(
            f"{self._path}: has no {' or '.join(names)} in it. Expected color/, depth/ and camera.json."
        )


def _aligner(calibration: Calibration) -> DepthAligner | None:
    if calibration.depth is None or calibration.depth_to_color is None:
        return None
    return DepthAligner(calibration.depth, calibration.color, calibration.depth_to_color)
