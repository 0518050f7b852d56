"""A folder of pictures."""

from __future__ import annotations

from pathlib import Path

from wigwag.camera.frame import Frame
from wigwag.camera.lens import Lens, LensConfig
from wigwag.camera.pictures import picture_files, read_rgb
from wigwag.camera.protocol import Source
from wigwag.errors import InputError


class FolderSource(Source):
    """Frames without depth from the pictures of a folder, in the order of the numbers in their names.

    Args:
        path: The folder.
        rate_hz: Pictures a second, for their stamps.
        lens: What is known of the lens.

    Raises:
        InputError: If the rate or the field of view is none.
        DataError: If the intrinsics file cannot be used.
    """

    def __init__(self, path: str | Path, rate_hz: float = 30.0, lens: LensConfig | None = None) -> None:
        self.address = f"folder:{path}"
        if not 0 < rate_hz < 10_000:
            raise InputError(f"{self.address}: rate_hz must be above 0, but got {rate_hz}.")
        self._path, self._rate_hz, self._lens = Path(path), rate_hz, Lens(lens)
        self._files: list[Path] = []
        self._next = 0

    def open(self) -> None:
        """List the folder.

        Raises:
            DataError: If there is no such folder, or no picture in it.
        """
        self._files, self._next = picture_files(self._path), 0

    def read(self) -> Frame | None:
        """Return the next picture, ``None`` after the last.

        Raises:
            DataError: If the file is no picture; the message names it.
        """
        if self._next >= len(self._files):
            return None
        index, self._next = self._next, self._next + 1
        rgb = read_rgb(self._files[index])
        return Frame(rgb, None, self._lens.of(rgb.shape), round(index * 1e9 / self._rate_hz))

    def close(self) -> None:
        """Forget the list."""
        self._files = []
