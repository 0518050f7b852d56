"""BVH files: a hierarchy of joints, Euler angles and positions a frame, as motion capture leaves them.

Axes, here and in all of wigwag's BVH: right-handed, y up; a figure at rest faces +z, so that its left is at
+x. That is the camera optical frame (x right, y down, z forward) turned by half a turn about x, with the
person facing the camera: ``(x, y, z) -> (x, -y, -z)`` both ways. Rotation channels apply in the order in
which the file lists them, each about the axes that the one before has turned.

What leaves other programs differ on, and what is done here:

- **Position channels of inner joints** stand for the joint's offset (Blender, MotionBuilder) or are added to
  it (three.js). Read is whichever keeps bones nearer to the lengths that OFFSET gives; written is the first.
- **Several figures** in one file: the first is taken.
- **Names with spaces**, braces on the line of a name, channels in any order and number, values wrapped over
  lines.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from wigwag.errors import DataError

_POSITIONS = ("xposition", "yposition", "zposition")
_ROTATIONS = ("xrotation", "yrotation", "zrotation")
_DEEPEST = 1000
"""Joints within joints: more is no figure."""


@dataclass(frozen=True, slots=True)
class Joint:
    """One node of the hierarchy."""

    name: str
    """As in the file; an ``End Site`` is named after its parent, with ``_end``."""
    parent: int
    """Index of the joint above; -1 for a root."""
    offset: tuple[float, float, float]
    """From the parent at rest, in the file's unit."""
    channels: tuple[str, ...]
    """Lower case, such as ``"xposition"`` or ``"zrotation"``, in the file's order."""
    tip: bool = False
    """Whether it is an ``End Site``."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The content of a BVH file."""

    joints: tuple[Joint, ...]
    """Parents before children."""
    values: Float[np.ndarray, "frames channels"]
    """Degrees and the file's unit of length, in the order of joints and their channels."""
    frame_time_s: float
    """Seconds from one frame to the next."""

    def positions(self) -> Float[np.ndarray, "frames joints 3"]:
        """Return every joint's place in the file's frame and unit (forward kinematics)."""
        frames = len(self.values)
        local, turn = self._local()
        places = np.zeros((frames, len(self.joints), 3))
        turns = np.zeros((frames, len(self.joints), 3, 3))
        for i, joint in enumerate(self.joints):
            if joint.parent < 0:
                places[:, i], turns[:, i] = local[:, i], turn[i]
            else:
                above = turns[:, joint.parent]
                places[:, i] = places[:, joint.parent] + np.einsum("fij,fj->fi", above, local[:, i])
                turns[:, i] = above @ turn[i]
        return places

    def _local(self) -> tuple[Float[np.ndarray, "frames joints 3"], list[Float[np.ndarray, "frames 3 3"]]]:
        """Return each joint's displacement from and rotation against its parent."""
        frames = len(self.values)
        offsets = np.array([joint.offset for joint in self.joints])
        moved = np.repeat(offsets[None], frames, axis=0)
        given = np.zeros((frames, len(self.joints), 3))
        turns = []
        column = 0
        for i, joint in enumerate(self.joints):
            turn = np.broadcast_to(np.eye(3), (frames, 3, 3))
            for channel in joint.channels:
                value = self.values[:, column]
                column += 1
                if channel in _POSITIONS:
                    axis = _POSITIONS.index(channel)
                    moved[:, i, axis] = value
                    given[:, i, axis] = value
                else:
                    turn = turn @ _about(_ROTATIONS.index(channel), np.radians(value))
            turns.append(turn)
        if self._adds(moved, given, offsets):
            inner = [i for i, joint in enumerate(self.joints) if joint.parent >= 0]
            moved[:, inner] = offsets[inner] + given[:, inner]
        return moved, turns

    def _adds(self, moved: np.ndarray, given: np.ndarray, offsets: np.ndarray) -> bool:
        """Say whether inner joints' positions are added to their offsets: so that bones keep their length."""
        inner = [
            i
            for i, joint in enumerate(self.joints)
            if joint.parent >= 0 and any(channel in _POSITIONS for channel in joint.channels)
        ]
        if not inner:
            return False
        lengths = np.linalg.norm(offsets[inner], axis=1)
        wrong = [
            np.abs(np.median(np.linalg.norm(places[:, inner], axis=2), axis=0) - lengths).sum()
            for places in (moved, offsets + given)
        ]
        return bool(wrong[1] < wrong[0])


