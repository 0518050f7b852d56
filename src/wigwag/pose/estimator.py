"""A frame becomes a 3-D pose: BlazePose in the colour, depth under its landmarks, one person kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float, UInt8

from wigwag.camera.frame import Frame
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose, BlazePoseConfig
from wigwag.pose.body import Body
from wigwag.pose.filter import FilterConfig, PoseFilter
from wigwag.pose.lift import LiftConfig
from wigwag.pose.monocular import MonocularConfig
from wigwag.pose.sides import SideKeeper, SidesConfig
from wigwag.pose.space import InSpace
from wigwag.skeleton import Pose


@dataclass(frozen=True, slots=True)
class PoseConfig:
    """How a frame becomes a pose."""

    blazepose: BlazePoseConfig = field(default_factory=BlazePoseConfig)
    """How bodies are found in the colour picture."""
    lift: LiftConfig = field(default_factory=LiftConfig)
    """How landmarks get their depth."""
    monocular: MonocularConfig = field(default_factory=MonocularConfig)
    """How they are placed when the camera has no depth."""
    filter: FilterConfig = field(default_factory=FilterConfig)
    """How poses are smoothed."""
    sides: SidesConfig = field(default_factory=SidesConfig)
    """When a change of left and right is not believed."""
    head: Literal["ears", "nose"] = "ears"
    """What the first landmark is: the middle of the ears, where a Kinect puts its head joint, so that
    people recorded with a Kinect and people seen by a camera agree; or the nose, as in the paper."""
    max_speed_m_s: float = 5.0
    """The middle of the hips moves no faster than this, seen from the camera (which turns as well)."""
    slack_m: float = 0.4
    """And besides jumps by no more than this, and by what its distance is uncertain: the noise of depth, a
    hip behind a hand."""
    forget_s: float = 1.0
    """After so long without the person, wherever somebody stands is believed."""
    patience_frames: int = 2
    """After so many jumped frames in a row the track is let go and the person is searched anew."""


class BodyTracker(Protocol):
    """Anything that finds a body in each picture of a stream."""

    def track(self, rgb: UInt8[np.ndarray, "height width 3"]) -> Body | None:
        """Return the body in the next picture, or ``None``."""
        ...

    def reset(self) -> None:
        """Forget whom it follows."""
        ...


class PoseEstimator:
    """Turns each frame of a stream into the pose of the one person it follows.

    Args:
        config: Options; the defaults suit an RGB-D camera on a drone, 2 to 8 m from the person. A camera
            without depth gives poses that are marked ``monocular``.
        tracker: What finds the body; BlazePose by default.

    Raises:
        ModelError: If a network file is missing and cannot be fetched, or is damaged.
    """

    def __init__(self, config: PoseConfig | None = None, tracker: BodyTracker | None = None) -> None:
        self.config = config = config or PoseConfig()
        self._tracker = tracker or BlazePose(config.blazepose)
        self._in_space = InSpace(config.lift, config.monocular, config.head)
        self._filter = PoseFilter(config.filter)
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
        self._filter.reset()
        self._stamp_ns: int | None = None
        self._jumped = 0

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the person's pose, or ``None`` if nobody is there or it cannot be told where they stand.

        Raises:
            InputError: If the frame is not later than the one before.
        """
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
        pose = self._in_space(body, frame)
        if pose is None:
            return None
        if not self._same_person(pose, frame.stamp_ns):
            self._filter.reset()
            return None
        return self._filter(pose)

    def _same_person(self, pose: Pose, stamp_ns: int) -> bool:
        """Say whether somebody here now can be who was there before, and remember where they are.

        A passer-by who crosses takes the network's track over. In the picture that looks smooth; in
        space the hips jump.
        """
        config, hips_m = self.config, pose.hip_center
        slack_m = config.slack_m + pose.distance_sigma_m
        if self._hips_m is not None:
            elapsed_s = (stamp_ns - self._hips_ns) * 1e-9
            far = float(np.linalg.norm(hips_m - self._hips_m))
            if elapsed_s < config.forget_s and far > slack_m + config.max_speed_m_s * elapsed_s:
                self._jumped += 1
                if self._jumped >= config.patience_frames:
                    self._tracker.reset()
                    self._sides.reset()
                    self._jumped = 0
                return False
        self._hips_m, self._hips_ns, self._jumped = hips_m, stamp_ns, 0
        return True
