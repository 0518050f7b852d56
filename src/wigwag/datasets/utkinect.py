"""UTKinect-Action3D: 10 everyday actions, one after the other, by 10 people, twice each, before a Kinect.

Xia, Chen, Aggarwal, "View Invariant Human Action Recognition Using Histograms of 3D Joints", CVPR Workshops
2012. wigwag carries none of the recordings.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from wigwag.datasets.archive import Archive, open_archive
from wigwag.datasets.lost import seen
from wigwag.datasets.recording import Mark, Recording, Recordings
from wigwag.datasets.streams import KINECT_SDK, Streams, load_streams
from wigwag.errors import DataError
from wigwag.skeleton import Clip, from_kinect20

ACTIONS: tuple[str, ...] = (
    "walk", "sitDown", "standUp", "pickUp", "carry", "throw", "push", "pull", "waveHands", "clapHands",
)  # fmt: skip
"""As the set names them."""

COUNTS_HZ = 60.0
"""How fast the frame numbers count, judged by people's steps: they walk at 0.8 m/s, 1.6 steps a second, then.
At 30 it would be half of both. Mostly every fourth to sixth number is there: 10 to 15 poses a second."""

HINT = (
    "UTKinect-Action3D comes from the University of Texas at Austin (Xia et al. 2012); give a file "
    "utkinect*.npz, or the folder or zip file with joints/joints_s01_e01.txt and actionLabel.txt."
)

Progress = Callable[[int, int], None]
"""Called with (recordings done, recordings in all) while the set loads."""

_FILE = re.compile(r"joints_s(\d\d)_e(\d\d)\.txt")
_LABELS = "actionLabel.txt"

_Segments = list[tuple[str, float, float]]
_Raw = tuple[Float[np.ndarray, "frames 20 3"], Int[np.ndarray, " frames"], _Segments]
"""Metres, Kinect frame; frame numbers; actions with their first and last frame number."""

_Read = Callable[[], _Raw]


def load_recordings(
    path: str | Path, subjects: Collection[str] | None = None, progress: Progress | None = None
) -> Recordings:
    """Load every stream with its actions.

    Frames without a person, or whose number is not above the one before, are left out. An action that was not
    recorded (``NaN`` in the official file), or that ends before it starts, is named and left out; its frames
    stay in the stream.

    Args:
        path: An ``.npz`` file (or its folder), or the folder or zip file of the official text files.
        subjects: Only these people, such as ``("utkinect_s01",)``; ``None``: all.
        progress: Called as ``progress(done, total)`` after each recording.

    Returns:
        Streams named ``"utkinect_s01_e01"`` of subject ``"utkinect_s01"``, in metres in the camera optical
        frame, their first stamp 0. Their actions are scenes, such as ``"walk"``, not marks: nobody commands.

    Raises:
        DataError: If there is no UTKinect at ``path`` or nothing of it can be read.
    """
    loaded = Recordings([])
    for name, read, done, total in _recordings(Path(path)):
        subject = name[: len("utkinect_s01")]
        if subjects is None or subject in subjects:
            try:
                _take(loaded, name, subject, read())
            except DataError as error:
                loaded.left_out.append((name, str(error)))
        if progress is not None:
            progress(done, total)
    if not loaded.recordings:
        raise DataError(
            f"{path}: no usable recording of {subjects or 'anyone'}; {len(loaded.left_out)} left out, "
            f"first: {loaded.left_out[:1]}. {HINT}"
        )
    return loaded


def _take(loaded: Recordings, name: str, subject: str, raw: _Raw) -> None:
    """Clean one recording and add it."""
    joints, numbers, segments = raw
    there = seen(joints)
    latest = np.maximum.accumulate(np.concatenate([[np.iinfo(np.int64).min], numbers[:-1]]))
    keep = there & (numbers > latest)
    if keep.sum() < 2:
        raise DataError(f"the person is seen in {int(keep.sum())} of {len(joints)} frames only")
    begin = int(numbers[keep][0])
    stamps = np.round((numbers[keep] - begin) * (1e9 / COUNTS_HZ)).astype(np.int64)
    scenes = []
    for action, first, last in segments:
        if not np.isfinite([first, last]).all():
            loaded.left_out.append((f"{name}: {action}", "not recorded"))
        elif last <= first:
            loaded.left_out.append(
                (f"{name}: {action}", f"ends at frame {last:g}, before it starts at {first:g}")
            )
        elif last < begin or first > numbers[keep][-1]:
            loaded.left_out.append((f"{name}: {action}", "lies outside of the stream"))
        else:
            onset, end = (round((max(at, begin) - begin) * 1e9 / COUNTS_HZ) for at in (first, last))
            scenes.append(Mark(action, onset, end))
    clip = Clip(from_kinect20(joints[keep], KINECT_SDK), stamps, None, subject, name)
    loaded.recordings.append(Recording(clip, (), tuple(sorted(scenes, key=lambda s: s.onset_ns))))
    if dropped := len(joints) - int(keep.sum()):
        loaded.repaired.append((name, f"{dropped} frames without a person or repeated left out"))


def _recordings(path: Path) -> Iterator[tuple[str, _Read, int, int]]:
    """Yield each recording's name, how to read it, and (done, total), in the order of the names."""
    if path.suffix == ".npz" or (path.is_dir() and any(path.glob("utkinect*.npz"))):
        streams = load_streams(path, "utkinect*.npz", HINT)
        columns = [streams.column(name).tolist() for name in ("subject", "episode")]
        names = [f"utkinect_s{s:02d}_e{e:02d}" for s, e in zip(*columns, strict=True)]
        order = sorted(range(len(names)), key=names.__getitem__)
        for done, i in enumerate(order, start=1):
            yield names[i], partial(_row, streams, i), done, len(order)
        return
    labels = _labels(path)
    with open_archive(path, "joints", ("joints.zip", "UTKinect.zip"), _FILE, HINT) as archive:
        files = sorted(archive.files)
        for done, file in enumerate(files, start=1):
            name = f"utkinect_{file.removeprefix('joints_').removesuffix('.txt')}"
            yield name, partial(_file, archive, file, labels), done, len(files)


