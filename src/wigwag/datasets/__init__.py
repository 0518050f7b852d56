"""Recorded gestures on disk: UTD-MHAD and the user's own clips."""

from wigwag.datasets.loaded import Loaded

__all__ = ["Loaded"]
