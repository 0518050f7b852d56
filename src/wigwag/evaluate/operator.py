"""Is the operator kept, and nobody else's pose handed on? Sessions with passers-by, judged.

The chain sees pixels and depth of the simulated camera, nothing else; who is who is judged by the world's
truth.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.evaluate.passers import Condition, Staged, stage
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot, PilotConfig
from wigwag.pose.estimator import PoseEstimator
from wigwag.sim.world import Truth
from wigwag.skeleton import Clip, Pose

FOUND_M = 0.3
"""A pose is the operator's if the middle of its hips lies within this of the operator's true one."""


@dataclass(frozen=True, slots=True)
class Moment:
    """One frame, judged."""

    time_s: float
    handed: bool
    off_m: float
    """From the handed pose's hips to the operator's; infinite if nothing was handed on."""
    others_m: float
    """To the nearest passer-by's; infinite if there is none or nothing was handed on."""
    visible: bool
    """Nobody stands before the operator's trunk, and it is in the picture."""
    ms: float

    @property
    def right(self) -> bool:
        """The operator's pose was handed on."""
        return self.off_m < FOUND_M

    @property
    def of_passerby(self) -> bool:
        """Somebody else's pose was handed on."""
        return self.handed and self.others_m < self.off_m


class Mute:
    """A recogniser that never understands anything: the drone only follows."""

    def recognise(self, clip: Clip) -> Gesture:
        """Refuse."""
        return Gesture(None, 0.0)


def play(
    staged: Staged, estimator: PoseEstimator, clock: Callable[[], float] = time.thread_time
) -> Iterator[tuple[Frame, Moment]]:
    """Play a session through the chain and judge every frame.

    Args:
        staged: The session.
        estimator: The chain from pixels to pose; it is reset first.
        clock: Processor seconds of this thread.
    """
    estimator.reset()
    world = staged.world
    timed = _Timed(estimator, clock)
    pilot = None
    if staged.condition.follows:
        pilot = Pilot(timed, Mute(), world.vehicle, config=following(staged.distance_m))
    for _ in range(int(staged.duration_s * world.config.rate_hz)):
        frame = world.step()
        pose = pilot.step(frame, world.now_ns).pose if pilot is not None else timed(frame)
        yield frame, _judge(pose, world.truth, frame.intrinsics, timed.ms)


def following(distance_m: float) -> PilotConfig:
    """Return the settings of a flight that keeps a distance, also one beyond what operators can ask for."""
    usual = PilotConfig()
    bounds, limits = usual.movement, usual.supervisor
    return replace(
        usual,
        goal=replace(usual.goal, distance_m=distance_m, altitude_m=1.3),
        movement=replace(bounds, max_distance_m=max(bounds.max_distance_m, distance_m)),
        supervisor=replace(limits, max_distance_m=max(limits.max_distance_m, distance_m + 2.0)),
    )


class _Timed:
    """A pose source that says how long it took."""

    def __init__(self, estimator: PoseEstimator, clock: Callable[[], float]) -> None:
        self._estimator, self._clock = estimator, clock
        self.ms = 0.0

    def __call__(self, frame: Frame) -> Pose | None:
        began = self._clock()
        pose = self._estimator(frame)
        self.ms = 1e3 * (self._clock() - began)
        return pose


def _judge(pose: Pose | None, truth: Truth, k: Intrinsics, ms: float) -> Moment:
    mine = truth.hip_center_camera_m
    others = truth.camera.to_camera(truth.other_hip_centers_m)
    off = others_off = float("inf")
    if pose is not None:
        off = float(np.linalg.norm(pose.hip_center - mine))
        if len(others):
            others_off = float(np.linalg.norm(others - pose.hip_center, axis=1).min())
    return Moment(truth.stamp_ns * 1e-9, pose is not None, off, others_off, _visible(mine, others, k), ms)


def _visible(mine: Float[np.ndarray, " 3"], others: Float[np.ndarray, "others 3"], k: Intrinsics) -> bool:
    """Say whether a trunk of 0.4 m is in the picture, clear of everybody nearer, who is 0.5 m wide."""
    u = float(k.project(mine)[0])
    half = k.fx * 0.2 / float(mine[2])
    if not half < u < k.width - half:
        return False
    for other in others:
        if 0.3 < other[2] < mine[2]:
            gap = abs(float(k.project(other)[0]) - u)
            if gap < half + k.fx * 0.25 / float(other[2]):
                return False
    return True


def summarise(staged: Staged, moments: Sequence[Moment]) -> dict[str, Any]:
    """Reduce a session to a record."""
    after = [m for m in moments if m.time_s >= staged.engaged_s]
    shown = [m for m in after if m.visible]
    kept, back = 0, []
    patience_s = staged.condition.patience_s
    for begin, end in staged.windows:
        window = [m for m in after if begin <= m.time_s < end + patience_s]
        late = [m for m in window if m.time_s >= end]
        kept += any(m.right for m in late) and not any(m.of_passerby for m in window)
        back += _returns_s(window)
    record = {
        "condition": staged.condition.name,
        "distance_m": staged.distance_m,
        "crossings": len(staged.windows),
        "kept": kept,
        "engaged": any(m.right for m in after),
        "frames": len(after),
        "frames_visible": len(shown),
        "frames_operator_pct": 100.0 * float(np.mean([m.right for m in shown])) if shown else 0.0,
        "frames_of_passerby": sum(m.of_passerby for m in moments),
        "frames_elsewhere": sum(m.handed and not m.right and not m.of_passerby for m in moments),
        "reacquired_s_median": float(np.median(back)) if back else None,
        "reacquired_s_max": max(back) if back else None,
        "ms_median": float(np.median([m.ms for m in after])),
        "ms_mean": float(np.mean([m.ms for m in after])),
        "ms_p95": float(np.percentile([m.ms for m in after], 95)),
    }
    return {key: round(v, 3) if isinstance(v, float) else v for key, v in record.items()}


def _returns_s(window: Sequence[Moment]) -> list[float]:
    """Return, for each time the operator came into view, how long it took until they were handed on."""
    times: list[float] = []
    since: float | None = None
    hidden = False
    for moment in window:
        if not moment.visible:
            hidden, since = True, None
        elif hidden:
            hidden, since = False, moment.time_s
        if since is not None and moment.right:
            times.append(moment.time_s - since)
            since = None
    return times


def measure(
    condition: Condition, distance_m: float, events: int, seed: int, estimator: PoseEstimator
) -> dict[str, Any]:
    """Stage, play and summarise one session; see ``stage``."""
    staged = stage(condition, distance_m, events, seed)
    return summarise(staged, [moment for _, moment in play(staged, estimator)])


__all__ = ["Moment", "following", "measure", "play", "summarise"]
