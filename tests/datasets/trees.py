"""Small data sets in UTD-MHAD's official layout, generated: smooth movements that differ by action."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

UTD = Path(__file__).parents[2].parent / "shared" / "data" / "utd_mhad"
needs_utd = pytest.mark.skipif(
    not (UTD / "Skeleton.zip").is_file(),
    reason="UTD-MHAD's Skeleton.zip is missing: put it into ../shared/data/utd_mhad to run this test",
)
needs_depth = pytest.mark.skipif(
    not (UTD / "Depth_56_clips.zip").is_file() or not (UTD / "Skeleton.zip").is_file(),
    reason="UTD-MHAD's Skeleton.zip and Depth_56_clips.zip are missing in ../shared/data/utd_mhad",
)


def standing() -> np.ndarray:
    """A person, Kinect-20, metres, Kinect frame (y up, z away), shape (20, 3)."""
    side = np.array(
        [[0.18, 0.25, 0], [0.24, 0.0, 0], [0.26, -0.22, 0], [0.27, -0.3, 0]]
    )  # shoulder, elbow, wrist, hand
    leg = np.array([[0.1, -0.2, 0], [0.11, -0.6, 0], [0.12, -1.0, 0], [0.12, -1.05, -0.1]])
    mirror = np.array([-1.0, 1.0, 1.0])
    middle = np.array([[0, 0.5, 0], [0, 0.3, 0], [0, 0.05, 0], [0, -0.1, 0]])
    # the person's left side is at -x in a Kinect's frame
    return np.vstack([middle, side * mirror, side, leg * mirror, leg]) + np.array([0.0, 0.2, 3.0])


def movement(action: int, subject: int, trial: int, frames: int = 24) -> np.ndarray:
    """A movement of the right (odd actions) or left arm, shape (20, 3, frames)."""
    rng = np.random.default_rng(1000 * action + 10 * subject + trial)
    phase = np.linspace(0, 2 * np.pi, frames)
    joints = np.repeat(standing()[:, :, None], frames, axis=2) * (1 + 0.02 * subject)
    arm = slice(9, 12) if action % 2 else slice(5, 8)
    direction = np.array([np.sin(action), np.cos(action), -0.5 * np.cos(2 * action)])
    swing = direction[:, None] * (0.3 * np.sin(phase * (1 + action % 3)) * (1 + 0.1 * rng.normal()))
    joints[arm] += swing
    return joints + rng.normal(0, 0.003, joints.shape)


def mat(variable: str, array: np.ndarray) -> bytes:
    file = io.BytesIO()
    savemat(file, {variable: array})
    return file.getvalue()


def tree(
    root: Path,
    actions: Iterable[int] = (1, 6),
    subjects: Iterable[int] = (1, 2),
    trials: Iterable[int] = (1, 2),
) -> Path:
    """Write ``Skeleton/*.mat`` below ``root`` and return ``root``."""
    folder = root / "Skeleton"
    folder.mkdir(parents=True)
    for a in actions:
        for s in subjects:
            for t in trials:
                (folder / f"a{a}_s{s}_t{t}_skeleton.mat").write_bytes(mat("d_skel", movement(a, s, t)))
    return root


def zipped(root: Path, target: Path) -> Path:
    """Zip ``root`` in the official layout."""
    with zipfile.ZipFile(target, "w") as archive:
        for path in sorted(root.rglob("*.mat")):
            archive.write(path, path.relative_to(root))
    return target
