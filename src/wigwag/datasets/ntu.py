"""NTU RGB+D (60 and 120 classes): ``.skeleton`` files of a Kinect v2, 25 joints, several bodies.

Shahroudy, Liu, Ng, Wang, "NTU RGB+D: A Large Scale Dataset for 3D Human Activity Analysis", CVPR 2016; Liu et
al., "NTU RGB+D 120", TPAMI 2019. wigwag carries none of the recordings.

What the files are known for, and what happens here:

- **Empty files**: hundreds hold no body at all. They are left out by name.
- **Bodies that are furniture**: the Kinect takes chairs for people. A body that is mostly wider than tall
  counts only if there is no other.
- **Several bodies**: a clip is one person. Of the bodies tracked at least half as long as the longest, the
  one that moves most is kept. In actions of two people (A050-A060, A106-A120) that is one of the two.
- **Tracking identities change** when the person is lost and found again. A body that appears where the chosen
  one disappeared, in other frames, is taken for the same person.
- **Identities exceed 2**53**: they are read as text, since as floating-point numbers they would run together.
- **Joints that were not tracked** (state 0) are filled in over time from the frames around; inferred ones
  (state 1) are kept as they are.
- **Three cameras** (C001-C003) see the same performance; clips of one S, P, R, A are no independent examples.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from wigwag.datasets.archive import Archive, open_archive
from wigwag.datasets.lost import FEWEST_SEEN, bridged
from wigwag.datasets.notes import Notes
from wigwag.errors import DataError
from wigwag.skeleton import Clip, from_kinect20

RATE_HZ = 30.0
"""Frames a second; the files hold no stamps."""

KINECT25: tuple[str, ...] = (
    "hip_center", "spine", "neck", "head", "left_shoulder", "left_elbow", "left_wrist", "left_hand",
    "right_shoulder", "right_elbow", "right_wrist", "right_hand", "left_hip", "left_knee", "left_ankle",
    "left_foot", "right_hip", "right_knee", "right_ankle", "right_foot", "shoulder_center",
    "left_hand_tip", "left_thumb", "right_hand_tip", "right_thumb",
)  # fmt: skip
"""The Kinect v2's joints in the files' order."""

HINT = (
    "NTU RGB+D comes from the ROSE Lab of Nanyang Technological University; give a .skeleton file, the "
    "folder of such files (S001C001P001R001A001.skeleton), or the zip file they came in."
)
ZIPS = ("nturgbd_skeletons_s001_to_s017.zip", "nturgbd_skeletons_s018_to_s032.zip")
FOLDER = "nturgb+d_skeletons"

_NAME = re.compile(r"S(\d{3})C(\d{3})P(\d{3})R(\d{3})A(\d{3})")
_FILE = re.compile(r"S\d{3}C\d{3}P\d{3}R\d{3}A\d{3}\.skeleton", re.IGNORECASE)
_BODY_FIELDS = 10
_JOINT_FIELDS = 12
_WIDER_THAN_TALL = 0.8
"""Extent in x over extent in y beyond which a body of one frame looks like furniture."""
_SAME_PLACE_M = 0.5
"""A body found again within this of where one was lost is the same person."""

_LANDMARK_JOINTS = [
    KINECT25.index(name)
    for name in (
        "head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
        "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle",
    )
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Body:
    """One tracked body of a recording."""

    identity: str
    """The Kinect's tracking id, as text."""
    rows: Int[np.ndarray, " seen"]
    """Frames in which it was seen, ascending."""
    joints: Float[np.ndarray, "seen 25 3"]
    """Metres, Kinect frame: y up, z away from the camera, the person's right side at +x."""
    states: Int[np.ndarray, "seen 25"]
    """0: not tracked, 1: inferred, 2: tracked."""

    @property
    def motion_m2(self) -> float:
        """How much it moves: the joints' variance over time, summed over axes, mean over joints."""
        return float(self.joints.var(axis=0).sum(axis=1).mean())

    @property
    def like_furniture(self) -> bool:
        """Whether it is wider than tall in most frames."""
        extent = np.ptp(self.joints, axis=1)
        return bool(np.mean(extent[:, 0] > _WIDER_THAN_TALL * extent[:, 1]) > 0.5)


