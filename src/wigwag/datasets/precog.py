"""PRECOG: people who punch and kick before a Kinect; movements that are no command.

Jardim, 2016 (MIT licence): 12 people, 6 sequences each. wigwag carries none of the recordings.
"""

from __future__ import annotations

from pathlib import Path

from wigwag.datasets.loaded import Loaded
from wigwag.datasets.lost import bridged
from wigwag.datasets.streams import KINECT_SDK, load_streams
from wigwag.errors import DataError, InputError
from wigwag.skeleton import Clip

RATE_HZ = 30.0
"""Frames a second: the first Kinect's nominal rate; the files have no time stamps."""

HINT = "PRECOG's skeletons are expected as precog*.npz with 'frames', 'offset', 'sequence' and 'subject'."


def load_recordings(path: str | Path, rate_hz: float = RATE_HZ) -> Loaded:
    """Load every recording whole.

    Args:
        path: The ``.npz`` file, or the folder that holds it.
        rate_hz: Frames a second.

    Returns:
        Clips without a label, named ``"precog_q1_s01"``, of subject ``"precog_s01"``, metres, camera optical
        frame. A recording in which nobody is seen is left out with the reason.

    Raises:
        DataError: If there is no such file, it is damaged, or nothing of it can be used.
    """
    streams = load_streams(path, "precog*.npz", HINT, KINECT_SDK)
    loaded = Loaded([])
    columns = (streams.column(name).tolist() for name in ("sequence", "subject"))
    for i, (sequence, subject) in enumerate(zip(*columns, strict=True)):
        name = f"precog_q{sequence}_s{subject:02d}"
        try:
            joints, repair = bridged(streams.joints(i), rate_hz)
        except DataError as error:
            loaded.left_out.append((name, str(error)))
            continue
        loaded.clips.append(Clip.at_rate(joints, rate_hz, None, f"precog_s{subject:02d}", name))
        loaded.repaired.extend([(name, repair)] if repair else [])
    if not loaded.clips:
        raise DataError(f"{streams.path}: shows nobody in any of {len(streams)} recordings. {HINT}")
    return loaded


def load_background(
    path: str | Path, length_s: float = 2.5, step_s: float = 1.25, rate_hz: float = RATE_HZ
) -> Loaded:
    """Load the recordings cut into clips as long as a gesture: examples of what is none.

    Args:
        path: As for :func:`load_recordings`.
        length_s: How long a clip lasts, seconds.
        step_s: From one clip's start to the next one's, seconds.
        rate_hz: Frames a second.

    Returns:
        Clips without a label, named ``"precog_q1_s01_0"`` and on; what was left out as in
        :func:`load_recordings`. A recording shorter than ``length_s`` gives one clip.

    Raises:
        DataError: As :func:`load_recordings`.
        InputError: If a length is too short.
    """
    frames, step = round(length_s * rate_hz), round(step_s * rate_hz)
    if frames < 2 or step < 1:
        raise InputError(
            f"Clips of {length_s} s every {step_s} s are too short at {rate_hz} frames a second."
        )
    loaded = load_recordings(path, rate_hz)
    pieces = [
        Clip.at_rate(
            whole.joints[start : start + frames], rate_hz, None, whole.subject, f"{whole.name}_{number}"
        )
        for whole in loaded.clips
        for number, start in enumerate(range(0, max(len(whole) - frames, 0) + 1, step))
    ]
    return Loaded(pieces, loaded.left_out, loaded.repaired)


__all__ = ["HINT", "RATE_HZ", "load_background", "load_recordings"]