def read_motion(path: str | Path) -> Motion:
    """Read a BVH file.

    Raises:
        DataError: If it is missing, no BVH, or cut off; the message names file and place.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
    try:
        return parse_motion(text)
    except DataError as error:
        raise DataError(f"{path}: {error}") from error


def parse_motion(text: str) -> Motion:
    """Read the content of a BVH file.

    Raises:
        DataError: If it is no BVH or was cut off; the message says where, and leaves naming the file to
            the caller.
    """
    parts = re.split(r"^\s*MOTION\s*$", text, maxsplit=1, flags=re.MULTILINE | re.IGNORECASE)
    if len(parts) != 2 or not re.match(r"\s*HIERARCHY\b", parts[0], re.IGNORECASE):
        raise DataError("is no BVH: expected the lines HIERARCHY and MOTION.")
    joints = _hierarchy(parts[0])
    head = re.match(r"\s*Frames\s*:\s*(\d+)\s+Frame\s+Time\s*:\s*(\S+)", parts[1], re.IGNORECASE)
    if head is None:
        raise DataError("MOTION must begin with 'Frames: N' and 'Frame Time: seconds', but does not.")
    frames, frame_time_s = int(head[1]), _number(head[2], "Frame Time")
    if not 1e-5 < frame_time_s < 10:
        raise DataError(f"Frame Time must be seconds a frame, above 0, but got {head[2]}.")
    width = sum(len(joint.channels) for joint in joints)
    words = parts[1][head.end() :].split()
    if len(words) != frames * width:
        raise DataError(
            f"MOTION must hold {frames} frames of {width} values, {frames * width} in all, but holds "
            f"{len(words)}. Was the file cut off?"
        )
    try:
        values = np.array(words, dtype=np.float64).reshape(frames, width)
    except ValueError as error:
        raise DataError(f"MOTION holds what is no number ({error}).") from error
    if not np.isfinite(values).all():
        bad = int(np.argmin(np.isfinite(values).all(axis=1)))
        raise DataError(f"MOTION holds NaN or infinity, first in frame {bad}.")
    return Motion(joints, values, frame_time_s)


def _hierarchy(text: str) -> tuple[Joint, ...]:
    """Read the joints of every figure, parents before children."""
    joints: list[Joint] = []
    open_joints: list[int] = []
    body = text.strip()[len("HIERARCHY") :]
    for line in re.sub(r"([{}])", r"\n\1\n", body).splitlines():
        words = line.split()
        if not words:
            continue
        keyword = words[0].upper()
        if keyword in {"ROOT", "JOINT", "END"}:
            if len(joints) >= _DEEPEST:
                raise DataError(f"HIERARCHY has more than {_DEEPEST} joints.")
            joints.append(_joint(keyword, words, joints, open_joints))
        elif keyword == "{":
            open_joints.append(len(joints) - 1)
        elif keyword == "}":
            if not open_joints:
                raise DataError("HIERARCHY closes more braces than it opens.")
            open_joints.pop()
        elif keyword in {"OFFSET", "CHANNELS"} and open_joints:
            joints[open_joints[-1]] = _described(joints[open_joints[-1]], keyword, words[1:])
        else:
            raise DataError(f"HIERARCHY holds {line.strip()[:40]!r}, which is no part of a BVH.")
    if open_joints or not joints:
        raise DataError("HIERARCHY ends within a joint; the file was cut off.")
    return tuple(joints)


def _joint(keyword: str, words: list[str], joints: list[Joint], open_joints: list[int]) -> Joint:
    if (keyword == "ROOT") == bool(open_joints):
        raise DataError(f"HIERARCHY has {' '.join(words)[:40]!r} where it cannot stand.")
    parent = open_joints[-1] if open_joints else -1
    if keyword == "END":
        return Joint(f"{joints[parent].name}_end", parent, (0.0, 0.0, 0.0), (), tip=True)
    if len(words) < 2:
        raise DataError(f"HIERARCHY has a {keyword} without a name.")
    return Joint(" ".join(words[1:]), parent, (0.0, 0.0, 0.0), ())


def _described(joint: Joint, keyword: str, words: list[str]) -> Joint:
    """Add a line OFFSET or CHANNELS to a joint."""
    if keyword == "OFFSET":
        if len(words) != 3:
            raise DataError(f"OFFSET of {joint.name} must be 3 numbers, but got {' '.join(words)[:40]!r}.")
        x, y, z = (_number(word, f"OFFSET of {joint.name}") for word in words)
        return Joint(joint.name, joint.parent, (x, y, z), joint.channels, joint.tip)
    channels = tuple(word.lower() for word in words[1:])
    known = set(_POSITIONS + _ROTATIONS)
    if not words or words[0] != str(len(channels)) or not known.issuperset(channels):
        raise DataError(
            f"CHANNELS of {joint.name} must be a count and so many of Xposition ... Zrotation, "
            f"but got {' '.join(words)[:60]!r}."
        )
    return Joint(joint.name, joint.parent, joint.offset, channels, joint.tip)


def _number(word: str, what: str) -> float:
    try:
        value = float(word)
    except ValueError as error:
        raise DataError(f"{what} must be a number, but got {word[:20]!r}.") from error
    if not np.isfinite(value):
        raise DataError(f"{what} must be a finite number, but got {word!r}.")
    return value


def _about(axis: int, angle: Float[np.ndarray, " frames"]) -> Float[np.ndarray, "frames 3 3"]:
    """Rotation matrices about one axis, radians, right-handed."""
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.zeros((len(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[:, axis, axis] = 1.0
    turn[:, i, i] = turn[:, j, j] = cos
    turn[:, i, j], turn[:, j, i] = -sin, sin
    return turn


def format_motion(motion: Motion) -> str:
    """Write the content of a BVH file, lengths and angles to 1e-8 of their units."""
    children: dict[int, list[int]] = {}
    for i, joint in enumerate(motion.joints):
        children.setdefault(joint.parent, []).append(i)
    lines = ["HIERARCHY"]

    def write(i: int, depth: int) -> None:
        joint, tab = motion.joints[i], "\t" * depth
        kind = "End Site" if joint.tip else f"{'ROOT' if joint.parent < 0 else 'JOINT'} {joint.name}"
        lines.extend([f"{tab}{kind}", f"{tab}{{", f"{tab}\tOFFSET {_words(joint.offset)}"])
        if not joint.tip:
            named = " ".join(channel[0].upper() + channel[1:] for channel in joint.channels)
            lines.append(f"{tab}\tCHANNELS {len(joint.channels)} {named}")
        for child in children.get(i, []):
            write(child, depth + 1)
        lines.append(f"{tab}}}")

    for root in children[-1]:
        write(root, 0)
    lines += ["MOTION", f"Frames: {len(motion.values)}", f"Frame Time: {motion.frame_time_s!r}"]
    lines += [_words(row) for row in motion.values]
    return "\n".join(lines) + "\n"


def _words(values: tuple[float, ...] | Float[np.ndarray, " values"]) -> str:
    return " ".join(f"{value:.8f}" for value in values)


__all__ = ["Joint", "Motion", "format_motion", "parse_motion", "read_motion"]
