"""wigwag: fly a drone with your body."""

from wigwag.camera import Frame, Intrinsics
from wigwag.errors import WigwagError
from wigwag.gesture import Gesture
from wigwag.skeleton import LANDMARKS, Clip, Landmark, Pose

__version__ = "0.1.0"

__all__ = ["LANDMARKS", "Clip", "Frame", "Gesture", "Intrinsics", "Landmark", "Pose", "WigwagError"]