def read_ntu(
    path: str | Path,
    notes: Notes,
    labels: Collection[str] | None = None,
    subjects: Collection[str] | None = None,
    rate_hz: float = RATE_HZ,
) -> Iterator[Clip]:
    """Yield every recording, sorted by name.

    Args:
        path: A ``.skeleton`` file, a folder of them, or the zip file.
        notes: Takes what is left out or repaired, and why; which body was chosen where there were several.
        labels: Only these actions, such as ``("A023",)``; ``None``: all.
        subjects: Only these people, such as ``("ntu_p001",)``; ``None``: all.
        rate_hz: Frames a second.

    Yields:
        Clips named ``"S001C001P001R001A001"``, labelled ``"A001"``, of subject ``"ntu_p001"``, in metres in
        the camera optical frame. Head and ankles stand in for nose and heels.

    Raises:
        DataError: If there is no such set at ``path``.
    """
    path = Path(path)
    if path.is_file() and path.suffix.lower() == ".skeleton":
        archives = open_archive(path.parent, "", (), re.compile(re.escape(path.name)), HINT)
    else:
        archives = open_archive(path, FOLDER, ZIPS, _FILE, HINT)
    with archives as archive:
        for file in sorted(archive.files):
            found = _NAME.fullmatch(Path(file).stem.upper())
            if found is None:
                notes.left_out.append((file, "has a name that is not NTU's (S001C001P001R001A001.skeleton)"))
                continue
            label, subject = f"A{found[5]}", f"ntu_p{found[3]}"
            if (labels is None or label in labels) and (subjects is None or subject in subjects):
                try:
                    joints, done = _person(_bodies(archive, file), rate_hz)
                    yield Clip.at_rate(joints, rate_hz, label, subject, found[0])
                except DataError as error:
                    notes.left_out.append((file, str(error).removeprefix(f"{file}: ")))
                    continue
                if done:
                    notes.repaired.append((file, done))


def parse_skeleton(text: str, name: str) -> list[Body]:
    """Read a ``.skeleton`` file's bodies, in the order in which they appear.

    Args:
        text: The file's content.
        name: The file's name, for error messages.

    Raises:
        DataError: If the file ends early, goes on too long, or a number is none; the message names the frame.
    """
    words = text.split()
    at = 0

    def take(count: int, what: str) -> list[str]:
        nonlocal at
        if at + count > len(words):
            raise DataError(f"{name}: ends within {what}; it was cut off. Fetch the file again.")
        at += count
        return words[at - count : at]

    rows: dict[str, list[int]] = {}
    data: dict[str, list[np.ndarray]] = {}
    frames = _count(take(1, "the number of frames")[0], name, "the number of frames")
    for frame in range(frames):
        where = f"frame {frame}"
        for _ in range(_count(take(1, where)[0], name, f"the number of bodies of {where}")):
            head = take(_BODY_FIELDS, where)
            n_joints = _count(take(1, where)[0], name, f"the number of joints of {where}")
            if n_joints != len(KINECT25):
                raise DataError(f"{name}: {where} has a body of {n_joints} joints, but 25 are expected.")
            try:
                values = np.array(take(n_joints * _JOINT_FIELDS, where), dtype=np.float64)
                state = int(head[-1])
            except ValueError as error:
                raise DataError(f"{name}: {where} holds what is no number ({error}).") from error
            if state != 0 and (not rows.get(head[0]) or rows[head[0]][-1] != frame):
                rows.setdefault(head[0], []).append(frame)
                data.setdefault(head[0], []).append(values.reshape(n_joints, _JOINT_FIELDS))
    if at != len(words):
        raise DataError(f"{name}: goes on after the {frames} frames that it announces. Fetch the file again.")
    bodies = []
    for identity, stack in data.items():
        table = np.stack(stack)
        states = np.nan_to_num(table[..., -1]).astype(np.int64)
        bodies.append(Body(identity, np.array(rows[identity]), table[..., :3], states))
    return bodies


