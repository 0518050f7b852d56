"""Small files in the form of the Kinect sets' NumPy archives, generated."""

from pathlib import Path

import numpy as np
import pytest

from tests.datasets.trees import movement
from wigwag.datasets.msr_action3d import JOINTS
from wigwag.datasets.streams import KINECT_SDK
from wigwag.skeleton import KINECT20

SHARED = Path(__file__).parents[2].parent / "shared" / "data"


def needs(name: str) -> pytest.MarkDecorator:
    """Skip where a set of ``../shared/data`` is not there, and say which."""
    return pytest.mark.skipif(
        not any((SHARED / name).glob("*.npz")),
        reason=f"no .npz file in ../shared/data/{name}: put it there to run this test",
    )


def takes(
    actions=(1, 2), subjects=(1, 3), trials=(1, 2), frames=24
) -> dict[tuple[int, int, int], np.ndarray]:
    """Joints (frames, 20, 3) in KINECT20 order, metres, Kinect frame, by (action, subject, trial)."""
    return {
        (a, s, t): movement(a, s, t, frames).transpose(2, 0, 1)
        for a in actions
        for s in subjects
        for t in trials
    }


def msr_arrays(recorded: dict[tuple[int, int, int], np.ndarray]) -> dict[str, np.ndarray]:
    """As in msr_action3d*.npz; the joints stand in that set's own order."""
    order = [KINECT20.index(name) for name in JOINTS]
    action, subject, trial = np.array(list(recorded)).T
    return {
        "action": action.astype(np.int16),
        "subject": subject.astype(np.int16),
        "trial": trial.astype(np.int16),
        "offset": np.cumsum([0, *map(len, recorded.values())]),
        "frames": np.concatenate(list(recorded.values()))[:, order].astype(np.float32),
        "joint_names": np.array(JOINTS),
    }


def precog_arrays(recorded: dict[tuple[int, int, int], np.ndarray]) -> dict[str, np.ndarray]:
    """As in precog*.npz: the Kinect SDK's order, which the file does not name."""
    order = [KINECT20.index(name) for name in KINECT_SDK]
    sequence, subject, _ = np.array(list(recorded)).T
    return {
        "sequence": sequence.astype(np.int16),
        "subject": subject.astype(np.int16),
        "offset": np.cumsum([0, *map(len, recorded.values())]),
        "frames": np.concatenate(list(recorded.values()))[:, order].astype(np.float32),
    }


def saved(path: Path, arrays: dict[str, np.ndarray]) -> Path:
    np.savez(path, **arrays)
    return path
