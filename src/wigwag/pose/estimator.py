"""A frame becomes a 3-D pose: BlazePose in the colour, depth under its landmarks, one person kept."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose, BlazePoseConfig
from wigwag.pose.body import Body
from wigwag.pose.engine import PoseEngine
from wigwag.pose.lift import LiftConfig, Lifter
from wigwag.pose.sides import SideKeeper, SidesConfig
from wigwag.skeleton import Pose, from_blazepose33


@dataclass(frozen=True, slots=True)
class PoseConfig:
    """How a frame becomes a pose."""

    blazepose: BlazePoseConfig = field(default_factory=BlazePoseConfig)
    """How bodies are found in the colour picture."""
    lift: LiftConfig = field(default_factory=LiftConfig)
    """How landmarks get their depth."""
    sides: SidesConfig = field(default_factory=SidesConfig)
    """When a change of left and right is not believed."""
    head: Literal["ears", "nose"] = "ears"
    """What the first landmark is: the middle of the ears, where a Kinect puts its head joint, so that
    people recorded with a Kinect and people seen by a camera agree; or the nose, as in the paper."""
    trusted: tuple[float, float] = (0.3, 0.8)
    """From the lower visibility to the upper one, trust in what is measured grows from least to full."""
    least_trust: float = 0.08
    """How far a landmark that is not seen moves towards each new guess."""
    max_speed_m_s: float = 5.0
    """The middle of the hips moves no faster than this, seen from the camera (which turns as well)."""
    slack_m: float = 0.4
    """And besides jumps by no more than this: the noise of depth, a hip behind a hand."""
    forget_s: float = 1.0
    """After so long without the person, wherever somebody stands is believed."""
    patience_frames: int = 2
    """After so many jumped frames in a row the track is let go and the person is searched anew."""


class PoseEstimator:
    """Turns each frame of a stream into the pose of the one person it follows.

    Args:
        config: Options; the defaults suit an RGB-D camera on a drone, 2 to 8 m from the person.
        tracker: What finds the body; BlazePose on LiteRT by default. See ``wigwag.pose.engine.open_engine``.

    Raises:
        ModelError: If a network file is missing and cannot be fetched, or is damaged.
    """

    def __init__(self, config: PoseConfig | None = None, tracker: PoseEngine | None = None) -> None:
        self.config = config = config or PoseConfig()
        self._tracker = tracker or BlazePose(config.blazepose)
        self._lifter = Lifter(config.lift)
        self._sides = SideKeeper(config.sides)
        self.body: Body | None = None
        """What was seen in the latest frame's colour picture, for drawing; ``None``: nobody."""
        self.reset()

    def reset(self) -> None:
        """Forget whom it follows and when the last frame was."""
        self._tracker.reset()
        self._sides.reset()
        self.body = None
        self._hips_m: Float[np.ndarray, " 3"] | None = None
        self._hips_ns = 0
        self._relative_m: Float[np.ndarray, "13 3"] | None = None
        self._stamp_ns: int | None = None
        self._jumped = 0

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the person's pose, or ``None`` if nobody is there or their depth cannot be told.

        Raises:
            InputError: If the frame has no depth, or is not later than the one before.
        """
        if frame.depth_mm is None:
            raise InputError(
                "Frame.depth_mm is None, but a 3-D pose needs depth in millimetres aligned to the colour "
                "picture. Use a camera with depth and align it to colour."
            )
        if self._stamp_ns is not None and frame.stamp_ns <= self._stamp_ns:
            raise InputError(
                f"Frame.stamp_ns must grow from frame to frame, but {frame.stamp_ns} follows "
                f"{self._stamp_ns}. Call reset() before another stream."
            )
        self._stamp_ns = frame.stamp_ns
        body = self._tracker.track(frame.rgb)
        if body is None or not np.isfinite(body.points_px).all():
            self.body = None
            return None
        self.body = body = self._sides(body, frame.stamp_ns)
        head = self.config.head
        points = from_blazepose33(body.points_px, head)
        visibility = from_blazepose33(body.visibility[:, None], head)[:, 0]
        lifted = self._lifter(points, visibility, frame.depth_mm, frame.intrinsics)
        if lifted is None:
            return None
        pose = Pose(lifted.points_m, lifted.visibility, frame.stamp_ns)
        if not self._same_person(pose.hip_center, frame.stamp_ns):
            self._relative_m = None
            return None
        return self._steadied(pose)

    def _steadied(self, pose: Pose) -> Pose:
        """Let landmarks that are hardly seen follow slowly, relative to the hips; others stay as measured.

        Feet below the picture's edge are guessed anew in every frame, and jump by a decimetre.
        """
        low, high = self.config.trusted
        relative = pose.joints - pose.hip_center
        if self._relative_m is not None:
            trust = np.clip((pose.visibility - low) / (high - low), self.config.least_trust, 1.0)
            relative = self._relative_m + trust[:, None] * (relative - self._relative_m)
        self._relative_m = relative
        return replace(pose, joints=relative + pose.hip_center)

    def _same_person(self, hips_m: Float[np.ndarray, " 3"], stamp_ns: int) -> bool:
        """Say whether somebody here now can be who was there before, and remember where they are.

        A passer-by who crosses takes the network's track over. In the picture that looks smooth; in
        space the hips jump.
        """
        config = self.config
        if self._hips_m is not None:
            elapsed_s = (stamp_ns - self._hips_ns) * 1e-9
            far = float(np.linalg.norm(hips_m - self._hips_m))
            if elapsed_s < config.forget_s and far > config.slack_m + config.max_speed_m_s * elapsed_s:
                self._jumped += 1
                if self._jumped >= config.patience_frames:
                    self._tracker.reset()
                    self._sides.reset()
                    self._jumped = 0
                return False
        self._hips_m, self._hips_ns, self._jumped = hips_m, stamp_ns, 0
        return True
