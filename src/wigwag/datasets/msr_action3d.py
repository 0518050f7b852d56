"""MSR-Action3D: 20 actions, 10 people, up to 3 takes each, recorded by a depth camera like the Kinect.

Li, Zhang, Liu, "Action recognition based on a bag of 3D points", CVPR Workshops 2010. wigwag carries none of
the recordings.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from wigwag.datasets.archive import Archive, open_archive
from wigwag.datasets.loaded import Loaded
from wigwag.datasets.lost import bridged, seen
from wigwag.datasets.streams import Streams, load_streams
from wigwag.errors import DataError
from wigwag.skeleton import Clip, from_kinect20

ACTIONS: dict[str, str] = {
    "a01": "high arm wave", "a02": "horizontal arm wave", "a03": "hammer", "a04": "hand catch",
    "a05": "forward punch", "a06": "high throw", "a07": "draw x", "a08": "draw tick", "a09": "draw circle",
    "a10": "hand clap", "a11": "two hand wave", "a12": "side boxing", "a13": "bend", "a14": "forward kick",
    "a15": "side kick", "a16": "jogging", "a17": "tennis swing", "a18": "tennis serve", "a19": "golf swing",
    "a20": "pick up and throw",
}  # fmt: skip
"""Label to readable name, in the data set's own numbering."""

JOINTS: tuple[str, ...] = (
    "left_shoulder", "right_shoulder", "shoulder_center", "spine", "left_hip", "right_hip", "hip_center",
    "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hand", "right_hand", "left_knee",
    "right_knee", "left_ankle", "right_ankle", "left_foot", "right_foot", "head",
)  # fmt: skip
"""The joint order of the official text files."""

RATE_HZ = 15.0
"""Frames a second, as the set's authors state."""

HINT = (
    "MSR-Action3D comes from Li, Zhang, Liu 2010; give a file msr_action3d*.npz, or the folder or zip file "
    "of the official a01_s01_e01_skeleton3D.txt files (the real-world skeletons)."
)

Progress = Callable[[int, int], None]
"""Called with (recordings done, recordings in all) while the set loads."""

_TEXT = re.compile(r"a(\d\d)_s(\d\d)_e(\d\d)_skeleton3D\.txt")
_FOLDER = "MSRAction3DSkeletonReal3D"
_ZIPS = ("MSRAction3DSkeletonReal3D.zip",)

_CONSTANT_M = 0.005
"""A shank that differs by less from the length it mostly has in its clip has that length."""


def load_skeletons(
    path: str | Path,
    labels: Collection[str] | None = None,
    subjects: Collection[str] | None = None,
    rate_hz: float = RATE_HZ,
    progress: Progress | None = None,
) -> Loaded:
    """Load every recording as a :class:`Clip`; say what had to be left out and what was repaired.

    Frames without a person are cut off or bridged (:func:`wigwag.datasets.lost.bridged`), and knees that
    have changed places are put back (:func:`knees_in_place`).

    Args:
        path: An ``.npz`` file with ``action``, ``subject`` and ``trial`` a sequence (or its folder), or the
            folder or zip file of the official text files.
        labels: Only these actions, such as ``("a01", "a06")``; ``None``: all 20.
        subjects: Only these people, such as ``("s01", "s03")``; ``None``: all.
        rate_hz: Frames a second.
        progress: Called as ``progress(done, total)`` after each recording.

    Returns:
        Clips named ``"a01_s01_e01"``, labelled ``"a01"``, of subject ``"s01"``, in metres in the camera
        optical frame, sorted by action, subject and take.

    Raises:
        DataError: If there is no MSR-Action3D at ``path`` or nothing of it can be read.
    """
    path = Path(path)
    clips: list[Clip] = []
    left_out: list[tuple[str, str]] = []
    repaired: list[tuple[str, str]] = []
    for name, read, done, total in _recordings(path):
        label, subject, _ = name.split("_")
        if (labels is None or label in labels) and (subjects is None or subject in subjects):
            try:
                raw, names = read()
                joints, repair = _repair(raw, names, rate_hz)
                clips.append(Clip.at_rate(from_kinect20(joints, names), rate_hz, label, subject, name))
            except DataError as error:
                left_out.append((name, str(error)))
            else:
                repaired.extend([(name, repair)] if repair else [])
        if progress is not None:
            progress(done, total)
    if not clips:
        raise DataError(
            f"{path}: no usable recording for actions {labels or 'a01-a20'} and subjects "
            f"{subjects or 'all'}; {len(left_out)} left out, first: {left_out[:1]}. {HINT}"
        )
    return Loaded(clips, left_out, repaired)


def knees_in_place(
    joints: Float[np.ndarray, "frames 20 3"], names: tuple[str, ...] = JOINTS
) -> tuple[Float[np.ndarray, "frames 20 3"], int]:
    """Put knees back that carry each other's name, which happens in most frames of the second person.

    The recorder's body model keeps a shank's length constant within a recording, left and right alike. In a
    frame whose knees are named the wrong way round the two 'shanks' run across the body and are longer or
    shorter; named the right way round they have the length that they have in all other frames. A
    recording without such a constant length is left alone unless thighs and shanks alike get shorter.

    Args:
        joints: Metres, any frame of reference.
        names: Joint order.

    Returns:
        The joints, and in how many frames the knees were exchanged.
    """
    left_knee, right_knee = names.index("left_knee"), names.index("right_knee")
    wrong = _knees_wrong(joints, names) & seen(joints)
    if not wrong.any():
        return joints, 0
    result = joints.copy()
    result[wrong, left_knee], result[wrong, right_knee] = joints[wrong, right_knee], joints[wrong, left_knee]
    return result, int(wrong.sum())


