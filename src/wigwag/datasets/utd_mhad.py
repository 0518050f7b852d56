"""UTD-MHAD: 27 actions, 8 people, up to 4 trials each, recorded by a Kinect.

Chen, Jafari, Kehtarnavaz, "UTD-MHAD: A Multimodal Dataset for Human Action Recognition Utilizing a
Depth Camera and a Wearable Inertial Sensor", ICIP 2015. The owners ask for a citation; wigwag carries
none of the recordings.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt16

from wigwag.camera.frame import Intrinsics
from wigwag.datasets.archive import Archive, open_archive, read_mat
from wigwag.datasets.loaded import Loaded
from wigwag.errors import DataError
from wigwag.skeleton import Clip, from_kinect20

ACTIONS: dict[str, str] = {
    "a1": "swipe left", "a2": "swipe right", "a3": "wave", "a4": "clap", "a5": "throw",
    "a6": "cross arms", "a7": "basketball shoot", "a8": "draw x", "a9": "draw circle clockwise",
    "a10": "draw circle counter-clockwise", "a11": "draw triangle", "a12": "bowling", "a13": "boxing",
    "a14": "baseball swing", "a15": "tennis swing", "a16": "arm curl", "a17": "tennis serve",
    "a18": "push", "a19": "knock", "a20": "catch", "a21": "pick up and throw", "a22": "jog",
    "a23": "walk", "a24": "sit to stand", "a25": "stand to sit", "a26": "lunge", "a27": "squat",
}  # fmt: skip
"""Label to readable name, in the data set's own numbering (the paper calls a27 a lunge)."""

SUBJECTS: tuple[str, ...] = tuple(f"s{i}" for i in range(1, 9))
"""The eight people."""

RATE_HZ = 18.75
"""Frames a second: 18.5-19 judged by the inertial stream recorded beside it, not the nominal 30."""

KNOWN_MISSING: frozenset[str] = frozenset({"a8_s1_t4", "a23_s6_t4", "a27_s8_t4"})
"""The only recordings that the published set lacks."""

DEPTH_INTRINSICS = Intrinsics(fx=276.0, fy=276.0, cx=161.0, cy=117.0, width=320, height=240)
"""Of the depth pictures once turned the right way round (:func:`load_depth` does), fitted on the data."""

DEPTH_DELAY_FRAMES = 2
"""Depth frame t shows what skeleton frame t - 2 says: the two streams are not synchronous."""

HINT = (
    "UTD-MHAD comes from the University of Texas at Dallas (look for 'UTD-MHAD', Chen et al. 2015); give "
    "the folder that holds Skeleton.zip, the zip file, or a folder with Skeleton/a1_s1_t1_skeleton.mat."
)
_DEPTH_HINT = (
    "The depth part of UTD-MHAD is expected as Depth_56_clips.zip, Depth.zip or Depth/a1_s1_t1_depth.mat."
)

Progress = Callable[[int, int], None]
"""Called with (files done, files in all) while a set loads."""


@dataclass(frozen=True, slots=True)
class DepthClip:
    """One depth recording, turned so that it fits the camera optical frame and ``DEPTH_INTRINSICS``."""

    depth_mm: UInt16[np.ndarray, "frames 240 320"]
    """Millimetres along the optical axis; 0 is a hole or the background, which the set's owners removed."""
    label: str
    """``"a1"`` to ``"a27"``."""
    subject: str
    """``"s1"`` to ``"s8"``."""
    name: str
    """Such as ``"a1_s1_t1"``."""

    def __len__(self) -> int:
        return len(self.depth_mm)


