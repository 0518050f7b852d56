"""What there is to see of a flight, as messages that Foxglove and Rerun know."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.extras import load
from wigwag.fly.operator import Mount
from wigwag.fly.values import VehicleState
from wigwag.skeleton import BONES, LANDMARKS, Pose

WORLD, BODY, CAMERA = "world", "drone", "camera_optical"
"""Frames of reference: ENU where it was switched on; FLU on the drone; optical at the camera."""

_LEFT, _RIGHT, _MIDDLE = (0.25, 0.61, 1.0), (1.0, 0.55, 0.16), (0.47, 0.9, 0.55)
_BONE_M, _JOINT_M = 0.03, 0.05


@cache
def message(name: str) -> Any:
    """Return the class of one of Foxglove's messages.

    Raises:
        MissingExtraError: If the extra ``record`` is not installed.
    """
    module = load(f"foxglove_schemas_protobuf.{name}_pb2", "record", "A flight's recording")
    return getattr(module, name)


def protobuf_schema(name: str) -> tuple[str, str, bytes]:
    """Return name, encoding and text of a message's schema: all files that describe it."""
    files = load("google.protobuf.descriptor_pb2", "record", "A flight's recording").FileDescriptorSet()
    known = set()

    def add(file: Any) -> None:
        """Add a file after all that it builds upon: readers take them in order."""
        if file.name not in known:
            known.add(file.name)
            for other in file.dependencies:
                add(other)
            file.CopyToProto(files.file.add())

    add(message(name).DESCRIPTOR.file)
    return f"foxglove.{name}", "protobuf", bytes(files.SerializeToString(deterministic=True))


def _stamped(made: Any, stamp_ns: int) -> Any:
    made.timestamp.seconds, made.timestamp.nanos = divmod(stamp_ns, 1_000_000_000)
    return made


def compressed_image(stamp_ns: int, data: bytes, kind: str) -> bytes:
    """Return a colour picture; ``kind`` is ``"jpeg"`` or ``"png"``."""
    made = message("CompressedImage")(frame_id=CAMERA, data=data, format=kind)
    return bytes(_stamped(made, stamp_ns).SerializeToString())


def depth_image(frame: Frame) -> bytes:
    """Return the depth as it is, 16-bit millimetres: the file's chunks are compressed."""
    assert frame.depth_mm is not None
    height, width = frame.depth_mm.shape
    made = message("RawImage")(
        frame_id=CAMERA, width=width, height=height, encoding="16UC1", step=2 * width,
        data=np.ascontiguousarray(frame.depth_mm, dtype="<u2").tobytes(),
    )  # fmt: skip
    return bytes(_stamped(made, frame.stamp_ns).SerializeToString())


def calibration(stamp_ns: int, lens: Intrinsics) -> bytes:
    """Return the pinhole that pictures are seen through."""
    matrix = [lens.fx, 0.0, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0]
    made = message("CameraCalibration")(
        frame_id=CAMERA, width=lens.width, height=lens.height, K=matrix,
        R=[1, 0, 0, 0, 1, 0, 0, 0, 1], P=[*matrix[:3], 0.0, *matrix[3:6], 0.0, *matrix[6:], 0.0],
    )  # fmt: skip
    return bytes(_stamped(made, stamp_ns).SerializeToString())


def skeleton(pose: Pose | None, stamp_ns: int) -> bytes:
    """Return the operator's skeleton in space; without a pose, that it is to vanish."""
    made = message("SceneUpdate")()
    if pose is None:
        made.deletions.add(id="operator")
        _stamped(made.deletions[0], stamp_ns)
        return bytes(made.SerializeToString())
    entity = _stamped(made.entities.add(frame_id=CAMERA, id="operator"), pose.stamp_ns)
    lines = entity.lines.add(type=2, thickness=_BONE_M)  # a list of pairs
    lines.pose.orientation.w = 1.0
    for a, b in BONES:
        r, g, blue = _colour(a, b)
        for end in (a, b):
            x, y, z = pose.joints[end].tolist()
            lines.points.add(x=x, y=y, z=z)
            lines.colors.add(r=r, g=g, b=blue, a=1.0)
    head = entity.spheres.add()
    head.pose.position.x, head.pose.position.y, head.pose.position.z = pose.joints[0].tolist()
    head.pose.orientation.w = 1.0
    head.size.x = head.size.y = head.size.z = 4 * _JOINT_M
    head.color.r, head.color.g, head.color.b, head.color.a = *_MIDDLE, 1.0
    return bytes(made.SerializeToString())


