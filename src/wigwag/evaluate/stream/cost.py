"""What an hour of listening costs: time a pose, whether it stays the same, and memory."""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.datasets.utd_mhad import ACTIONS
from wigwag.evaluate.stream.lessons import Lesson, folds, lesson, person_stream
from wigwag.evaluate.stream.material import Material, shown_between
from wigwag.evaluate.stream.moves import moves
from wigwag.evaluate.stream.points import point_folds, point_lesson
from wigwag.evaluate.stream.systems import system_of
from wigwag.evaluate.stream.watch import poses_of
from wigwag.evaluate.threads import one_thread
from wigwag.skeleton import Pose

Progress = Callable[[str, int, int], None]
"""Called with (what, done, total)."""

MORE_GESTURES = ("g4", "g6", "g9")
"""Of MSRC-12, beside UTD-MHAD's 27: thirty in all."""

WARM_S = 60.0
"""The first minute does not count: compiled code is loaded in it, and the person's rest is learned."""


def run_cost(
    material: Material, system: str, hours: float = 1.0, seed: int = 0, progress: Progress | None = None
) -> dict[str, Any]:
    """Let a system with thirty gestures enrolled listen for an hour without a break, and measure.

    Gestures and everyday movements of the people who are only judged come one after the other on one
    clock, at 30 poses a second; the system is never reset. Time is processor time of the one thread.

    Args:
        material: What was read; without MSRC-12 there are 27 gestures.
        system: One of :data:`~wigwag.evaluate.stream.systems.SYSTEMS`.
        hours: How long, beside the first minute.
        seed: Of the streams.
        progress: Called every ten minutes of stream.

    Returns:
        A record.
    """
    taught = _thirty(material, seed)
    took: list[float] = []
    with one_thread():
        listener = system_of(system)(taught)
        listener.reset()
        begin_mb = end_mb = 0.0
        total = round(hours * 3600 * 30)
        for number, pose in enumerate(_without_end(material, taught, seed), start=-round(WARM_S * 30)):
            if number >= total:
                break
            if number == 0:
                begin_mb = resident_mb()
            if progress is not None and number % 18_000 == 0:
                progress(f"{system}, listening", max(number, 0), total)
            begin = time.thread_time_ns()
            listener.update(pose)
            if number >= 0:
                took.append((time.thread_time_ns() - begin) * 1e-6)
        end_mb = resident_mb()
    ms = np.array(took)
    quarter = len(ms) // 4
    return {
        "data": "cost",
        "system": system,
        "gestures": len(taught.vocabulary),
        "hours": len(ms) / 30 / 3600,
        "ms_per_pose_mean": float(ms.mean()),
        "ms_per_pose_median": float(np.median(ms)),
        "ms_per_pose_p99": float(np.quantile(ms, 0.99)),
        "ms_per_pose_max": float(ms.max()),
        "last_to_first_quarter": float(ms[-quarter:].mean() / ms[:quarter].mean()),
        "rss_mb": end_mb,
        "rss_growth_mb": end_mb - begin_mb,
    }


def _thirty(material: Material, seed: int) -> Lesson:
    fold = folds(material, inner=False)[0]
    made = lesson(material, fold, tuple(ACTIONS), seed=seed)
    if not material.msrc12:
        return made
    people = sorted({str(r.stream.subject) for r in material.msrc12})
    more = point_lesson(material.msrc12, point_folds(people)[0], seed).gestures
    kept = [clip for clip in more if clip.label in MORE_GESTURES and moves(clip)]
    return replace(made, gestures=made.gestures + kept)


def _without_end(material: Material, taught: Lesson, seed: int) -> Iterator[Pose]:
    fold = folds(material, inner=False)[0]
    everyday = [
        s for s in shown_between(material, taught.vocabulary) if s.clip.subject in fold.everyday_judged
    ]
    offset, turn = 0, 0
    while True:
        for person in fold.judged:
            stream = person_stream(material, person, tuple(ACTIONS), everyday, [0xC057, seed, turn])
            for pose in poses_of(stream):
                yield replace(pose, stamp_ns=pose.stamp_ns + offset)
            offset += int(stream.stream.stamps_ns[-1]) + 33_333_333
        turn += 1


def resident_mb() -> float:
    """Return the memory that the process holds now, MB; its peak where the system does not say."""
    table = Path("/proc/self/statm")
    if table.is_file():
        return int(table.read_text().split()[1]) * resource.getpagesize() / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


__all__ = ["MORE_GESTURES", "WARM_S", "resident_mb", "run_cost"]
