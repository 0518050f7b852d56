"""Recorded gestures on disk: UTD-MHAD, MSR-Action3D, PRECOG and the user's own clips."""

from wigwag.datasets.folder import load_clip, load_folder, save_clip
from wigwag.datasets.loaded import Loaded

__all__ = ["Loaded", "load_clip", "load_folder", "save_clip"]
