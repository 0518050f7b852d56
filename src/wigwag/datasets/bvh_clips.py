"""Clips out of BVH files and into them: joints by their many names, units, and exact landmarks.

A clip is written with a position for every joint, so that the landmarks are where they were to within a
nanometre, in centimetres, on a figure of 13 landmarks, ``Hips`` and ``Chest``. It has no rotations: a viewer
shows it as it was, but it is no rig for retargeting. BVH knows one steady frame time, and neither label nor
person: those become folders, ``<label>/<subject>/<name>.bvh``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float

from wigwag.datasets.bvh import Joint, Motion, format_motion, read_motion
from wigwag.datasets.folder import UNLABELLED
from wigwag.datasets.notes import Notes
from wigwag.errors import DataError, InputError
from wigwag.skeleton import LANDMARKS, Clip, Landmark

UNITS_M: dict[str, float] = {
    "metre": 1.0, "centimetre": 0.01, "millimetre": 0.001, "inch": 0.0254, "CMU": 0.0254 / 0.45,
}  # fmt: skip
"""Units that BVH files come in, in metres. The CMU collection's is 1/0.45 of an inch."""

_LEG_M = (0.5, 1.1)
"""A leg from hip to ankle, from a child's to a tall person's: no two of the units fit into it at once."""

_PARTS: dict[str, tuple[str, ...]] = {
    "shoulder": ("arm", "uparm", "upperarm", "shldr", "shoulderjoint", "humerus", "shoulder"),
    "elbow": ("elbow", "forearm", "lowarm", "lowerarm", "radius"),
    "wrist": ("wrist", "hand"),
    "hip": ("upleg", "upperleg", "thigh", "femur", "hip"),
    "knee": ("knee", "lowleg", "lowerleg", "shin", "calf", "tibia", "leg"),
    "heel": ("heel", "ankle", "foot"),
}
"""Names of each landmark's joint without side, the surest first: where there is an ``Arm``, the ``Shoulder``
is a collar bone (CMU, Mixamo, Rokoko); where there is none, it is the shoulder."""

_PREFIX = re.compile(r"^(mixamorig\d*|bip\d+|character\d+|b|def)[ _:.-]+")
_TIPS = {"headend", "headtop", "headtopend", "headnub", "headsite"}
_STEADY_NS = 1_000_000
"""Frames this near to a steady rhythm are written as they are; others are put into one."""

_TREE: tuple[tuple[str, str], ...] = (
    ("Hips", ""), ("LeftHip", "Hips"), ("LeftKnee", "LeftHip"), ("LeftHeel", "LeftKnee"),
    ("RightHip", "Hips"), ("RightKnee", "RightHip"), ("RightHeel", "RightKnee"),
    ("Chest", "Hips"), ("Nose", "Chest"),
    ("LeftShoulder", "Chest"), ("LeftElbow", "LeftShoulder"), ("LeftWrist", "LeftElbow"),
    ("RightShoulder", "Chest"), ("RightElbow", "RightShoulder"), ("RightWrist", "RightElbow"),
)  # fmt: skip
"""The figure that is written: each joint and the one above."""

_NO_TURN = ("zrotation", "xrotation", "yrotation")
_END_CM = (0.0, -5.0, 0.0)
"""Where viewers draw a last joint's bone to; it stands for nothing."""

_TURN = np.array([1.0, -1.0, -1.0])
"""Between BVH's axes (y up, facing +z) and the camera optical frame: half a turn about x, its own inverse."""


