"""The lens of a camera that does not tell about it: known from a file, or assumed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from wigwag.camera.calibration import HFOV_DEG, assumed_intrinsics, check_intrinsics, read_calibration
from wigwag.camera.frame import Intrinsics


@dataclass(frozen=True, slots=True)
class LensConfig:
    """What is known of the lens that pictures were taken through."""

    hfov_deg: float = HFOV_DEG
    """Horizontal field of view; used if there is no ``intrinsics`` file."""
    intrinsics: Path | None = None
    """A ``camera.json``, see docs/cameras.md."""


class Lens:
    """Gives each picture its intrinsics.

    Args:
        config: What is known of it.

    Raises:
        InputError: If the field of view is none.
        DataError: If the intrinsics file cannot be used.
    """

    def __init__(self, config: LensConfig | None = None) -> None:
        self._config = config or LensConfig()
        assumed_intrinsics(4, 3, self._config.hfov_deg)  # fails now rather than at the first frame
        path = self._config.intrinsics
        self._known = None if path is None else read_calibration(path).color

    def of(self, shape: tuple[int, ...]) -> Intrinsics:
        """Return the intrinsics of a picture of shape (height, width, ...).

        Raises:
            DataError: If the file's are for another size.
        """
        if self._known is not None:
            return check_intrinsics(self._known, shape, str(self._config.intrinsics))
        return assumed_intrinsics(shape[1], shape[0], self._config.hfov_deg)
