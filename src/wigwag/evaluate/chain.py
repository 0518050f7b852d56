"""From a camera's frame to the operator's 3-D pose: how fast, how late, in how much memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from wigwag.camera.frame import Frame
from wigwag.camera.live import LiveCamera
from wigwag.camera.paced import Paced
from wigwag.errors import WigwagError
from wigwag.evaluate.pictures import Endless, deserted, moving
from wigwag.evaluate.threads import one_core
from wigwag.pose.body import Body
from wigwag.pose.engine import EngineName, ModelName, Picture, PoseEngine, open_engine
from wigwag.pose.estimator import PoseConfig, PoseEstimator

FAST_HZ, SLOW_HZ = 120.0, 15.0
"""A camera, and an engine that cannot keep up with it."""

FAR_M = 9.0
"""Where a person is too small to be found in the full frame."""

_RENDERED_S = 3.0
_ROUNDS = 5
"""So often memory is measured over the same frames."""

Progress = Callable[[str, int, int], None]


@dataclass(slots=True)
class Measured:
    """One line of the account."""

    measure: str
    """What was measured."""
    ms: list[float] = field(default_factory=list)
    """Of each frame: processor time, or age."""
    expected: str = ""
    """What the figures should be."""
    skipped: int | None = None
    """Frames that a newer one replaced."""
    rss_mb: float | None = None
    """The most memory the process held."""
    grown_mb: float | None = None
    """How much more it held after the last round than after the first."""

    def row(self) -> dict[str, Any]:
        """Return a flat record. ``frames_per_s`` is of one core, where processor time was measured."""
        figures = {
            name: round(float(np.percentile(self.ms, share)), 2) if self.ms else None
            for name, share in (("ms_median", 50), ("ms_p95", 95), ("ms_max", 100))
        }
        rate = (
            round(1e3 * len(self.ms) / sum(self.ms), 1) if self.ms and "frames/s" in self.expected else None
        )
        return {
            "measure": self.measure,
            "expected": self.expected,
            "frames": len(self.ms),
            "frames_per_s": rate,
            **figures,
            "skipped": self.skipped,
            "rss_mb": self.rss_mb,
            "grown_mb": self.grown_mb,
        }


@dataclass(frozen=True, slots=True)
class EngineChoice:
    """Which engine is measured, here and in another process."""

    name: EngineName = "litert"
    model: ModelName = "full"
    models_dir: Path | None = None

    def open(self) -> PoseEngine:
        """Make it."""
        return open_engine(self.name, self.model, self.models_dir)


def measure_chain(
    choice: EngineChoice, seconds: float, seed: int, progress: Progress = lambda what, done, total: None
) -> Iterator[Measured]:
    """Measure everything, on one core.

    Args:
        choice: Of the engine.
        seconds: Of stream for each figure.
        seed: Of the rendered people and surroundings.
        progress: Called with what is being done, frames done and in all.
    """
    with one_core():
        engine = choice.open()
        frames = list(moving(_RENDERED_S, seed))
        n = round(30 * seconds)

        def watched(shown: Iterable[Frame], what: str, total: int = n) -> Iterator[Frame]:
            for done, frame in enumerate(shown):
                progress(what, done, total)
                yield frame

        PoseEstimator(PoseConfig.alone(), tracker=engine)(frames[0])  # compiles
        yield following(engine, watched(moving(seconds, seed), "following"))
        yield searching(engine, watched(deserted(seconds, seed), "searching"), "searching, nobody there")
        far = moving(seconds, seed, FAR_M)
        yield searching(engine, watched(far, "searching, far"), f"searching, somebody at {FAR_M:g} m")
        yield lateness(engine, frames, 30.0, n, lambda done: progress("latency", done, n))
        yield besides(engine, frames)
        n_slow = round(SLOW_HZ * seconds)
        yield lateness(
            Slowed(engine, 1 / SLOW_HZ), frames, FAST_HZ, n_slow, lambda done: progress("slow", done, n_slow)
        )
    yield memory(frames, choice)


def following(
    engine: PoseEngine, frames: Iterable[Frame], clock: Callable[[], float] = time.process_time
) -> Measured:
    """Time frames in which the person is followed: there before, and there now."""
    measured = Measured("following", expected=">= 45 frames/s")
    estimator, before = PoseEstimator(PoseConfig.alone(), tracker=engine), False
    for frame in frames:
        began = clock()
        pose = estimator(frame)
        spent = clock() - began
        if before and pose is not None:
            measured.ms.append(1e3 * spent)
        before = pose is not None
    return measured


def searching(
    engine: PoseEngine, frames: Iterable[Frame], what: str, clock: Callable[[], float] = time.process_time
) -> Measured:
    """Time frames in which nobody is followed yet; whoever is found is forgotten, and looked for again."""
    measured = Measured(what, expected=">= 20 frames/s")
    estimator = PoseEstimator(PoseConfig.alone(), tracker=engine)
    for frame in frames:
        began = clock()
        estimator(frame)
        measured.ms.append(1e3 * (clock() - began))
        if estimator.body is not None:
            estimator.reset()
    return measured


def besides(
    engine: PoseEngine, frames: Iterable[Frame], clock: Callable[[], float] = time.process_time
) -> Measured:
    """Time what the chain does besides the engine: so much older a pose is than the engine makes it."""
    measured = Measured("besides the engine", expected="added to the ages below")
    watch = _Watched(engine, clock)
    estimator = PoseEstimator(PoseConfig.alone(), tracker=watch)
    for frame in frames:
        watch.spent_s, began = 0.0, clock()
        estimator(frame)
        measured.ms.append(1e3 * (clock() - began - watch.spent_s))
    return measured


class _Watched:
    """A tracker of one body that knows how long it worked.

    Args:
        engine: What does the work.
        clock: Processor time, seconds.
    """

    def __init__(self, engine: PoseEngine, clock: Callable[[], float]) -> None:
        self._engine, self._clock = engine, clock
        self.spent_s = 0.0

    def track(self, rgb: Picture) -> Body | None:
        """As the engine does."""
        began = self._clock()
        body = self._engine.track(rgb)
        self.spent_s += self._clock() - began
        return body

    def reset(self) -> None:
        """As the engine does."""
        self._engine.reset()


class Slowed:
    """An engine that takes at least so long for a picture.

    Args:
        engine: What does the work.
        period_s: The least time.
        clock: Monotonic, seconds.
        wait: How to let time pass.
    """

    def __init__(
        self,
        engine: PoseEngine,
        period_s: float,
        clock: Callable[[], float] = time.monotonic,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self._engine, self.period_s, self._clock, self._wait = engine, period_s, clock, wait

    def detect(self, rgb: Picture) -> Body | None:
        """As the engine does, later."""
        return self._late(self._engine.detect, rgb)

    def track(self, rgb: Picture) -> Body | None:
        """As the engine does, later."""
        return self._late(self._engine.track, rgb)

    def reset(self) -> None:
        """As the engine does."""
        self._engine.reset()

    def _late(self, look: Callable[[Picture], Body | None], rgb: Picture) -> Body | None:
        until = self._clock() + self.period_s
        body = look(rgb)
        self._wait(max(0.0, until - self._clock()))
        return body


def lateness(
    engine: PoseEngine,
    frames: Sequence[Frame],
    rate_hz: float,
    count: int,
    progress: Callable[[int], None] = lambda done: None,
) -> Measured:
    """Play frames as a live camera does, in real time, and see how old each is when its pose is there."""
    measured = Measured(f"from stamp to pose, {rate_hz:g} Hz", expected="<= 30 ms median")
    if isinstance(engine, Slowed):
        bound_ms = 1e3 * (engine.period_s + 1 / rate_hz)
        measured.measure += f", engine at {1 / engine.period_s:.0f} Hz"
        measured.expected = f"<= {bound_ms:.0f} ms and the lifting, always"
    estimator = PoseEstimator(PoseConfig.alone(), tracker=engine)
    with LiveCamera(Paced(Endless(frames, rate_hz))) as camera:
        while len(measured.ms) < count:
            if (frame := camera.latest()) is not None:
                estimator(frame)
                measured.ms.append((time.monotonic_ns() - frame.stamp_ns) * 1e-6)
                progress(len(measured.ms))
        measured.skipped = camera.counts.skipped
    return measured


def memory(frames: Sequence[Frame], choice: EngineChoice | None = None) -> Measured:
    """Run the chain in a process of its own, from pictures on disk to poses, and ask what it held at most.

    Raises:
        WigwagError: If that process fails.
    """
    with tempfile.TemporaryDirectory(prefix="wigwag-") as folder:
        _write_pairs(Path(folder), frames)
        choice = choice or EngineChoice()
        command = [sys.executable, "-m", "wigwag.evaluate.memory", folder, str(_ROUNDS), choice.name]
        command += [choice.model, *([str(choice.models_dir)] if choice.models_dir else [])]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise WigwagError(f"The process whose memory is measured failed: {done.stderr.strip()[-500:]}")
    said = json.loads(done.stdout)
    return Measured(
        "memory of a process",
        expected="<= 350 MB",
        rss_mb=said["peak_mb"],
        grown_mb=round(said["rounds_mb"][-1] - said["rounds_mb"][0], 1),
    )


def _write_pairs(folder: Path, frames: Sequence[Frame]) -> None:
    lens = frames[0].intrinsics
    names = ("fx", "fy", "cx", "cy", "width", "height")
    (folder / "camera.json").write_text(json.dumps({"color": {name: getattr(lens, name) for name in names}}))
    for part in ("color", "depth"):
        (folder / part).mkdir()
    for k, frame in enumerate(frames):
        cv2.imwrite(str(folder / "color" / f"{k:04}.png"), frame.rgb[:, :, ::-1])
        cv2.imwrite(str(folder / "depth" / f"{k:04}.png"), frame.depth_mm)


__all__ = [
    "EngineChoice",
    "Measured",
    "Slowed",
    "besides",
    "following",
    "lateness",
    "measure_chain",
    "memory",
    "searching",
]
