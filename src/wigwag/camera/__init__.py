"""Frames come in: ``Frame``, ``Intrinsics`` and the ``Camera`` protocol."""

from wigwag.camera.frame import Camera, Frame, Intrinsics

__all__ = ["Camera", "Frame", "Intrinsics"]
