"""What is written down of every turn of the loop, and where in the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from wigwag.camera.frame import Intrinsics
from wigwag.fly.follow import Goal
from wigwag.fly.situation import Situation, Verdict
from wigwag.fly.values import Command, Setpoint, VehicleState
from wigwag.gesture import Gesture
from wigwag.skeleton import Pose

VERSION = 1
"""Of what is written, in the metadata ``wigwag``; readers refuse later ones."""

MODEL = "model.wigwag"
"""Name of the attached file with what was taught."""

TURN, POSE, STATE, SETPOINT, GESTURE = (
    "/wigwag/turn", "/operator/pose", "/vehicle/state", "/setpoint", "/gesture",
)  # fmt: skip
TRANSITION, NOTE = "/supervisor/transition", "/wigwag/note"
IMAGE, DEPTH, CALIBRATION, ANNOTATIONS = (
    "/camera/image", "/camera/depth", "/camera/calibration", "/camera/annotations",
)  # fmt: skip
SKELETON, CLOUD, TRANSFORMS, LOG = "/operator/skeleton", "/operator/points", "/tf", "/log"

Pictures = Literal["none", "jpeg", "png"]
"""What is kept of the colour pictures: nothing; JPEG at a bounded size; PNG, which loses nothing."""


@dataclass(frozen=True, slots=True)
class Look:
    """The frame of a turn, but for its pixels."""

    stamp_ns: int
    """When it was taken, monotonic nanoseconds."""
    intrinsics: Intrinsics
    used: bool
    """Whether the pose source took it; one that failed on it found nobody."""


@dataclass(frozen=True, slots=True)
class Turn:
    """One turn of the loop, but for what has a channel of its own."""

    now_ns: int
    """When the turn began; what was decided was decided at ``situation.now_ns``."""
    look: Look | None
    """``None``: the camera had nothing."""
    operator: int | None
    """Who commands, as the pose source counts; ``None``: nobody, or it does not tell."""
    asked: Command | None
    """What somebody at the console asked for."""
    command: Command | None
    """What the gesture asked for."""
    situation: Situation
    verdict: Verdict
    goal: Goal
    pose_s: float
    """Processor seconds for the pose."""
    rest_s: float
    """Processor seconds for what came after it."""
    limits: Mapping[str, float] = field(default_factory=dict)
    """Limits that were set anew at the console before it, by the names of ``wigwag.fly.tighten.DIALS``."""
    called: bool = False
    """Whether somebody at the console called for an operator before it."""


@dataclass(frozen=True, slots=True)
class Told:
    """What the vehicle was told."""

    wish: Setpoint
    """What the follow law would have liked."""
    sent: Setpoint | None
    """What was sent; ``None``: nothing."""
    changed: str
    """The guards that changed it."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """One turn, read back whole."""

    number: int
    """Counts from 0."""
    turn: Turn
    pose: Pose | None
    state: VehicleState
    told: Told
    gesture: Gesture | None


JSON_CHANNELS: dict[str, type] = {
    TURN: Turn, POSE: Pose, STATE: VehicleState, SETPOINT: Told, GESTURE: Gesture, TRANSITION: Verdict,
}  # fmt: skip
"""Channels that hold wigwag's own values, to the last bit."""

FOXGLOVE_CHANNELS: dict[str, str] = {
    IMAGE: "CompressedImage", DEPTH: "RawImage", CALIBRATION: "CameraCalibration",
    ANNOTATIONS: "ImageAnnotations", SKELETON: "SceneUpdate",
    CLOUD: "PointCloud",    TRANSFORMS: "FrameTransforms", LOG: "Log",
}  # fmt: skip
"""Channels for whoever looks, in Foxglove's schemas."""
