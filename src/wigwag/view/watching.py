"""What a camera and the pose estimator are doing, as a person reads it in a terminal."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.console import Group
from rich.table import Table
from rich.text import Text

from wigwag.camera.fresh import Glimpse
from wigwag.camera.protocol import Camera
from wigwag.camera.watchdog import Sight
from wigwag.pose.estimator import Person
from wigwag.skeleton import N_LANDMARKS, Pose

_LOOK_BACK_S = 2.0
"""Rates and times of the moment are those of so long."""
_UNSEEN_S = 0.5
"""Others are looked at in turn; from so long on it is worth saying that somebody was not seen."""


@dataclass(frozen=True, slots=True)
class Watched:
    """One turn of the loop, as far as it is shown."""

    glimpse: Glimpse
    pose: Pose | None
    """The operator's."""
    pose_s: float
    """Processor seconds for finding it."""
    latency_s: float | None
    """From the frame's stamp to its pose; ``None`` for recordings, whose time is not now."""


class Meter:
    """Counts and times a stream: of the last two seconds for whoever looks, and of all for the account."""

    def __init__(self) -> None:
        self._recent: deque[tuple[int, Watched]] = deque()
        self._pose_ms: list[float] = []
        self._latency_ms: list[float] = []
        self._sights: dict[str, int] = {sight.value: 0 for sight in Sight}
        self._turns = self._found = self._monocular = 0
        self._first_ns: int | None = None
        self._last_ns = 0

    def note(self, watched: Watched) -> None:
        """Take in a turn of the loop."""
        now_ns = watched.glimpse.now_ns
        self._turns += 1
        self._sights[watched.glimpse.health.sight.value] += 1
        self._recent.append((now_ns, watched))
        while (now_ns - self._recent[0][0]) * 1e-9 > _LOOK_BACK_S:
            self._recent.popleft()
        if watched.glimpse.frame is None:
            return
        self._first_ns = now_ns if self._first_ns is None else self._first_ns
        self._last_ns = now_ns
        self._pose_ms.append(1e3 * watched.pose_s)
        if watched.latency_s is not None:
            self._latency_ms.append(1e3 * watched.latency_s)
        if watched.pose is not None:
            self._found += 1
            self._monocular += watched.pose.monocular

    @property
    def rate_hz(self) -> float:
        """Fresh frames a second over the last two seconds; 0 before the second frame."""
        stamps = [now for now, watched in self._recent if watched.glimpse.frame is not None]
        if len(stamps) < 2 or stamps[-1] == stamps[0]:
            return 0.0
        return (len(stamps) - 1) / ((stamps[-1] - stamps[0]) * 1e-9)

    def recent_ms(self) -> tuple[float | None, float | None]:
        """Return the median milliseconds of finding the pose, and of latency, over the last two seconds."""
        fresh = [watched for _, watched in self._recent if watched.glimpse.frame is not None]
        pose = [1e3 * watched.pose_s for watched in fresh]
        latency = [1e3 * watched.latency_s for watched in fresh if watched.latency_s is not None]
        return _median(pose), _median(latency)

    def account(self) -> dict[str, Any]:
        """Return the figures of everything so far; ``None`` where there is none."""
        fresh = len(self._pose_ms)
        span_s = 0.0 if self._first_ns is None else (self._last_ns - self._first_ns) * 1e-9
        return {
            "turns": self._turns,
            "frames_fresh": fresh,
            "sights": dict(self._sights),
            "operator_found": self._found / fresh if fresh else None,
            "monocular": self._monocular,
            "rate_hz": (fresh - 1) / span_s if span_s > 0 else None,
            "pose_ms_median": _median(self._pose_ms),
            "pose_ms_p95": float(np.percentile(self._pose_ms, 95)) if fresh else None,
            "latency_ms_median": _median(self._latency_ms),
        }


def panel(camera: Camera, watched: Watched, meter: Meter, people: Sequence[Person], why: str = "") -> Group:
    """Return what the terminal shows of this moment.

    Args:
        camera: Where the frames come from.
        watched: The newest turn.
        meter: Rates and times.
        people: Everybody who is followed.
        why: Why there is no operator's pose, in words.
    """
    counts = camera.counts
    frame, health = watched.glimpse.frame, watched.glimpse.health
    grid = Table.grid(padding=(0, 2))
    size = "" if frame is None else f"{frame.rgb.shape[1]} x {frame.rgb.shape[0]}"
    depth = "" if frame is None else " with depth" if frame.depth_mm is not None else " without depth"
    grid.add_row("camera", f"{camera.address}  {size}{depth}")
    state = Text(health.sight.value, style="green" if health.usable else "bold red")
    if health.reason:
        state.append(f": {health.reason}")
    grid.add_row("picture", state)
    lost = f", {counts.skipped} skipped" if counts.skipped else ""
    again = f", reconnected {counts.reconnects} times" if counts.reconnects else ""
    grid.add_row("rate", f"{meter.rate_hz:.1f} frames a second{lost}{again}")
    pose_ms, latency_ms = meter.recent_ms()
    times = "-" if pose_ms is None else f"{pose_ms:.1f} ms to find the pose"
    if latency_ms is not None:
        times += f", {latency_ms:.0f} ms from picture to pose"
    grid.add_row("time", times)
    grid.add_row("operator", _operator(watched.pose, why))
    return Group(grid, _crowd(people, watched.glimpse.now_ns))


def _operator(pose: Pose | None, why: str) -> Text:
    if pose is None:
        return Text(why or "nobody", style="yellow")
    x, y, z = (float(v) for v in pose.hip_center)
    side = f"{abs(np.degrees(np.arctan2(x, z))):.0f}° {'right' if x > 0 else 'left'}"
    measured = int((pose.visibility > 0).sum())
    text = (
        f"{np.hypot(x, z):.2f} m away, {side}, hips {abs(y):.2f} m {'below' if y > 0 else 'above'} the lens"
    )
    text += (
        f"; {measured} of {N_LANDMARKS} landmarks measured, ± {1e3 * float(np.median(pose.sigma_m)):.0f} mm"
    )
    if pose.monocular:
        text += f"; without depth: distance ± {pose.distance_sigma_m:.2f} m"
    return Text(text, style="green")


def _crowd(people: Sequence[Person], now_ns: int) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2))
    for column in ("who", "away", "what"):
        table.add_column(column, style="bold" if column == "who" else None)
    for person in people:
        away = f"{float(np.hypot(*person.position_m[[0, 2]])):.1f} m"
        unseen_s = (now_ns - person.seen_ns) * 1e-9
        what = f"not seen for {unseen_s:.1f} s" if unseen_s > _UNSEEN_S else ""
        if 0 < person.engaging < 1 and not person.is_operator:
            what = f"engaging {person.engaging:.0%}"
        elif 0 < person.disengaging < 1 and person.is_operator:
            what = f"disengaging {person.disengaging:.0%}"
        table.add_row(f"{person.number} operator" if person.is_operator else str(person.number), away, what)
    return table


def _median(values: Sequence[float]) -> float | None:
    return float(np.median(values)) if len(values) else None


__all__ = ["Meter", "Watched", "panel"]