def _row(streams: Streams, i: int) -> _Raw:
    order = [streams.joint_names.index(name) for name in KINECT_SDK]
    numbers = streams.column("frame_index", len(streams.frames))[streams.offset[i] : streams.offset[i + 1]]
    segments, names = streams.columns.get("segments"), streams.columns.get("action_names")
    if segments is None or names is None or segments.ndim != 2 or segments.shape[1] < 4:
        raise DataError("the file has no arrays 'segments' and 'action_names'")
    mine = segments[segments[:, 0] == i]
    listed: _Segments = [(str(names[int(a)]), float(b), float(e)) for _, a, b, e in mine[:, :4]]
    return streams.raw(i)[:, order], np.asarray(numbers, dtype=np.int64), listed


def _labels(path: Path) -> dict[str, _Segments]:
    """Read ``actionLabel.txt``, beside the joints or within the zip: ``s01_e01``, then ``walk: 252 390``."""
    folder = path if path.is_dir() else path.parent
    places = [folder / _LABELS, folder.parent / _LABELS]
    file = next((place for place in places if place.is_file()), None)
    if file is not None:
        text = file.read_text("utf-8", "replace")
    elif path.is_file():
        with open_archive(path, "joints", (), re.compile(re.escape(_LABELS)), HINT) as archive:
            text = archive.read(_LABELS).decode("utf-8", "replace")
    else:
        raise DataError(f"{path}: holds no {_LABELS}. {HINT}")
    labels: dict[str, _Segments] = {}
    block: _Segments = []
    for line in text.splitlines():
        if found := re.fullmatch(r"\s*s(\d+)_e(\d+)\s*", line):
            block = labels.setdefault(f"s{int(found[1]):02d}_e{int(found[2]):02d}", [])
        elif found := re.fullmatch(r"\s*(\w+)\s*:\s*(\d+|NaN)\s+(\d+|NaN)\s*", line):
            block.append((found[1], float(found[2]), float(found[3])))
    return labels


def _file(archive: Archive, file: str, labels: dict[str, _Segments]) -> _Raw:
    """Read the official form: a frame number and 20 times x y z a line."""
    rows = [line.split() for line in archive.read(file).splitlines() if line.strip()]
    try:
        table = np.array(rows, float)
    except ValueError as error:
        raise DataError(f"is no table of numbers ({error})") from error
    if table.ndim != 2 or table.shape[1] != 61 or len(table) < 2:
        raise DataError(f"must hold a frame number and 20 times x y z a line, but its shape is {table.shape}")
    if not np.isfinite(table[:, 0]).all():
        raise DataError("has a frame number that is none")
    key = file.removeprefix("joints_").removesuffix(".txt")
    if key not in labels:
        raise DataError(f"{_LABELS} has no actions of {key}")
    return table[:, 1:].reshape(len(table), 20, 3), table[:, 0].astype(np.int64), labels[key]


__all__ = ["ACTIONS", "COUNTS_HZ", "HINT", "load_recordings"]
