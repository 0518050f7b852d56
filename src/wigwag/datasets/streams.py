"""Sets of skeleton sequences in one NumPy file: all frames in one array, an offset a sequence.

``offset[i]:offset[i+1]`` are the rows of sequence ``i`` in ``frames`` (metres, float) or ``frames_mm``
(millimetres, integers); ``joint_names`` says in which order the joints stand; every other array is kept as
it is, one entry a sequence or a frame, for the loader that knows the set.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import DataError
from wigwag.skeleton import KINECT20, from_kinect20

KINECT_SDK: tuple[str, ...] = (
    "hip_center", "spine", "shoulder_center", "head", "left_shoulder", "left_elbow", "left_wrist",
    "left_hand", "right_shoulder", "right_elbow", "right_wrist", "right_hand", "left_hip", "left_knee",
    "left_ankle", "left_foot", "right_hip", "right_knee", "right_ankle", "right_foot",
)  # fmt: skip
"""The joint order of the first Kinect's SDK, for files that do not name their joints."""


@dataclass(frozen=True, slots=True)
class Streams:
    """Every sequence of one file."""

    path: Path
    """Error messages name it."""
    offset: Int[np.ndarray, " sequences+1"]
    """Row of each sequence's first frame; last, the number of rows."""
    frames: Float[np.ndarray, "rows joints 3"]
    """Metres, Kinect frame: y up, z away from the camera, the person's right side at +x."""
    joint_names: tuple[str, ...]
    """In the order of ``frames``."""
    columns: dict[str, np.ndarray[Any, Any]]
    """Every other array of the file."""

    def __len__(self) -> int:
        return len(self.offset) - 1

    def raw(self, sequence: int) -> Float[np.ndarray, "frames joints 3"]:
        """Return one sequence's joints as they stand in the file, in metres."""
        return np.asarray(self.frames[self.offset[sequence] : self.offset[sequence + 1]], dtype=np.float64)

    def joints(self, sequence: int) -> Float[np.ndarray, "frames 13 3"]:
        """Return one sequence's 13 landmarks, metres, camera optical frame."""
        return from_kinect20(self.raw(sequence), self.joint_names)

    def column(self, name: str, length: int | None = None) -> np.ndarray[Any, Any]:
        """Return one of the other arrays.

        Args:
            name: Such as ``"subject"``.
            length: How many entries it must have; ``None``: one a sequence.

        Raises:
            DataError: If it is not there or has another length.
        """
        expected = len(self) if length is None else length
        if name not in self.columns:
            raise DataError(
                f"{self.path}: has no array {name!r}, which is expected there; "
                f"it holds {', '.join(sorted(self.columns)) or 'no other'}. Fetch the file again."
            )
        if len(column := self.columns[name]) != expected:
            raise DataError(f"{self.path}: {name} must have {expected} entries, but got {len(column)}.")
        return column


def load_streams(
    path: str | Path, pattern: str, hint: str, joint_names: Sequence[str] | None = None
) -> Streams:
    """Read a file of skeleton sequences.

    Args:
        path: The file, or the folder that holds it.
        pattern: What the file's name looks like in a folder, such as ``"msr_action3d*.npz"``.
        hint: What to do when there is none, appended to the error message.
        joint_names: Joint order of files that do not name their joints; ``None``: they must.

    Raises:
        DataError: If there is no such file, it is damaged, or what it holds is no such set.
    """
    file = _find(Path(path), pattern, hint)
    arrays = _read(file)
    names = [str(n) for n in arrays.pop("joint_names", [])] or list(joint_names or [])
    if sorted(names) != sorted(KINECT20):
        raise DataError(
            f"{file}: joint_names must be {sorted(KINECT20)} in any order, but got {sorted(names)}."
        )
    return Streams(file, *_rows(file, arrays, len(names)), tuple(names), arrays)


def _find(path: Path, pattern: str, hint: str) -> Path:
    if path.is_file():
        return path
    if not path.is_dir():
        raise DataError(f"{path}: no such file or folder. {hint}")
    found = sorted(path.glob(pattern))
    if not found:
        raise DataError(f"{path}: holds no {pattern}. {hint}")
    return found[0]


def _read(file: Path) -> dict[str, np.ndarray[Any, Any]]:
    try:
        with np.load(file, allow_pickle=False) as content:
            return {name: content[name] for name in content.files}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zlib.error) as error:
        raise DataError(f"{file}: is no readable .npz file ({error}). Fetch the file again.") from error
    except TypeError as error:  # a lone .npy array is no archive of several
        raise DataError(f"{file}: holds one array; an .npz file of several is expected.") from error


def _rows(
    file: Path, arrays: dict[str, np.ndarray[Any, Any]], n_joints: int
) -> tuple[np.ndarray, np.ndarray]:
    """Take offsets and frames out of the arrays and check that they belong together."""
    if "offset" not in arrays or not {"frames", "frames_mm"} & set(arrays):
        raise DataError(
            f"{file}: needs 'offset' and 'frames' (m) or 'frames_mm' (mm), "
            f"but holds {', '.join(sorted(arrays))}."
        )
    offset = arrays.pop("offset")
    frames = arrays.pop("frames") if "frames" in arrays else arrays.pop("frames_mm") * np.float32(1e-3)
    if frames.ndim != 3 or frames.shape[1:] != (n_joints, 3) or frames.dtype.kind != "f":
        raise DataError(
            f"{file}: frames must be numbers of shape (rows, {n_joints}, 3), "
            f"but got {frames.dtype} {frames.shape}."
        )
    if (
        offset.ndim != 1 or offset.dtype.kind not in "iu" or len(offset) < 2
        or offset[0] != 0 or offset[-1] != len(frames) or (np.diff(offset) < 0).any()
    ):  # fmt: skip
        raise DataError(f"{file}: offset must rise from 0 to the {len(frames)} rows of frames, but does not.")
    return offset.astype(np.int64), frames


__all__ = ["KINECT_SDK", "Streams", "load_streams"]
