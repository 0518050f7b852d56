"""MSRC-12: 12 gestures shown again and again by 30 people before a Kinect, as streams with action points.

Fothergill, Mentis, Kohli, Nowozin, "Instructing People for Training Gestural Interactive Systems", CHI 2012.
A recording is one long stream; its truth are action points: moments at which it is clear what is shown.
wigwag carries none of the recordings.
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

GESTURES: dict[str, str] = {
    "g1": "lift outstretched arms", "g2": "duck", "g3": "push right", "g4": "goggles", "g5": "wind it up",
    "g6": "shoot", "g7": "bow", "g8": "throw", "g9": "had enough", "g10": "change weapon",
    "g11": "beat both", "g12": "kick",
}  # fmt: skip
"""Label to readable name, in the data set's own numbering."""

SIDED: tuple[str, ...] = ("g3",)
"""Gestures that a mirror makes another one of, by their names: "push right". Who throws or kicks may do so
with either side."""

RATE_HZ = 30.0
"""Frames a second at the median; time stamps are irregular by some milliseconds and have holes of seconds."""

HINT = (
    "MSRC-12 comes from Microsoft Research Cambridge (Fothergill et al. 2012); give a file msrc12*.npz, or "
    "the folder MicrosoftGestureDataset-RC (or its data/, or its zip file) with P1_1_1_p06.csv, .tagstream."
)

Progress = Callable[[int, int], None]
"""Called with (recordings done, recordings in all) while the set loads."""

_NAME = re.compile(r"P(\d)_(\d)_(\d+)(A?)_p(\d+)")
_FILE = re.compile(r"P\d_\d_\d+A?_p\d+\.(csv|tagstream)", re.IGNORECASE)
_TICKS_PER_MS = 49_875
"""Ticks of the tag files in a millisecond of the skeleton files' clock: the console's performance counter."""

_Raw = tuple[Float[np.ndarray, "frames 20 3"], Int[np.ndarray, " frames"], list[tuple[str, int]], int]
"""Metres, Kinect frame; microseconds; tags of (label, microseconds); how many tags made no sense."""

_Read = Callable[[], _Raw]


def load_recordings(
    path: str | Path,
    labels: Collection[str] | None = None,
    subjects: Collection[str] | None = None,
    progress: Progress | None = None,
) -> Recordings:
    """Load every stream with its action points.

    Frames without a person (all zero) are left out, so that a stream has holes where nobody was seen; so are
    frames whose stamp is not after the one before.

    Args:
        path: An ``.npz`` file (or its folder), the folder of the official ``.csv`` and ``.tagstream`` files,
            or their zip file.
        labels: Only recordings of these gestures, such as ``("g1", "g6")``; ``None``: all.
        subjects: Only these people, such as ``("msrc12_p06",)``; ``None``: all.
        progress: Called as ``progress(done, total)`` after each recording.

    Returns:
        Streams named as the files, such as ``"P1_1_10_p06"``, of subject ``"msrc12_p06"``, in metres in the
        camera optical frame, their first stamp 0; marks without length, labelled ``"g1"`` to ``"g12"``, at
        the action points. What could not be used is named with the reason; a tag outside of its stream too.

    Raises:
        DataError: If there is no MSRC-12 at ``path`` or nothing of it can be read.
    """
    loaded = Recordings([])
    for name, read, done, total in _recordings(Path(path)):
        found = _NAME.fullmatch(name)
        assert found is not None  # only such names are listed
        label, subject = f"g{int(found[3])}", f"msrc12_p{int(found[5]):02d}"
        if (labels is None or label in labels) and (subjects is None or subject in subjects):
            try:
                _take(loaded, name, subject, read())
            except DataError as error:
                loaded.left_out.append((name, str(error)))
        if progress is not None:
            progress(done, total)
    if not loaded.recordings:
        raise DataError(
            f"{path}: no usable recording of {labels or 'g1-g12'} by {subjects or 'anyone'}; "
            f"{len(loaded.left_out)} left out, first: {loaded.left_out[:1]}. {HINT}"
        )
    return loaded