def read_bvh(
    path: str | Path, label: str | None = None, subject: str | None = None, unit_m: float | None = None
) -> Clip:
    """Read one BVH file's 13 landmarks.

    Args:
        path: The file.
        label: What is shown; BVH files do not say.
        subject: Who shows it.
        unit_m: The file's unit of length in metres; ``None``: of :data:`UNITS_M` the one by which the legs
            have a person's length.

    Returns:
        A clip in metres whose first stamp is 0. Ankles stand in for heels where there are none; for the nose
        the middle between the head's joint and its tip, about where a Kinect puts the head.

    Raises:
        DataError: If the file is damaged, lacks a joint, or no unit makes it a person; the message names it.
    """
    path = Path(path)
    motion = read_motion(path)
    try:
        landmarks = _landmarks(motion)
        scale = unit_m if unit_m is not None else _unit_m(landmarks)
        if not 0 < scale < np.inf:
            raise InputError(f"unit_m must be metres, above 0, but got {scale}.")
        stamps = np.round(np.arange(len(landmarks)) * (motion.frame_time_s * 1e9)).astype(np.int64)
        return Clip(landmarks * scale * _TURN, stamps, label, subject, path.stem)
    except InputError as error:
        raise DataError(f"{path}: {str(error).removeprefix(f'{path.stem}: ')}") from error


def read_bvhs(path: str | Path, notes: Notes, unit_m: float | None = None) -> Iterator[Clip]:
    """Yield a BVH file, or every one below a folder, sorted by path.

    In a folder the first folder's name is the label and the second's the person, as they are written here.

    Raises:
        DataError: If there is none, or the one file is damaged; of several, ``notes`` takes what is left out.
    """
    path = Path(path)
    if path.is_file():
        yield read_bvh(path, unit_m=unit_m)
        return
    for file in sorted(p for p in path.rglob("*") if p.suffix.lower() == ".bvh"):
        label, subject = (*file.relative_to(path).parts[:-1], None, None)[:2]
        try:
            yield read_bvh(file, None if label == UNLABELLED else label, subject, unit_m)
        except DataError as error:
            notes.left_out.append((str(file.relative_to(path)), str(error).removeprefix(f"{file}: ")))


def bvh_text(clip: Clip) -> tuple[str, str]:
    """Write a clip as BVH.

    Returns:
        The file's content, and what was done to the clip, in words (empty: nothing).
    """
    joints, step_ns, said = _steady(clip)
    places = _places(joints * _TURN * 100.0)
    above_some = {above for _, above in _TREE}
    nodes: list[Joint] = []
    columns: list[Float[np.ndarray, "frames 3"]] = []
    index: dict[str, int] = {}
    for name, above in _TREE:
        index[name] = len(nodes)
        channels: tuple[str, ...] = ("xposition", "yposition", "zposition")
        if above:
            columns.append(places[name] - places[above])
            x, y, z = (float(value) for value in columns[-1][0])  # at rest as in the first frame
            nodes.append(Joint(name, index[above], (x, y, z), channels))
        else:  # some programs insist on six channels of the root
            columns += [places[name], np.zeros_like(places[name])]
            nodes.append(Joint(name, -1, (0.0, 0.0, 0.0), (*channels, *_NO_TURN)))
        if name not in above_some:
            nodes.append(Joint(f"{name}_end", index[name], _END_CM, (), tip=True))
    return format_motion(Motion(tuple(nodes), np.concatenate(columns, axis=1), step_ns * 1e-9)), said


def _places(points: Float[np.ndarray, "frames 13 3"]) -> dict[str, Float[np.ndarray, "frames 3"]]:
    """Return where each joint of the figure is that is written."""
    of = {landmark: points[:, i] for i, landmark in enumerate(LANDMARKS)}
    places = {name: of[_snake(name)] for name, _ in _TREE if _snake(name) in of}
    places["Hips"] = (of["left_hip"] + of["right_hip"]) / 2
    places["Chest"] = (of["left_shoulder"] + of["right_shoulder"]) / 2
    return places


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def _steady(clip: Clip) -> tuple[Float[np.ndarray, "frames 13 3"], float, str]:
    """Return frames at a steady rhythm, nanoseconds a frame, and what was done."""
    stamps = clip.stamps_ns - clip.stamps_ns[0]
    step_ns = float(stamps[-1]) / (len(stamps) - 1)
    even_ns = 1e9 / round(1e9 / step_ns, 3)  # 30 a second and not 29.99999994, where stamps are rounded to it
    if np.array_equal(np.round(np.arange(len(stamps)) * even_ns), stamps):
        step_ns = even_ns
    rhythm = np.arange(len(stamps)) * step_ns
    joints = np.asarray(clip.joints, dtype=np.float64)
    if np.abs(stamps - rhythm).max() <= _STEADY_NS:
        return joints, step_ns, ""
    flat = joints.reshape(len(joints), -1)
    even = np.stack([np.interp(rhythm, stamps, column) for column in flat.T], axis=1)
    said = f"uneven stamps: interpolated to a steady {1e9 / step_ns:.2f} frames a second"
    return even.reshape(joints.shape), step_ns, said