def load_skeletons(
    path: str | Path,
    labels: Collection[str] | None = None,
    subjects: Collection[str] | None = None,
    rate_hz: float = RATE_HZ,
    progress: Progress | None = None,
) -> Loaded:
    """Load every skeleton recording as a :class:`Clip` and say what had to be left out.

    Args:
        path: The folder that holds ``Skeleton.zip``, the zip file, or a folder with ``Skeleton/*.mat``.
        labels: Only these actions, such as ``("a1", "a6")``; ``None``: all 27.
        subjects: Only these people, such as ``("s1", "s3")``; ``None``: all eight.
        rate_hz: Frames a second.
        progress: Called as ``progress(done, total)`` after each file.

    Returns:
        Clips named ``"a1_s1_t1"``, labelled ``"a1"``, of subject ``"s1"``, in metres in the camera optical
        frame, sorted by action, subject and trial. A recording that is missing (beyond the three that the
        published set lacks), corrupt or irregular is left out by name with the reason.

    Raises:
        DataError: If there is no UTD-MHAD at ``path`` or nothing of it can be read.
    """
    clips: list[Clip] = []
    left_out: list[tuple[str, str]] = []
    with _open(path, "skeleton") as archive:
        names, strange = _sorted_names(archive, "skeleton")
        left_out.extend((n, "has a name that is not UTD-MHAD's (a1-a27, s1-s8, t1-t4)") for n in strange)
        wanted = [n for n in _all_names() if _wanted(n, labels, subjects)]
        for done, name in enumerate(wanted, start=1):
            if name in names:
                try:
                    clips.append(_clip(archive, name, rate_hz))
                except DataError as error:
                    left_out.append((_file(name, "skeleton"), _reason(error, _file(name, "skeleton"))))
            elif name not in KNOWN_MISSING:
                left_out.append((_file(name, "skeleton"), "missing"))
            if progress is not None:
                progress(done, len(wanted))
        if not clips:
            raise DataError(
                f"{archive.path}: no usable recording for actions {labels or 'a1-a27'} and subjects "
                f"{subjects or 's1-s8'}; {len(left_out)} left out, first: {left_out[:1]}. {HINT}"
            )
    return Loaded(clips, left_out)


def load_skeleton(path: str | Path, name: str, rate_hz: float = RATE_HZ) -> Clip:
    """Load one recording, such as ``"a1_s1_t1"``, as a :class:`Clip`.

    Raises:
        DataError: If it is missing, corrupt or irregular; the message names the file.
    """
    with _open(path, "skeleton") as archive:
        return _clip(archive, name, rate_hz)


def load_raw20(path: str | Path, name: str) -> Float[np.ndarray, "frames 20 3"]:
    """Load one recording's 20 Kinect joints, in the order of :data:`wigwag.skeleton.KINECT20`.

    Returns:
        Metres, Kinect frame: y up, z away from the camera, the person's right side at +x.

    Raises:
        DataError: If it is missing, corrupt or irregular; the message names the file.
    """
    with _open(path, "skeleton") as archive:
        return _raw20(archive, name)


def load_depth(
    path: str | Path,
    labels: Collection[str] | None = None,
    subjects: Collection[str] | None = None,
    left_out: list[tuple[str, str]] | None = None,
) -> Iterator[DepthClip]:
    """Yield the depth recordings one by one, sorted by action, subject and trial.

    The set's pictures are mirrored; what is yielded is turned back, so that
    ``DEPTH_INTRINSICS.project(clip.joints[t - DEPTH_DELAY_FRAMES])`` lands on the person in frame ``t``.

    Args:
        path: The folder that holds ``Depth_56_clips.zip``, a zip file, or a folder with ``Depth/*.mat``.
        labels: Only these actions.
        subjects: Only these people.
        left_out: Gets ``(file, reason)`` of each recording that cannot be read, if given.

    Raises:
        DataError: If there is no depth at ``path``, or a recording is corrupt and ``left_out`` is not given.
    """
    with _open(path, "depth") as archive:
        names, _ = _sorted_names(archive, "depth")
        for name in [n for n in names if _wanted(n, labels, subjects)]:
            try:
                yield _depth(archive, name)
            except DataError as error:
                if left_out is None:
                    raise
                left_out.append((_file(name, "depth"), _reason(error, _file(name, "depth"))))


