"""Pictures without a person, in which nobody must be found."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import cv2
import numpy as np

from wigwag.evaluate.composites import SIZE, Photo, Picture, empty_parts, make_clutter, random_part
from wigwag.evaluate.metrics import wilson_interval
from wigwag.pose.blazepose import BlazePose


def look_at_walls(
    photos: Sequence[Photo],
    pose: BlazePose,
    n: int,
    seed: int,
    progress: Callable[[str, int, int], None] = lambda what, done, total: None,
) -> tuple[list[dict[str, Any]], list[tuple[str, Picture]]]:
    """Look for people in crops of walls and furniture, of five kinds in turn.

    Args:
        photos: What is beside their people is looked at.
        pose: What looks.
        n: Crops in all.
        seed: Which crops.
        progress: Called with (what, done, total).

    Returns:
        A flat record a kind, and the pictures in which somebody was found, with what was found.
    """
    rng = np.random.default_rng((seed, n))
    kinds = _kinds(rng, photos)
    found: dict[str, list[bool]] = {kind: [] for kind in kinds}
    spent: dict[str, list[float]] = {kind: [] for kind in kinds}
    failures: list[tuple[str, Picture]] = []
    for done in range(n):
        kind = list(kinds)[done % len(kinds)]
        rgb = np.ascontiguousarray(kinds[kind]())
        begun = time.thread_time()
        body = pose.detect(rgb)
        spent[kind].append(1e3 * (time.thread_time() - begun))
        found[kind].append(body is not None)
        if body is not None:
            failures.append((f"nobody there, {kind}, clarity {body.clarity:.2f}", rgb))
        progress("nobody there", done + 1, n)
    return [_row(kind, found[kind], spent[kind]) for kind in kinds if found[kind]], failures


def _kinds(rng: np.random.Generator, photos: Sequence[Photo]) -> dict[str, Callable[[], Picture]]:
    """Return what makes each kind of picture; nothing in them is painted over or inserted."""
    return {
        "as it is": lambda: _crop(rng, photos),
        "shrunk": lambda: _shrunk(rng, photos),
        "enlarged": lambda: np.asarray(
            cv2.resize(random_part(rng, photos, SIZE), SIZE, interpolation=cv2.INTER_CUBIC)
        ),
        "joined": lambda: make_clutter(rng, photos, "joined"),
        "collage": lambda: make_clutter(rng, photos, "collage"),
    }


def _crop(rng: np.random.Generator, photos: Sequence[Photo]) -> Picture:
    parts: list[Picture] = []
    while not parts:
        parts = empty_parts(photos[int(rng.integers(len(photos)))], 120)
    part = parts[int(rng.integers(len(parts)))]
    height, width = part.shape[:2]
    rows, columns = int(rng.uniform(0.5, 1.0) * height), int(rng.uniform(0.7, 1.0) * width)
    v, u = int(rng.integers(height - rows + 1)), int(rng.integers(width - columns + 1))
    return part[v : v + rows, u : u + columns]


def _shrunk(rng: np.random.Generator, photos: Sequence[Photo]) -> Picture:
    share = float(rng.uniform(0.4, 0.9))
    crop = _crop(rng, photos)
    return np.asarray(cv2.resize(crop, None, fx=share, fy=share, interpolation=cv2.INTER_AREA))


def _row(kind: str, found: list[bool], spent_ms: list[float]) -> dict[str, Any]:
    n, false = len(found), sum(found)
    low, high = wilson_interval(false, n)
    return {
        "data": "walls and furniture",
        "mode": "nobody",
        "crops": kind,
        "n": n,
        "false_found": false,
        "false_found_pct": round(100 * false / n, 3),
        "false_found_ci95": [round(100 * low, 2), round(100 * high, 2)],
        "ms_median": round(float(np.median(spent_ms)), 1),
    }


__all__ = ["look_at_walls"]