def _take(loaded: Recordings, name: str, subject: str, raw: _Raw) -> None:
    """Clean one recording and add it."""
    joints, stamps_us, tags, strange = raw
    there = seen(joints)
    latest = np.maximum.accumulate(np.concatenate([[np.iinfo(np.int64).min], stamps_us[:-1]]))
    forward = stamps_us > latest
    keep = there & forward
    if keep.sum() < 2:
        raise DataError(f"the person is seen in {int(keep.sum())} of {len(joints)} frames only")
    begin = int(stamps_us[keep][0])
    end = int(stamps_us[keep][-1])
    inside = [(label, tag) for label, tag in tags if begin - 500_000 <= tag <= end + 500_000]
    clip = Clip(
        from_kinect20(joints[keep], KINECT_SDK), (stamps_us[keep] - begin) * 1000, None, subject, name
    )
    points = sorted((max(tag - begin, 0) * 1000, label) for label, tag in inside)
    loaded.recordings.append(Recording(clip, tuple(Mark(label, at, at) for at, label in points)))
    said = []
    if lost := int((~there).sum()):
        said.append(f"{lost} frames without a person left out")
    if back := int((there & ~forward).sum()):
        said.append(f"{back} frames that run back in time left out")
    if said:
        loaded.repaired.append((name, ", ".join(said)))
    if outside := len(tags) - len(inside) + strange:
        loaded.left_out.append((f"{name}: {outside} tag(s)", "not within the stream, or of no known gesture"))


def _recordings(path: Path) -> Iterator[tuple[str, _Read, int, int]]:
    """Yield each recording's name, how to read it, and (done, total), in the order of the names."""
    if path.suffix == ".npz" or (path.is_dir() and any(path.glob("msrc12*.npz"))):
        streams = load_streams(path, "msrc12*.npz", HINT)
        names = [str(name) for name in streams.column("name")]
        usable = sorted((i for i, n in enumerate(names) if _NAME.fullmatch(n)), key=names.__getitem__)
        for done, i in enumerate(usable, start=1):
            yield names[i], partial(_row, streams, i), done, len(usable)
        return
    if path.is_dir() and not any(path.glob("P*.csv")):
        path = next((p for p in (path / "data", path / _FOLDER / "data", path / _FOLDER) if p.is_dir()), path)
    with open_archive(path, "data", _ZIPS, _FILE, HINT) as archive:
        names = sorted(file.removesuffix(".csv") for file in archive.files if file.endswith(".csv"))
        if not names:
            raise DataError(f"{path}: holds tag files but no P*_p*.csv. {HINT}")
        for done, name in enumerate(names, start=1):
            yield name, partial(_file, archive, name), done, len(names)


_FOLDER = "MicrosoftGestureDataset-RC"
_ZIPS = ("MicrosoftGestureDataset-RC.zip",)


def _row(streams: Streams, i: int) -> _Raw:
    order = [streams.joint_names.index(name) for name in KINECT_SDK]
    stamps = streams.column("timestamp_us", len(streams.frames))
    stamps = np.asarray(stamps[streams.offset[i] : streams.offset[i + 1]], dtype=np.int64)
    events = streams.columns.get("events")
    if events is None or events.ndim != 2 or events.shape[1] != 3:
        raise DataError("the file has no array 'events' of (sequence, gesture, row)")
    mine = events[events[:, 0] == i]
    good = mine[(mine[:, 2] >= 0) & (mine[:, 2] < len(stamps)) & (mine[:, 1] >= 1) & (mine[:, 1] <= 12)]
    tags = [(f"g{int(gesture)}", int(stamps[row])) for _, gesture, row in good]
    return streams.raw(i)[:, order], stamps, tags, len(mine) - len(good)


def _file(archive: Archive, name: str) -> _Raw:
    """Read the official form: stamp and 20 x (x y z w) a line; and ``tick;G1 lift ...`` a line."""
    try:
        table = np.array(
            [line.split() for line in archive.read(f"{name}.csv").splitlines() if line.strip()], float
        )
    except ValueError as error:
        raise DataError(f"{name}.csv is no table of numbers ({error})") from error
    if table.ndim != 2 or table.shape[1] != 81 or len(table) < 2:
        raise DataError(
            f"{name}.csv must hold a stamp and 20 times x y z w a line, but its shape is {table.shape}"
        )
    if not np.isfinite(table[:, 0]).all():
        raise DataError(f"{name}.csv has a stamp that is no number")
    joints = table[:, 1:].reshape(len(table), 20, 4)[..., :3]
    tags, strange = _tags(archive.read(f"{name}.tagstream"))
    return joints, table[:, 0].astype(np.int64), tags, strange


def _tags(content: bytes) -> tuple[list[tuple[str, int]], int]:
    """Return (label, microseconds) of each line after the header, and how many lines could not be used."""
    tags, strange = [], 0
    for line in content.decode("utf-8-sig", "replace").splitlines()[1:]:
        if not line.strip():
            continue
        found = re.fullmatch(r"\s*(\d+)\s*;\s*G(\d+)\b.*", line)
        if found is None or not 1 <= int(found[2]) <= 12:
            strange += 1
            continue
        ticks = int(found[1])
        tags.append((f"g{int(found[2])}", (ticks * 1000 + _TICKS_PER_MS // 2) // _TICKS_PER_MS))
    return tags, strange


__all__ = ["GESTURES", "HINT", "RATE_HZ", "SIDED", "load_recordings"]
