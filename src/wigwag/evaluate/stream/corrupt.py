"""What goes wrong between a camera and a stream: poses lost, late, swapped, of others, or no numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from wigwag.datasets.recording import Recording
from wigwag.errors import InputError
from wigwag.skeleton import MIRROR, Pose

Corruption = Literal["missing", "jitter", "gap", "swapped", "stranger", "nan"]
"""missing: 30 % of the poses are not there; jitter: stamps are up to 20 ms wrong, so that time may run
backwards; gap: nothing for 2 s in the middle of every third gesture; swapped: left and right change places
for half a second, every 5 s on average; stranger: 10 frames show another person, every 10 s on average; nan:
a coordinate is no number in 5 % of the poses."""

CORRUPTIONS: tuple[Corruption, ...] = get_args(Corruption)

Poses = list[Pose]


def corrupted(recording: Recording, kind: Corruption, seed: int | Sequence[int] = 0) -> Poses:
    """Return the poses of a recording as a faulty chain delivers them.

    Args:
        recording: Its truth stays as it is.
        kind: What goes wrong.
        seed: Where it does.

    Raises:
        InputError: If there is no such kind.
    """
    if kind not in CORRUPTIONS:
        raise InputError(f"There is no corruption {kind!r}. Available: {', '.join(CORRUPTIONS)}.")
    visibility = np.ones(13)
    stream = recording.stream
    joints = np.asarray(stream.joints, dtype=np.float64)
    poses = [Pose(j, visibility, int(s)) for j, s in zip(joints, stream.stamps_ns, strict=True)]
    return _KINDS[kind](
        poses, recording, np.random.default_rng([CORRUPTIONS.index(kind), *np.atleast_1d(seed)])
    )


def _missing(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    return [pose for pose, lost in zip(poses, rng.random(len(poses)) < 0.3, strict=True) if not lost]


def _jitter(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    shift = np.round(rng.uniform(-20e6, 20e6, len(poses))).astype(int)
    return [replace(pose, stamp_ns=pose.stamp_ns + int(ns)) for pose, ns in zip(poses, shift, strict=True)]


def _gap(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    holes = [(m.onset_ns + m.end_ns) // 2 for m in recording.marks[int(rng.integers(3)) :: 3]]
    return [p for p in poses if not any(abs(p.stamp_ns - hole) <= 10**9 for hole in holes)]


def _swapped(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    result = list(poses)
    for first, last in _bursts(poses, rng, every_s=5.0, length_s=0.5):
        for i in range(first, last):
            result[i] = replace(poses[i], joints=poses[i].joints[list(MIRROR)])
    return result


def _stranger(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    """Show somebody of another size a metre beside, doing what was done some time before or after."""
    result = list(poses)
    rate_hz = len(poses) / max(recording.stream.duration_s, 1e-9)
    for first, _ in _bursts(poses, rng, every_s=10.0, length_s=10 / rate_hz):
        other = int(rng.integers(len(poses)))
        beside = np.array([rng.choice([-1.0, 1.0]), 0.0, rng.uniform(-0.5, 0.5)])
        for i in range(first, min(first + 10, len(poses))):
            shown = poses[(other + i - first) % len(poses)].joints
            size = 0.85 if first % 2 else 1.15
            middle = shown.mean(axis=0)
            result[i] = replace(poses[i], joints=(shown - middle) * size + middle + beside)
    return result


def _nan(poses: Poses, recording: Recording, rng: np.random.Generator) -> Poses:
    result = []
    for pose, bad in zip(poses, rng.random(len(poses)) < 0.05, strict=True):
        joints = pose.joints.copy()
        if bad:
            joints[int(rng.integers(13)), int(rng.integers(3))] = rng.choice([np.nan, np.inf])
        try:
            result.append(Pose(joints, pose.visibility, pose.stamp_ns))
        except InputError:
            continue  # no such pose can be made: whoever tries has none for this frame
    return result


def _bursts(poses: Poses, rng: np.random.Generator, every_s: float, length_s: float) -> list[tuple[int, int]]:
    """Choose stretches of poses, ``every_s`` on average."""
    if len(poses) < 2:
        return []
    duration_s = (poses[-1].stamp_ns - poses[0].stamp_ns) * 1e-9
    count = int(rng.poisson(duration_s / every_s))
    frames = max(round(length_s * len(poses) / max(duration_s, 1e-9)), 1)
    starts = np.sort(rng.integers(0, len(poses), count))
    return [(int(start), min(int(start) + frames, len(poses))) for start in starts]


_KINDS: dict[str, Callable[[Poses, Recording, np.random.Generator], Poses]] = {
    "missing": _missing, "jitter": _jitter, "gap": _gap, "swapped": _swapped, "stranger": _stranger,
    "nan": _nan,
}  # fmt: skip

__all__ = ["CORRUPTIONS", "Corruption", "corrupted"]