def cloud(pose: Pose | None, stamp_ns: int) -> bytes:
    """Return the skeleton as points, for viewers that do not know scenes; without a pose, none of them."""
    made = message("PointCloud")(frame_id=CAMERA, point_stride=_POINT.itemsize)
    made.pose.orientation.w = 1.0
    for name, part in (_POINT.fields or {}).items():
        made.fields.add(name=name, offset=part[1], type=_FLOAT32 if part[0] == np.float32 else _UINT8)
    if pose is None:
        return bytes(_stamped(made, stamp_ns).SerializeToString())
    bones = np.array(BONES)
    ends = pose.joints[bones]
    along = ends[:, None, 0] + _ALONG[:, None] * (ends[:, 1] - ends[:, 0])[:, None]
    points = np.zeros(along.shape[:2], _POINT)
    points["x"], points["y"], points["z"] = np.moveaxis(along, 2, 0)
    for k, name in enumerate(("red", "green", "blue")):
        points[name] = _BONE_COLOURS[:, None, k]
    points["alpha"] = 255
    made.data = points.tobytes()
    return bytes(_stamped(made, pose.stamp_ns).SerializeToString())


def overlay(pose: Pose | None, lens: Intrinsics, stamp_ns: int) -> bytes:
    """Return the skeleton as lines over the picture; without a pose, no lines."""
    made = message("ImageAnnotations")()
    if pose is None or pose.joints[:, 2].min() <= 0:
        return bytes(_stamped(made, stamp_ns).SerializeToString())
    _stamped(made, pose.stamp_ns)
    lines = _stamped(made.points.add(type=4, thickness=2.0), pose.stamp_ns)  # a list of pairs
    pixels = lens.project(pose.joints)
    for a, b in BONES:
        r, g, blue = _colour(a, b)
        lines.outline_colors.add(r=r, g=g, b=blue, a=1.0)
        for end in (a, b):
            lines.points.add(x=float(pixels[end, 0]), y=float(pixels[end, 1]))
    return bytes(made.SerializeToString())


def _colour(a: int, b: int) -> tuple[float, float, float]:
    sides = {LANDMARKS[end].partition("_")[0] for end in (a, b)}
    return _LEFT if sides == {"left"} else _RIGHT if sides == {"right"} else _MIDDLE


def transforms(state: VehicleState, mount: Mount, stamp_ns: int) -> bytes:
    """Return where the drone is in the world, and the camera on the drone."""
    made = message("FrameTransforms")()
    _transform(
        made, stamp_ns, (WORLD, BODY), state.position_m.tolist(),
        _euler(state.heading_rad, state.pitch_rad, state.roll_rad),
    )  # fmt: skip
    # Optical axes on a level FLU body are (-y, -z, x); the mount's pitch comes after.
    optical = _times(_euler(0.0, mount.pitch_down_rad, 0.0), (0.5, -0.5, 0.5, -0.5))
    _transform(made, stamp_ns, (BODY, CAMERA), mount.offset_m, optical)
    return bytes(made.SerializeToString())


def _transform(
    made: Any, stamp_ns: int, frames: tuple[str, str], at: Sequence[float], turned: Sequence[float]
) -> None:
    one = made.transforms.add(parent_frame_id=frames[0], child_frame_id=frames[1])
    _stamped(one, stamp_ns)
    one.translation.x, one.translation.y, one.translation.z = (float(v) for v in at)
    one.rotation.w, one.rotation.x, one.rotation.y, one.rotation.z = (float(v) for v in turned)


def _euler(yaw: float, pitch: float, roll: float) -> tuple[float, float, float, float]:
    """Return the quaternion (w, x, y, z) of yaw, then pitch, then roll."""
    made: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    for angle, axis in ((yaw, 2), (pitch, 1), (roll, 0)):
        part = [np.cos(angle / 2), 0.0, 0.0, 0.0]
        part[1 + axis] = np.sin(angle / 2)
        made = _times(made, part)
    return made


def _times(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Multiply quaternions (w, x, y, z)."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


_POINT = np.dtype([(name, "<f4") for name in "xyz"] + [(n, "u1") for n in ("red", "green", "blue", "alpha")])
_UINT8, _FLOAT32 = 1, 7
"""Foxglove's numbers for these types."""
_ALONG = np.linspace(0.0, 1.0, 5)
"""Where points are set on a bone."""
_BONE_COLOURS = np.round(255 * np.array([_colour(a, b) for a, b in BONES])).astype(np.uint8)


def log(stamp_ns: int, text: str, alarming: bool = False) -> bytes:
    """Return a line for the log: a gesture, a transition."""
    made = message("Log")(level=3 if alarming else 2, message=text, name="wigwag")
    return bytes(_stamped(made, stamp_ns).SerializeToString())


__all__ = [
    "calibration", "cloud", "compressed_image", "depth_image", "log", "message", "overlay",
    "protobuf_schema", "skeleton", "transforms",
]  # fmt: skip