def choose(bodies: list[Body]) -> tuple[Body, str]:
    """Choose the body that a clip is about, and join what the Kinect lost and found again.

    Returns:
        The body, and what was done, in words (empty: there was one alone).

    Raises:
        DataError: If there is none. The message is the reason alone.
    """
    if not bodies:
        raise DataError("nobody is seen: the file holds no body (NTU lists such recordings as missing)")
    upright = [body for body in bodies if not body.like_furniture] or bodies
    longest = max(len(body.rows) for body in upright)
    chosen = max((b for b in upright if 2 * len(b.rows) >= longest), key=lambda body: body.motion_m2)
    joined = 1
    while (part := _continuation(chosen, [b for b in upright if b is not chosen])) is not None:
        chosen = _joined(chosen, part)
        upright = [b for b in upright if b is not part]
        joined += 1
    said = []
    if joined > 1:
        said.append(f"{joined} tracks joined into one person")
    if others := len(bodies) - joined:
        said.append(
            f"{others} of {len(bodies)} bodies left out: kept the one that moves most of those tracked long"
        )
    return chosen, ", ".join(said)


def _continuation(body: Body, others: list[Body]) -> Body | None:
    """Find a track that lies before or after, where the body was last or is first seen."""
    for other in others:
        before, after = (other, body) if other.rows[-1] < body.rows[0] else (body, other)
        if before.rows[-1] < after.rows[0]:
            gap = after.joints[0, 0] - before.joints[-1, 0]  # the base of the spine
            if np.linalg.norm(gap) <= _SAME_PLACE_M:
                return other
    return None


def _joined(a: Body, b: Body) -> Body:
    first, second = (a, b) if a.rows[0] < b.rows[0] else (b, a)
    return Body(
        a.identity,
        np.concatenate([first.rows, second.rows]),
        np.concatenate([first.joints, second.joints]),
        np.concatenate([first.states, second.states]),
    )


def _person(bodies: list[Body], rate_hz: float) -> tuple[Float[np.ndarray, "frames 13 3"], str]:
    """Return the chosen person's landmarks without holes, and what was done."""
    body, said = choose(bodies)
    frames = int(body.rows[-1]) + 1
    filled, holes = _filled(body)
    whole = np.zeros((frames, len(KINECT25), 3))
    whole[body.rows] = filled
    there = from_kinect20(whole, KINECT25)
    joints, bridges = bridged(there, rate_hz)
    inferred = float(np.mean(body.states[:, _LANDMARK_JOINTS] == 1))
    doubts = f"{inferred:.0%} of landmarks inferred by the Kinect" if inferred > 0.25 else ""
    return joints, ", ".join(part for part in (said, holes, bridges, doubts) if part)


def _filled(body: Body) -> tuple[Float[np.ndarray, "seen 25 3"], str]:
    """Fill joints that were not tracked from the frames around them."""
    good = (body.states > 0) & np.isfinite(body.joints).all(axis=-1)
    joints = np.where(good[..., None], body.joints, 0.0)
    holes = 0
    for joint in _LANDMARK_JOINTS:
        there = good[:, joint]
        if there.mean() < FEWEST_SEEN:
            raise DataError(
                f"{KINECT25[joint]} is not tracked in {int((~there).sum())} of {len(there)} frames"
            )
        if not there.all():
            holes += int((~there).sum())
            for axis in range(3):
                joints[:, joint, axis] = np.interp(body.rows, body.rows[there], joints[there, joint, axis])
    return joints, f"{holes} joints that were not tracked filled in" if holes else ""


def _bodies(archive: Archive, file: str) -> list[Body]:
    try:
        text = archive.read(file).decode("ascii")
    except UnicodeDecodeError as error:
        raise DataError(f"{file}: is no text ({error.reason}). Fetch the file again.") from error
    return parse_skeleton(text, file)


def _count(word: str, name: str, what: str) -> int:
    if not word.isdigit():
        raise DataError(
            f"{name}: {what} must be a whole number, but got {word[:20]!r}. Fetch the file again."
        )
    return int(word)


__all__ = ["HINT", "KINECT25", "RATE_HZ", "Body", "choose", "parse_skeleton", "read_ntu"]
