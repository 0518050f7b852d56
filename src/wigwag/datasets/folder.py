"""A folder of the user's own clips: one JSON file a clip, which a person can read and a diff can show.

``clips/<label>/<name>.json``::

    {
      "format": "wigwag-clip", "version": 1,
      "label": "land", "subject": "ann",
      "frame": "camera optical: x right, y down, z forward", "units": "metre",
      "landmarks": ["nose", "left_shoulder", ...],
      "stamps_ns": [0, 33333333, ...],
      "joints": [
        [[0.0123, -0.5031, 2.9004], ...],
        ...
      ]
    }

``joints`` has one line a frame and 13 triples a line, rounded to 0.1 mm. ``label`` is ``null`` for a
movement that is no gesture, ``subject`` if it is not known who moves. Instead of ``stamps_ns`` a steady
``"rate_hz"`` may stand. The header decides the label; the folders' names are for people. All of it, and its
versions: docs/clips.md.
"""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.datasets.loaded import Loaded
from wigwag.datasets.versions import VERSION, upgraded
from wigwag.errors import DataError, InputError
from wigwag.skeleton import LANDMARKS, Clip

FORMAT = "wigwag-clip"
FRAME = "camera optical: x right, y down, z forward"
UNITS = "metre"
UNLABELLED = "none"
"""The folder in which clips without a label are saved."""


def save_clip(clip: Clip, root: str | Path, overwrite: bool = False) -> Path:
    """Write one clip to ``root/<label>/<name>.json``.

    Args:
        clip: What to save. Joints are rounded to 0.1 mm; stamps are kept to the nanosecond.
        root: The folder of all clips; made if it is not there.
        overwrite: Whether a file of that name may be replaced.

    Returns:
        The file written. It appears whole or not at all.

    Raises:
        InputError: If the file is there already and ``overwrite`` is false.
    """
    path = Path(root) / clip_path(clip, ".json")
    if path.exists() and not overwrite:
        raise InputError(f"{path}: is there already; choose another clip name or pass overwrite=True.")
    path.parent.mkdir(parents=True, exist_ok=True)
    half_written = path.with_suffix(".json.part")
    half_written.write_text(text_of(_content(clip)), encoding="utf-8")
    os.replace(half_written, path)
    return path


def load_clip(path: str | Path) -> Clip:
    """Read one clip.

    Raises:
        DataError: If the file is missing, no clip file, or irregular; the message names file and field.
    """
    path = Path(path)
    try:
        return _clip(read_content(path), path.stem)
    except DataError:
        raise
    except InputError as error:
        raise DataError(f"{path}: {str(error).removeprefix(f'{path.stem}: ')}") from error


def read_content(path: Path) -> dict[str, Any]:
    """Read a clip file as JSON, of whatever version.

    Raises:
        DataError: If it is missing, no JSON, or no clip file.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
    except (ValueError, RecursionError) as error:
        raise DataError(
            f"{path}: is no JSON ({error}). Expected a clip as wigwag.datasets.folder.save_clip writes it."
        ) from error
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise DataError(f'{path}: is no clip file: expected a JSON object with "format": "{FORMAT}".')
    return content


def load_folder(root: str | Path) -> Loaded:
    """Read every ``*.json`` below a folder.

    Returns:
        The clips, sorted by path; a file that cannot be used is left out by name with the reason.

    Raises:
        DataError: If there is no such folder, or no usable clip in it.
    """
    root = Path(root)
    if not root.is_dir():
        raise DataError(f"{root}: no such folder. Expected <label>/<name>.json in it, one file a clip.")
    clips: list[Clip] = []
    left_out: list[tuple[str, str]] = []
    for path in sorted(root.rglob("*.json")):
        try:
            clips.append(load_clip(path))
        except DataError as error:
            left_out.append((str(path.relative_to(root)), str(error).removeprefix(f"{path}: ")))
    if not clips:
        why = f"; first of {len(left_out)} left out: {': '.join(left_out[0]).rstrip('.')}" if left_out else ""
        raise DataError(f"{root}: holds no usable clip{why}. Expected <label>/<name>.json, one file a clip.")
    return Loaded(clips, left_out)


def clip_path(clip: Clip, suffix: str) -> Path:
    """Say where a clip lies in a folder of clips: ``<label>/<name><suffix>``."""
    return Path(safe_name(clip.label or UNLABELLED)) / f"{safe_name(clip.name)}{suffix}"


def safe_name(name: str) -> str:
    """Turn a label or name into a file name that every system takes and that stays in its folder."""
    safe = re.sub(r"[^\w.-]+", "_", name).strip(".")
    if not safe:
        raise InputError(f"The name {name!r} gives no file name; use letters or digits.")
    return safe


def text_of(content: dict[str, Any]) -> str:
    """Lay out a clip file: one line a header field, one line a frame."""
    header = {key: value for key, value in content.items() if key != "joints"}
    lines = [f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}" for key, value in header.items()]
    joints = content.get("joints")
    frames = [json.dumps(frame) for frame in joints] if isinstance(joints, list) else []
    lines.append('  "joints": [\n    ' + ",\n    ".join(frames) + "\n  ]")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _content(clip: Clip) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "label": clip.label,
        "subject": clip.subject,
        "frame": FRAME,
        "units": UNITS,
        "landmarks": list(LANDMARKS),
        "stamps_ns": [int(stamp) for stamp in clip.stamps_ns],
        "joints": np.round(np.asarray(clip.joints, dtype=np.float64), 4).tolist(),
    }


def _clip(content: dict[str, Any], name: str) -> Clip:
    content = upgraded(content)
    for field, expected in (("units", UNITS), ("frame", FRAME)):
        if content.get(field) != expected:
            raise InputError(
                f"{field} must be {expected!r}, but got {content.get(field)!r}. Convert the file."
            )
    for field in ("label", "subject"):
        if not isinstance(content.get(field), str | None):
            raise InputError(f"{field} must be text or null, but got {content[field]!r}.")
    joints = _array(content, "joints", np.float64)
    landmarks = content.get("landmarks")
    if not isinstance(landmarks, list) or sorted(map(str, landmarks)) != sorted(LANDMARKS):
        raise InputError(f"landmarks must be {list(LANDMARKS)} in any order, but got {landmarks!r}.")
    if joints.ndim == 3 and joints.shape[1] == len(landmarks):
        joints = joints[:, [landmarks.index(landmark) for landmark in LANDMARKS]]
    label, subject = content.get("label"), content.get("subject")
    if "stamps_ns" in content:
        return Clip(joints, _array(content, "stamps_ns", np.int64), label, subject, name)
    rate_hz = content.get("rate_hz")
    if isinstance(rate_hz, bool) or not isinstance(rate_hz, int | float) or not 0 < rate_hz < 1e6:
        raise InputError(f"needs stamps_ns, or rate_hz above 0, but got rate_hz {rate_hz!r}.")
    return Clip.at_rate(joints, rate_hz, label, subject, name)


def _array(content: dict[str, Any], field: str, dtype: type) -> np.ndarray[Any, Any]:
    try:
        return np.array(content[field], dtype=dtype)
    except KeyError as error:
        raise InputError(f"has no {field}.") from error
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(f"{field} must be a regular list of numbers ({error}).") from error


__all__ = [
    "FRAME", "UNITS", "UNLABELLED", "clip_path", "load_clip", "load_folder", "read_content", "safe_name",
    "save_clip", "text_of",
]  # fmt: skip
