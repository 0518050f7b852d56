"""A frame becomes what a lesson is told of it."""

from __future__ import annotations

from dataclasses import replace

from wigwag.camera.frame import Frame
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.pose.monocular import MonocularConfig
from wigwag.pose.operator import OperatorConfig
from wigwag.teach.advice import out_of_view
from wigwag.teach.teacher import Sight


def for_lessons(config: PoseConfig | None = None) -> PoseConfig:
    """Return options for teaching: whoever is seen first teaches, with depth or without. Nothing flies."""
    config = config or PoseConfig()
    return replace(config, monocular=MonocularConfig(), operator=OperatorConfig(engage="first"))


def see(estimator: PoseEstimator, frame: Frame) -> Sight:
    """Look for whoever teaches in a frame."""
    pose, body = estimator(frame), estimator.body
    height, width = frame.rgb.shape[:2]
    parts = () if body is None or pose is None else out_of_view(body.points_px, width, height)
    return Sight(frame.stamp_ns, pose, parts, estimator.why)


__all__ = ["for_lessons", "see"]