_NAME = re.compile(r"a([1-9]|1\d|2[0-7])_s([1-8])_t([1-4])")


def _open(path: str | Path, kind: str) -> AbstractContextManager[Archive]:
    pattern = re.compile(rf".+_{kind}\.mat")
    if kind == "skeleton":
        return open_archive(path, "Skeleton", ("Skeleton.zip",), pattern, HINT)
    return open_archive(path, "Depth", ("Depth_56_clips.zip", "Depth.zip"), pattern, _DEPTH_HINT)


def _all_names() -> list[str]:
    return [f"{a}_{s}_t{t}" for a in ACTIONS for s in SUBJECTS for t in range(1, 5)]


def _sorted_names(archive: Archive, kind: str) -> tuple[dict[str, None], list[str]]:
    """Return the official recording names that are there, in order, and the strange file names."""
    stems = {f.removesuffix(f"_{kind}.mat") for f in archive.files}
    return dict.fromkeys(n for n in _all_names() if n in stems), sorted(
        _file(s, kind) for s in stems if not _NAME.fullmatch(s)
    )


def _wanted(name: str, labels: Collection[str] | None, subjects: Collection[str] | None) -> bool:
    action, subject, _ = name.split("_")
    return (labels is None or action in labels) and (subjects is None or subject in subjects)


def _file(name: str, kind: str) -> str:
    return f"{name}_{kind}.mat"


def _reason(error: DataError, file: str) -> str:
    """Strip the file's name off a message that stands beside that name anyway."""
    return str(error).removeprefix(f"{file}: ")


def _raw20(archive: Archive, name: str) -> Float[np.ndarray, "frames 20 3"]:
    file = _file(name, "skeleton")
    raw = read_mat(archive.read(file), "d_skel", file)
    if raw.ndim == 2 and raw.shape[1] == 3:
        raw = raw[:, :, None]  # MATLAB drops a last axis of length one
    if raw.ndim != 3 or raw.shape[:2] != (20, 3):
        raise DataError(f"{file}: d_skel must have shape (20, 3, frames), but got {raw.shape}.")
    if raw.shape[2] < 2:
        raise DataError(f"{file}: a clip needs at least 2 frames, but got {raw.shape[2]}.")
    if not np.isfinite(raw).all():
        bad = int(np.argmin(np.isfinite(raw).all(axis=(0, 1))))
        raise DataError(f"{file}: d_skel holds NaN or infinity, first in frame {bad}; metres are expected.")
    return np.ascontiguousarray(raw.transpose(2, 0, 1), dtype=np.float64)


def _clip(archive: Archive, name: str, rate_hz: float) -> Clip:
    raw = _raw20(archive, name)
    action, subject, _ = name.split("_")
    return Clip.at_rate(from_kinect20(raw), rate_hz, action, subject, name)


def _depth(archive: Archive, name: str) -> DepthClip:
    file = _file(name, "depth")
    raw = read_mat(archive.read(file), "d_depth", file)
    size = (DEPTH_INTRINSICS.height, DEPTH_INTRINSICS.width)
    if raw.ndim != 3 or raw.shape[:2] != size or raw.shape[2] < 2 or raw.dtype != np.uint16:
        raise DataError(
            f"{file}: d_depth must be uint16 with shape (240, 320, frames) and at least 2 frames, "
            f"but got {raw.dtype} {raw.shape}."
        )
    action, subject, _ = name.split("_")
    return DepthClip(np.ascontiguousarray(raw.transpose(2, 0, 1)[:, :, ::-1]), action, subject, name)


__all__ = [
    "ACTIONS", "DEPTH_DELAY_FRAMES", "DEPTH_INTRINSICS", "HINT", "KNOWN_MISSING", "RATE_HZ", "SUBJECTS",
    "DepthClip", "load_depth", "load_raw20", "load_skeleton", "load_skeletons",
]  # fmt: skip
