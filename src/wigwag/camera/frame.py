"""One picture with its depth, and the pinhole it was seen through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8, UInt16

from wigwag.errors import InputError


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """A pinhole camera without distortion. Defaults: Intel RealSense D435 colour at 640x480."""

    fx: float = 615.0
    """Focal length in pixels, horizontal."""
    fy: float = 615.0
    """Focal length in pixels, vertical."""
    cx: float = 320.0
    """Principal point, pixels from the left edge."""
    cy: float = 240.0
    """Principal point, pixels from the upper edge."""
    width: int = 640
    """Pixels."""
    height: int = 480
    """Pixels."""

    def project(self, points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 2"]:
        """Project points (metres, camera optical frame, z > 0) to pixels (u, v)."""
        points = np.asarray(points)
        return np.stack(
            [
                self.fx * points[..., 0] / points[..., 2] + self.cx,
                self.fy * points[..., 1] / points[..., 2] + self.cy,
            ],
            axis=-1,
        )

    def deproject(
        self, pixels: Float[np.ndarray, "*batch 2"], z_m: Float[np.ndarray, "*batch"]
    ) -> Float[np.ndarray, "*batch 3"]:
        """Lift pixels (u, v) at depth ``z_m`` (metres) to points in the camera optical frame.

        Example:
            >>> import numpy as np
            >>> Intrinsics().deproject(np.array([320.0, 240.0]), np.array(2.0))
            array([0., 0., 2.])
        """
        pixels, z = np.asarray(pixels), np.asarray(z_m)
        x = (pixels[..., 0] - self.cx) / self.fx * z
        y = (pixels[..., 1] - self.cy) / self.fy * z
        return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)


@dataclass(frozen=True, slots=True)
class Frame:
    """A colour picture with depth aligned to it.

    Raises:
        InputError: If the picture is not 8-bit RGB, or the depth is not 16-bit of the same size.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    """Colour, RGB order."""
    depth_mm: UInt16[np.ndarray, "height width"] | None
    """Distance along the optical axis in millimetres; 0 is a hole. ``None``: a camera without depth."""
    intrinsics: Intrinsics
    stamp_ns: int
    """When the picture was taken, monotonic nanoseconds."""

    def __post_init__(self) -> None:
        """Check type and size once, where the frame enters."""
        rgb = self.rgb
        if not isinstance(rgb, np.ndarray) or rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
            got = f"{rgb.dtype} {rgb.shape}" if isinstance(rgb, np.ndarray) else type(rgb).__name__
            raise InputError(f"Frame.rgb must be uint8 with shape (height, width, 3), but got {got}.")
        depth = self.depth_mm
        if depth is not None and (depth.dtype != np.uint16 or depth.shape != rgb.shape[:2]):
            raise InputError(
                f"Frame.depth_mm must be uint16 with the picture's shape {rgb.shape[:2]}, "
                f"but got {depth.dtype} {depth.shape}. Align depth to colour first."
            )
