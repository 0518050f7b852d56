"""What little light does to a picture: less signal, more gain, and the photons' own noise."""

# ruff: noqa: PLR0917 - compiled code takes flat arrays

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8
from numba import njit

from wigwag.errors import InputError
from wigwag.sim.shade import tone_curve


@dataclass(frozen=True, slots=True)
class ExposureConfig:
    """A small colour sensor at its longest exposure for 30 frames a second.

    Raises:
        InputError: If the light or a gain is out of range.
    """

    light: float = 1.0
    """Light on the scene as a share of what fills the sensor: 1 is daylight, 0.02 a street at dusk, 0.005 a
    street by its lamps."""
    full_well: float = 10_000.0
    """Electrons of a white pixel in full light. Their number varies by its root: shot noise."""
    read_noise: float = 3.0
    """Deviation of the electronics, electrons."""
    max_gain: float = 16.0
    """How far automatic gain goes to make up for too little light; 16 is 24 dB."""

    def __post_init__(self) -> None:
        """Check what would divide by zero."""
        if not 0 < self.light <= 1:
            raise InputError(f"ExposureConfig.light must be above 0 and at most 1, but got {self.light}.")
        if not (self.full_well > 0 and self.read_noise >= 0 and self.max_gain >= 1):
            raise InputError(
                "ExposureConfig needs full_well above 0, read_noise of 0 or more and max_gain of 1 or more, "
                f"but got {self.full_well}, {self.read_noise} and {self.max_gain}."
            )


class Exposure:
    """Takes a picture of full light again in the light there is.

    Args:
        config: The light and the sensor.
        seed: The same seed and the same pictures give the same noise.

    Example:
        >>> import numpy as np
        >>> grey = np.full((48, 64, 3), 128, np.uint8)
        >>> dark = Exposure(ExposureConfig(light=0.005)).apply(grey)
        >>> int(np.median(dark)) < 50, float(dark.std()) > 5
        (True, True)
    """

    def __init__(self, config: ExposureConfig | None = None, seed: int = 0) -> None:
        self.config = c = config or ExposureConfig()
        self._rng = rng = np.random.default_rng([seed, 0xDA2C])
        self._normal = rng.standard_normal(1 << 20, dtype=np.float32)
        self._tones = tone_curve()
        gain = min(c.max_gain, 1.0 / c.light)
        electrons = _linear() * c.light * c.full_well
        self._mean = (gain * electrons / c.full_well).astype(np.float32)
        self._spread = (gain * np.sqrt(electrons + c.read_noise**2) / c.full_well).astype(np.float32)

    def apply(self, rgb: UInt8[np.ndarray, "height width 3"]) -> UInt8[np.ndarray, "height width 3"]:
        """Return the picture as the sensor would give it; the input stays as it is."""
        out = np.empty_like(rgb)
        at = int(self._rng.integers(0, len(self._normal)))
        _expose(rgb.reshape(-1), out.reshape(-1), self._mean, self._spread, self._normal, at, self._tones)
        return out


def _linear() -> Float32[np.ndarray, " 256"]:
    """Return the linear light, 0 to 1, of each display value (sRGB)."""
    x = np.arange(256, dtype=np.float32) / 255
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).astype(np.float32)


@njit(cache=True, fastmath=True, nogil=True)  # type: ignore[untyped-decorator]
def _expose(
    rgb: np.ndarray, out: np.ndarray, mean: np.ndarray, spread: np.ndarray, normal: np.ndarray, at: int,
    tones: np.ndarray,
) -> None:  # fmt: skip
    mask = normal.shape[0] - 1
    top = np.float32(tones.shape[0] - 1)
    for i in range(rgb.shape[0]):
        value = mean[rgb[i]] + spread[rgb[i]] * normal[(at + i) & mask]
        out[i] = tones[int(top * min(np.float32(1.0), max(np.float32(0.0), value)))]
