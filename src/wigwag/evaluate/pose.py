"""Pose engines side by side: how long a picture takes each, whom they find, how far they are apart."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from wigwag.evaluate.pictures import deserted, moving, without_person
from wigwag.evaluate.threads import one_core
from wigwag.pose.body import Body
from wigwag.pose.engine import EngineName, ModelName, Picture, PoseEngine

AGREEMENT_PX = 1.0
"""Two engines that follow somebody with the same networks are not further apart than this, in the median of
all landmarks. In a picture that stands for itself they may be: LiteRT's looks twice at whom it finds, which
is closer to what either of them sees once it follows."""

Mode = Literal["detect", "track", "search"]
"""A picture that stands for itself; a stream in which somebody is followed; one in which nobody is."""

_SHOWN, _SETTLED = 4, 2
"""A photo is followed for so many frames, of which the first ones are not counted: regions settle."""
_SPARSELY = 5
"""Of a stream every so many frames is detected by itself."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Shown:
    """A picture as it is put before the engines."""

    rgb: Picture
    first: bool = False
    """Whether a stream begins here."""
    counted: bool = True


@dataclass(slots=True)
class Trial:
    """What one engine made of the pictures of one mode."""

    seconds: list[float] = field(default_factory=list)
    """Of the pictures whose time counts: those in which nothing was found or lost, in a stream."""
    bodies: list[Body | None] = field(default_factory=list)
    """In every counted picture."""


def compare(
    engines: Mapping[EngineName, PoseEngine],
    mode: Mode,
    shown: Iterable[Shown],
    clock: Callable[[], float] = time.process_time,
) -> dict[EngineName, Trial]:
    """Show pictures to all engines in turn; who goes first changes from picture to picture.

    Args:
        engines: By name.
        mode: What they are asked for. While searching, whoever finds somebody is made to forget them.
        shown: The pictures.
        clock: Seconds of processor time of all threads.
    """
    trials: dict[EngineName, Trial] = {name: Trial() for name in engines}
    before: dict[EngineName, Body | None] = dict.fromkeys(engines)
    names = list(engines)
    for number, picture in enumerate(shown):
        for follower in range(len(names)):
            name = names[(number + follower) % len(names)]
            engine, trial = engines[name], trials[name]
            if picture.first and mode != "detect":
                engine.reset()
                before[name] = None
            began = clock()
            body = engine.detect(picture.rgb) if mode == "detect" else engine.track(picture.rgb)
            spent = clock() - began
            if picture.counted:
                trial.bodies.append(body)
                wanted = mode == "track"
                if mode == "detect" or (body is not None) == (before[name] is not None) == wanted:
                    trial.seconds.append(spent)
            before[name] = body
            if mode == "search" and body is not None:
                engine.reset()
                before[name] = None
    return trials


def apart_px(trials: Sequence[Trial]) -> Float[np.ndarray, " landmarks"]:
    """Return how far each landmark lies from its place by the first engine, where all found somebody."""
    first, *others = trials
    away = [
        np.linalg.norm(a.points_px - b.points_px, axis=1)
        for other in others
        for a, b in zip(first.bodies, other.bodies, strict=True)
        if a is not None and b is not None
    ]
    return np.concatenate(away) if away else np.empty(0)


def rows(trials: Mapping[EngineName, Trial], mode: Mode, data: str, model: ModelName) -> list[dict[str, Any]]:
    """Return one flat record an engine. ``agreement_px_...`` is between the engines, so the same in each."""
    away = apart_px(list(trials.values()))
    mine = _ms(trials["litert"].seconds, 50)
    records = []
    for name, trial in trials.items():
        ms = _ms(trial.seconds, 50)
        records.append(
            {
                "engine": name,
                "model": model,
                "mode": mode,
                "data": data,
                "frames": len(trial.bodies),
                "found": sum(body is not None for body in trial.bodies),
                "timed": len(trial.seconds),
                "ms_median": ms,
                "ms_p95": _ms(trial.seconds, 95),
                "times_litert": None if ms is None or not mine else round(ms / mine, 2),
                "agreement_px_median": round(float(np.median(away)), 3) if len(away) else None,
                "agreement_px_p95": round(float(np.percentile(away, 95)), 3) if len(away) else None,
            }
        )
    return records


def _ms(seconds: Sequence[float], percentile: float) -> float | None:
    return round(1e3 * float(np.percentile(seconds, percentile)), 2) if seconds else None


def measure(
    open_all: Callable[[], Mapping[EngineName, PoseEngine]],
    model: ModelName,
    photos: Sequence[Picture],
    *,
    seconds: float,
    seed: int,
    progress: Progress = lambda what, done, total: None,
) -> Iterator[dict[str, Any]]:
    """Compare engines in every mode, on photos and on rendered motion, on one core.

    Args:
        open_all: Opens the engines, 'litert' among them; called where threads are bound to one core.
        model: What landmark network they run; for the records.
        photos: Of people; none: rendered motion alone.
        seconds: Of rendered motion.
        seed: Of the rendered people and surroundings.
        progress: Called with what is being done, pictures done and in all.

    Yields:
        One record for each engine, mode and kind of pictures.
    """
    with one_core():
        engines = open_all()
        for mode, data, shown, total in _courses(engines["litert"], photos, seconds, seed):
            watched = _watched(shown, f"{mode}, {data}", total, progress)
            yield from rows(compare(engines, mode, watched), mode, data, model)


def _courses(
    finder: PoseEngine, photos: Sequence[Picture], seconds: float, seed: int
) -> Iterator[tuple[Mode, str, Iterable[Shown], int]]:
    """Yield what is shown: mode, name, pictures, how many."""
    n = round(30 * seconds)
    if photos:
        yield "detect", "photos", [Shown(rgb) for rgb in photos], len(photos)
        followed = [Shown(rgb, k == 0, k >= _SETTLED) for rgb in photos for k in range(_SHOWN)]
        yield "track", "photos", followed, len(followed)
        rooms = without_person(photos, finder)
        yield "search", "photos, person cut away", [Shown(r, k == 0) for k, r in enumerate(rooms)], len(rooms)
    frames = enumerate(moving(seconds, seed))
    yield "detect", "rendered motion", (Shown(f.rgb) for k, f in frames if k % _SPARSELY == 0), n // _SPARSELY
    frames = enumerate(moving(seconds, seed))
    yield "track", "rendered motion", (Shown(f.rgb, k == 0, k >= _SETTLED) for k, f in frames), n
    frames = enumerate(deserted(seconds, seed))
    yield "search", "rendered, nobody there", (Shown(f.rgb, k == 0) for k, f in frames), n


def _watched(shown: Iterable[Shown], what: str, total: int, progress: Progress) -> Iterator[Shown]:
    for done, picture in enumerate(shown):
        progress(what, done, total)
        yield picture


__all__ = ["AGREEMENT_PX", "Mode", "Shown", "Trial", "apart_px", "compare", "measure", "rows"]
