"""How far away a person may stand and still be found, in pictures and in streams."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.errors import DataError
from wigwag.evaluate.composites import CLUTTER, SIZE, STYLES, Picture, Scene, load_photos, make_scene
from wigwag.evaluate.metrics import wilson_interval
from wigwag.evaluate.walls import look_at_walls
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body
from wigwag.pose.region import Region

PERSON_PX = (250, 200, 160, 136, 102, 81, 64)
"""Heights at which people are looked for, pixels, crown to toe."""
RIGHT_WITHIN = 0.15
"""A body is rightly found if its landmarks lie within so much of the torso's length of where they are:
median over the 33, compared with what is seen at full size."""
RIGHTLY = f"median landmark error < {RIGHT_WITHIN} of the torso length, against the full-size photo"
_METRE_PX = 820.0
"""Height in pixels times distance in metres of a person of 1.75 m before a 640x480 camera with a focal
length of 470 px (a horizontal view of 69 degrees, as a RealSense D435's colour camera)."""
_EMPTY_FRAMES = 60
"""A stream shows nobody for up to so many frames, so that a person appears at any turn of the search."""
_KEPT_FRAMES = 30
"""For so many frames an acquired person must be kept."""
_GIVE_UP = 200

Progress = Callable[[str, int, int], None]
Failure = tuple[str, Picture]


@dataclass(frozen=True, slots=True)
class FarOptions:
    """What is measured."""

    sizes: tuple[int, ...] = PERSON_PX
    """Heights of the people, pixels. A photo takes part where its person is at least as tall."""
    seeds: tuple[int, ...] = (0,)
    """Each photo is shrunk once a seed and size, for other clutter, place and style."""
    streams: bool = True
    """Also as streams: clutter alone, then the person in it, wandering."""
    walls: int = 500
    """Crops of walls and furniture without a person."""


@dataclass(slots=True)
class Trial:
    """One composite, in one picture or as a stream."""

    photo: Path
    style: str
    error: float
    """Of the landmarks, in lengths of the torso; infinite: nobody found."""
    ms: float
    """Of the picture, or of a frame of the stream until the person was acquired: mean."""
    full_frame: bool = False
    """Whether the full frame alone would have sufficed."""
    frames: int | None = None
    """Of a stream: until the person was acquired, 1 = at once; ``None``: never."""
    kept: float = 0.0
    """Share of the frames after that in which the right body was there."""
    false_frames: int = 0
    """Frames in which somebody was found before or elsewhere than the person."""

    @property
    def right(self) -> bool:
        """Whether the body found is the person."""
        return self.error < RIGHT_WITHIN


@dataclass(slots=True)
class FarMeasurement:
    """Everything measured, as flat records."""

    rows: list[dict[str, Any]] = field(default_factory=list)
    not_found: list[Path] = field(default_factory=list)
    """Photos in which nobody was found at full size."""
    failures: list[Failure] = field(default_factory=list)
    """What went wrong, with the picture."""


def in_first_half(folder: str, folders: Sequence[str]) -> bool:
    """Say whether this is one of the first half of the folders: every second one by name, from the first.

    Both halves were in view when the mirror check was chosen: they show how much chance is in a figure, and
    are no hold-out.
    """
    return sorted(folders).index(folder) % 2 == 0


def landmark_error(body: Body | None, points_px: Float[np.ndarray, "33 2"]) -> float:
    """Return the median distance of a body's landmarks from the true ones in lengths of the torso."""
    if body is None:
        return float("inf")
    torso = float(np.linalg.norm(points_px[[11, 12]].mean(axis=0) - points_px[[23, 24]].mean(axis=0)))
    return float(np.median(np.linalg.norm(body.points_px - points_px, axis=1))) / max(torso, 1e-9)


def measure_far(
    data: Path,
    pose: BlazePose,
    options: FarOptions | None = None,
    *,
    add: Callable[[dict[str, Any]], object] = lambda row: None,
    progress: Progress = lambda what, done, total: None,
) -> FarMeasurement:
    """Look for shrunk people in clutter, in single pictures and in streams, and for nobody on walls.

    Args:
        data: Folder of photos of one person each, ``FOLDER/*.jpg``.
        pose: What looks.
        options: What is measured.
        add: Called with each record as it is there.
        progress: Called with (what, done, total).

    Raises:
        DataError: If there are no photos, or fewer than two with a person.
    """
    options = options or FarOptions()
    measured = FarMeasurement()
    photos, measured.not_found = load_photos(
        data, pose, lambda done, total: progress("full size", done, total)
    )
    if len(photos) < 2:
        raise DataError(f"{data}: people were found in {len(photos)} photos, but clutter needs two at least.")

    def record(rows: Sequence[dict[str, Any]]) -> None:
        measured.rows.extend(rows)
        for row in rows:
            add(row)

    record([_full_size_row(len(photos), len(photos) + len(measured.not_found))])
    for size in options.sizes:
        taken = [(i, seed) for seed in options.seeds for i, p in enumerate(photos) if p.person_px >= size]
        for mode in ("picture", "stream") if options.streams else ("picture",):
            trials = []
            for done, (i, seed) in enumerate(taken):
                rng = np.random.default_rng((seed, size, i, mode == "stream"))
                style, kind = STYLES[rng.integers(len(STYLES))], CLUTTER[rng.integers(len(CLUTTER))]
                scene = make_scene(rng, photos[i], photos, size, style=style, kind=kind)
                look = _in_a_picture if mode == "picture" else _in_a_stream
                trial, failure = look(rng, pose, scene, photos[i].path)
                trials.append(trial)
                if failure is not None:
                    measured.failures.append(failure)
                progress(f"{size} px, {mode}", done + 1, len(taken))
            record(_size_rows(size, mode, trials))
    if options.walls:
        rows, failures = look_at_walls(photos, pose, options.walls, min(options.seeds), progress)
        record(rows)
        measured.failures += failures
    return measured


def _start(rng: np.random.Generator, scene: Scene) -> tuple[int, int]:
    u, v = (int(rng.integers(min(room, 0), max(room, 0) + 1)) for room in scene.room)
    return u, v


def _in_a_picture(
    rng: np.random.Generator, pose: BlazePose, scene: Scene, photo: Path
) -> tuple[Trial, Failure | None]:
    rgb, points_px = scene.at(*_start(rng, scene))
    begun = time.thread_time()
    body = pose.detect(rgb)
    ms = 1e3 * (time.thread_time() - begun)
    near = pose.find(rgb, [Region.whole(*SIZE)], every=True)
    trial = Trial(photo, scene.style, landmark_error(body, points_px), ms)
    trial.full_frame = landmark_error(near[0].body if near else None, points_px) < RIGHT_WITHIN
    what = "missed" if body is None else f"off by {trial.error:.2f}"
    return trial, None if trial.right else (_named(photo, scene, what), rgb)


def _in_a_stream(
    rng: np.random.Generator, pose: BlazePose, scene: Scene, photo: Path
) -> tuple[Trial, Failure | None]:
    """Show clutter, then the person in it, who wanders by up to two pixels a frame."""
    pose.reset()
    trial = Trial(photo, scene.style, float("inf"), 0.0)
    rgb = scene.taken(scene.clutter)
    for _ in range(int(rng.integers(_EMPTY_FRAMES))):
        trial.false_frames += pose.track(rgb) is not None
    spent, errors = [], []
    for frame, place in enumerate(_wander(rng, scene)):
        rgb, points_px = scene.at(*place)
        begun = time.thread_time()
        body = pose.track(rgb)
        ms = 1e3 * (time.thread_time() - begun)
        error = landmark_error(body, points_px)
        trial.false_frames += RIGHT_WITHIN <= error < float("inf")
        if trial.frames is not None:
            errors.append(error)
        else:
            spent.append(ms)
            trial.frames = frame + 1 if error < RIGHT_WITHIN else None
        if len(errors) == _KEPT_FRAMES or (trial.frames is None and frame + 1 == _GIVE_UP):
            break
    trial.ms = float(np.mean(spent))
    if trial.frames is None:
        return trial, (_named(photo, scene, "never acquired"), rgb)
    trial.error = float(np.median(errors))
    trial.kept = float(np.mean(np.array(errors) < RIGHT_WITHIN))
    if trial.kept == 1.0 and not trial.false_frames:
        return trial, None
    what = f"kept in {100 * trial.kept:.0f} %, {trial.false_frames} frames of somebody else"
    return trial, (_named(photo, scene, what), rgb)


def _wander(rng: np.random.Generator, scene: Scene) -> Iterator[tuple[int, int]]:
    """Walk to and fro between the picture's edges."""
    place = np.array(_start(rng, scene))
    low, high = np.minimum(scene.room, 0), np.maximum(scene.room, 0)
    speed = rng.integers(-2, 3, 2)
    while True:
        yield int(place[0]), int(place[1])
        speed = np.where((place + speed < low) | (place + speed > high), -speed, speed)
        place = np.clip(place + speed, low, high)


def _named(photo: Path, scene: Scene, what: str) -> str:
    return f"{photo.parent.name}/{photo.stem[:8]} {scene.style} on {scene.kind}: {what}"


def _full_size_row(found: int, n: int) -> dict[str, Any]:
    return {
        "data": "all",
        "mode": "full size",
        "person_px": None,
        "n": n,
        "found_pct": round(100 * found / n, 2),
        "found_ci95": _interval(found, n),
        "rightly": "somebody found",
    }


def _size_rows(size: int, mode: str, trials: list[Trial]) -> list[dict[str, Any]]:
    folders = sorted({trial.photo.parent.name for trial in trials})
    groups = {
        "all": trials,
        "every second folder": [t for t in trials if in_first_half(t.photo.parent.name, folders)],
        "other folders": [t for t in trials if not in_first_half(t.photo.parent.name, folders)],
    }
    return [_row(name, size, mode, group) for name, group in groups.items() if group]


def _row(data: str, size: int, mode: str, trials: list[Trial]) -> dict[str, Any]:
    errors = [trial.error for trial in trials if trial.right]
    row: dict[str, Any] = {
        "data": data,
        "mode": mode,
        "person_px": size,
        "distance_m_at_640x480": round(_METRE_PX / size, 1),
        "n": len(trials),
        "found_pct": _percent([trial.right for trial in trials]),
        "found_ci95": _interval(len(errors), len(trials)),
        "rightly": RIGHTLY,
        "landmark_error_torso_median": round(float(np.median(errors)), 4) if errors else None,
        "landmark_error_torso_p95": round(float(np.quantile(errors, 0.95)), 4) if errors else None,
    }
    for style in STYLES:
        of_style = [trial.right for trial in trials if trial.style == style]
        row[f"found_pct_{style}"] = _percent(of_style) if of_style else None
    ms = [trial.ms for trial in trials]
    if mode == "picture":
        wrong = sum(bool(np.isfinite(trial.error)) and not trial.right for trial in trials)
        return row | {
            "wrong_body": wrong,
            "full_frame_found_pct": _percent([trial.full_frame for trial in trials]),
            "ms_median": round(float(np.median(ms)), 1),
        }
    frames = [trial.frames for trial in trials if trial.frames is not None]
    return row | {
        "acquired_pct": _percent([trial.frames is not None for trial in trials]),
        "frames_to_acquire_median": float(np.median(frames)) if frames else None,
        "frames_to_acquire_mean": round(float(np.mean(frames)), 2) if frames else None,
        "frames_to_acquire_p95": round(float(np.quantile(frames, 0.95)), 1) if frames else None,
        "frames_to_acquire_max": max(frames, default=None),
        "kept_pct": _percent([trial.kept for trial in trials]),
        "kept_frames": _KEPT_FRAMES,
        "false_frames": sum(trial.false_frames for trial in trials),
        "ms_search_frame_mean": round(float(np.mean(ms)), 1),
    }


def _percent(shares: Sequence[float]) -> float:
    return round(100 * float(np.mean(shares)), 2)


def _interval(found: int, n: int) -> list[float]:
    return [round(100 * bound, 2) for bound in wilson_interval(found, n)]


__all__ = [
    "PERSON_PX",
    "RIGHT_WITHIN",
    "FarMeasurement",
    "FarOptions",
    "Trial",
    "landmark_error",
    "measure_far",
]
