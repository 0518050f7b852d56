"""Frames come in: ``Frame``, ``Intrinsics``, the ``Camera`` protocol, and a file for each kind of source."""

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.protocol import Camera, Counts

__all__ = ["Camera", "Counts", "Frame", "Intrinsics"]