def _knees_wrong(
    joints: Float[np.ndarray, "frames 20 3"], names: tuple[str, ...]
) -> Bool[np.ndarray, " frames"]:
    def bones(upper: str, lower: str, crossed: bool) -> Float[np.ndarray, "frames 2"]:
        sides = (("left", "right"), ("right", "left")) if crossed else (("left", "left"), ("right", "right"))
        pairs = [(names.index(f"{a}_{upper}"), names.index(f"{b}_{lower}")) for a, b in sides]
        return np.stack([np.linalg.norm(joints[:, a] - joints[:, b], axis=1) for a, b in pairs], axis=1)

    straight, crossed = bones("knee", "ankle", False), bones("knee", "ankle", True)
    length = _constant(np.concatenate([straight, crossed])[np.tile(seen(joints), 2)])
    if length is not None:
        as_named, exchanged = (np.abs(s - length).max(axis=1) for s in (straight, crossed))
        return np.asarray((exchanged < _CONSTANT_M) & (as_named > _CONSTANT_M) & (exchanged < as_named))
    thighs = bones("hip", "knee", False).sum(axis=1) - bones("hip", "knee", True).sum(axis=1)
    return np.asarray((thighs > 0) & (straight.sum(axis=1) > crossed.sum(axis=1)))


def _constant(lengths: Float[np.ndarray, "pairs 2"]) -> float | None:
    """Return the length that both shanks have in half of the frames or more; None if there is none.

    Each frame comes twice: with its knees as they are named, and exchanged.
    """
    pairs = lengths[np.abs(lengths[:, 0] - lengths[:, 1]) < _CONSTANT_M].mean(axis=1)
    if len(pairs) == 0:
        return None
    ordered = np.sort(pairs)
    # The window of the constant's width that holds the most lengths.
    inside = np.searchsorted(ordered, ordered + _CONSTANT_M, side="right") - np.arange(len(ordered))
    first = int(np.argmax(inside))
    if inside[first] < len(lengths) / 4:
        return None
    return float(np.median(ordered[first : first + inside[first]]))


def _repair(
    raw: Float[np.ndarray, "frames 20 3"], names: tuple[str, ...], rate_hz: float
) -> tuple[Float[np.ndarray, "frames 20 3"], str]:
    joints, exchanged = knees_in_place(raw, names)
    joints, filled = bridged(joints, rate_hz)
    knees = f"knees exchanged in {exchanged} of {len(raw)} frames" if exchanged else ""
    return joints, ", ".join(part for part in (knees, filled) if part)


_Read = Callable[[], tuple[Float[np.ndarray, "frames 20 3"], tuple[str, ...]]]


def _recordings(path: Path) -> Iterator[tuple[str, _Read, int, int]]:
    """Yield each recording's name, how to read it, and (done, total), in the order of the names."""
    if path.suffix == ".npz" or (path.is_dir() and any(path.glob("msr_action3d*.npz"))):
        streams = load_streams(path, "msr_action3d*.npz", HINT)
        columns = [streams.column(name).tolist() for name in ("action", "subject", "trial")]
        names = [f"a{a:02d}_s{s:02d}_e{e:02d}" for a, s, e in zip(*columns, strict=True)]
        order = sorted(range(len(names)), key=names.__getitem__)
        for done, i in enumerate(order, start=1):
            yield names[i], partial(_row, streams, i), done, len(order)
        return
    with open_archive(path, _FOLDER, _ZIPS, _TEXT, HINT) as archive:
        files = sorted(archive.files)
        for done, file in enumerate(files, start=1):
            name = file.removesuffix("_skeleton3D.txt")
            yield name, partial(_file, archive, file), done, len(files)


def _row(streams: Streams, sequence: int) -> tuple[np.ndarray, tuple[str, ...]]:
    return streams.raw(sequence), streams.joint_names


def _file(archive: Archive, file: str) -> tuple[np.ndarray, tuple[str, ...]]:
    return _text(archive.read(file)), JOINTS


def _text(content: bytes) -> Float[np.ndarray, "frames 20 3"]:
    """Read the lines ``x y z confidence``, 20 a frame."""
    try:
        rows = np.array(
            [line.split() for line in content.decode("ascii").splitlines() if line.strip()], float
        )
    except ValueError as error:
        raise DataError(f"is no table of numbers ({error})") from error
    if rows.ndim != 2 or rows.shape[1] < 3 or len(rows) % len(JOINTS) or len(rows) < 2 * len(JOINTS):
        raise DataError(
            f"must hold 'x y z confidence' a line, 20 lines a frame, but its shape is {rows.shape}"
        )
    return np.asarray(rows[:, :3].reshape(-1, len(JOINTS), 3))


__all__ = ["ACTIONS", "HINT", "JOINTS", "RATE_HZ", "knees_in_place", "load_skeletons"]