def _landmarks(motion: Motion) -> Float[np.ndarray, "frames 13 3"]:
    """Find the 13 landmarks, in the file's frame and unit."""
    roots = [i for i, joint in enumerate(motion.joints) if joint.parent < 0]
    last = roots[1] if len(roots) > 1 else len(motion.joints)
    named: dict[str, int] = {}
    for i, joint in enumerate(motion.joints[:last]):
        if not joint.tip:
            for key in _keys(joint.name):
                named.setdefault(key, i)
    places = motion.positions()
    found = []
    for landmark in LANDMARKS:
        if landmark == "nose":
            found.append(_nose(motion, named, places))
            continue
        side, _, part = landmark.partition("_")
        joint_index = next((named[f"{side}{p}"] for p in _PARTS[part] if f"{side}{p}" in named), None)
        if joint_index is None:
            raise InputError(_lacks(motion, landmark, [f"{side}{p}" for p in _PARTS[part]]))
        found.append(places[:, joint_index])
    return np.stack(found, axis=1)


def _nose(motion: Motion, named: dict[str, int], places: np.ndarray) -> Float[np.ndarray, "frames 3"]:
    if "nose" in named:
        return np.asarray(places[:, named["nose"]])
    if "head" not in named:
        raise InputError(_lacks(motion, "nose", ["nose", "head"]))
    head = named["head"]
    for i, joint in enumerate(motion.joints):
        if joint.parent == head and (joint.tip or _TIPS & set(_keys(joint.name))):
            return np.asarray((places[:, head] + places[:, i]) / 2)
    return np.asarray(places[:, head])


def _lacks(motion: Motion, landmark: str, names: list[str]) -> str:
    there = ", ".join(joint.name for joint in motion.joints if not joint.tip)
    return f"HIERARCHY has no joint for {landmark}: expected {' or '.join(names)}, but has {there[:300]}."


def _keys(name: str) -> Iterator[str]:
    """Yield what a joint's name may mean, such as ``"leftarm"`` for mixamorig:LeftArm, lArm and arm.L."""
    bare = name.rpartition(":")[2].strip().lower()
    bare = _PREFIX.sub("", bare)
    yield re.sub(r"[^a-z0-9]", "", bare)
    for pattern in (
        r"(?P<side>left|right|l|r)[ _.-]*(?P<part>.+)",
        r"(?P<part>.+)[ _.-]+(?P<side>left|right|l|r)",
    ):
        if match := re.fullmatch(pattern, bare):
            side = "left" if match["side"].startswith("l") else "right"
            yield side + re.sub(r"[^a-z0-9]", "", match["part"])


def _unit_m(landmarks: Float[np.ndarray, "frames 13 3"]) -> float:
    """Tell the unit by the legs, whose length does not depend on the pose."""
    sides = (
        (Landmark.LEFT_HIP, Landmark.LEFT_KNEE, Landmark.LEFT_HEEL),
        (Landmark.RIGHT_HIP, Landmark.RIGHT_KNEE, Landmark.RIGHT_HEEL),
    )
    leg = float(
        np.mean([np.linalg.norm(np.diff(landmarks[0, side, :], axis=0), axis=1).sum() for side in sides])
    )
    for scale in UNITS_M.values():
        if _LEG_M[0] <= leg * scale <= _LEG_M[1]:
            return scale
    raise InputError(
        f"a leg is {leg:.4g} units long, which is no person's in {', '.join(UNITS_M)}. Give the file's unit "
        "in metres (--unit-m)."
    )


__all__ = ["UNITS_M", "bvh_text", "read_bvh", "read_bvhs"]
