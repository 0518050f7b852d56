"""What recording a flight costs, how large it gets, and what a kill at a random moment takes away."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.camera.frame import Frame
from wigwag.cameras import open_camera
from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.values import Command
from wigwag.record.container import library
from wigwag.record.flight import Flight
from wigwag.record.recorder import Recorder
from wigwag.record.repair import is_whole, repair, wait_until_written
from wigwag.record.replay import Comparison, Replay
from wigwag.record.turns import Pictures
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld

_RATE_HZ = 30.0
_SAID = {45: Command.TAKE_OFF, 240: Command.LEFT, 420: Command.RIGHT}
"""What is commanded in which turn, so that there is something to decide."""


def pictures(seconds: float = 3.0, seed: int = 1) -> list[Frame]:
    """Return what the simulated camera sees: 640x480, with a sensor's noise, and depth."""
    frames = []
    with open_camera(f"sim:?duration_s={seconds:g}&seed={seed}") as camera:
        while not camera.ended:
            if (frame := camera.latest()) is not None:
                frames.append(frame)
    return frames


def _flight(seed: int) -> PromptedFlight:
    airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), seed)
    return PromptedFlight(SketchWorld(airframe, lambda t: (4.5, 0.3), seed=seed))


@dataclass(frozen=True, slots=True)
class Cost:
    """What a recorded flight costs."""

    pictures: str
    depth: bool
    seconds: float
    """Of flight."""
    mb: float
    loop_ms_mean: float
    """Processor time of the thread that flies, a frame."""
    loop_ms_p99: float
    writer_ms_mean: float
    """Processor time of the thread that writes, a frame."""

    @property
    def mb_ten_minutes(self) -> float:
        """Size of ten minutes."""
        return self.mb * 600.0 / self.seconds


def measure_cost(
    folder: Path,
    frames: Sequence[Frame],
    seconds: float,
    *,
    kept: Pictures = "jpeg",
    depth: bool = False,
    seed: int = 0,
    progress: Callable[[float], None] = lambda done_s: None,
) -> Cost:
    """Write a flight of so many seconds at 30 Hz, the frames again and again, as fast as it goes.

    Raises:
        InputError: If the file cannot be written.
    """
    flown, path = _flight(seed), folder / "cost.mcap"
    recorder = Recorder(path, flown.pilot, pictures=kept, depth=depth, patient=True)
    spent, others_s = [], 0.0
    began = time.process_time()
    for turn in range(round(seconds * _RATE_HZ)):
        before = time.thread_time()
        step = flown.turn(_SAID.get(turn))
        frame = replace(frames[turn % len(frames)], stamp_ns=flown.world.now_ns)
        between = time.thread_time()
        recorder.turn(frame, flown.world.now_ns, step)
        spent.append(1e3 * (time.thread_time() - between))
        others_s += between - before
        if turn % 300 == 0:
            progress(turn / _RATE_HZ)
    recorder.close()
    writer_s = time.process_time() - began - others_s - 1e-3 * sum(spent)
    cost = Cost(
        kept, depth, seconds, path.stat().st_size / 1e6, float(np.mean(spent)),
        float(np.percentile(spent, 99)), 1e3 * writer_s / len(spent),
    )  # fmt: skip
    path.unlink()
    return cost


@dataclass(frozen=True, slots=True)
class Kill:
    """What one kill -9 left."""

    after_s: float
    """Wall clock from the first turn."""
    opens: bool
    """The ``mcap`` library's own reader reads it as it is, with all checksums."""
    whole: bool
    """It had its end; if not, it was repaired before it was read."""
    flown_turns: int
    kept_turns: int
    lost_s: float
    """From the last turn that is in the file to the last one flown."""
    same: bool
    """Decided again, every turn that was kept is decided alike."""


def kill_one(path: Path, frames: Sequence[Frame], after_s: float, depth: bool, seed: int) -> Kill:
    """Fly in a process of its own, in real time; kill it; read what is left.

    Args:
        path: Of the recording; removed afterwards.
        frames: Shown again and again.
        after_s: When it is killed, seconds of wall clock after its first turn.
        depth: Whether depth is kept too.
        seed: Of the flight.
    """
    reading, writing = os.pipe()
    # Forked, so that what was rendered and imported is there: nothing but the flight is what is killed.
    process = multiprocessing.get_context("fork").Process(
        target=_fly_on, args=(path, frames, depth, seed, writing), daemon=True
    )
    process.start()
    os.close(writing)
    flown = os.read(reading, 8)
    threading.Event().wait(after_s)
    os.kill(process.pid or 0, signal.SIGKILL)
    process.join()
    while part := os.read(reading, 1 << 16):
        flown += part
    os.close(reading)
    wait_until_written(path)
    stamps = np.frombuffer(flown[: len(flown) // 8 * 8], np.int64)
    whole, opens = is_whole(path), _opens(path)
    if not whole:
        repair(path)
        opens = opens and _opens(path)
    compared = Comparison()
    for then, now in Replay(Flight.open(path)):
        compared.note(then, now)
    kept_ns = round(compared.ended_s * 1e9) if compared.turns else int(stamps[0])
    path.unlink()
    lost_s = max(0.0, (int(stamps[-1]) - kept_ns) * 1e-9)
    return Kill(after_s, opens, whole, len(stamps), compared.turns, lost_s, compared.same)


def _fly_on(path: Path, frames: Sequence[Frame], depth: bool, seed: int, told: int) -> None:
    """Fly at 30 Hz without end, and tell every turn once it has been handed to the recorder."""
    flown, never = _flight(seed), threading.Event()
    recorder = Recorder(path, flown.pilot, depth=depth)
    turn = 0
    while True:
        began = time.monotonic()
        step = flown.turn(_SAID.get(turn))
        frame = replace(frames[turn % len(frames)], stamp_ns=flown.world.now_ns)
        recorder.turn(frame, flown.world.now_ns, step)
        os.write(told, flown.world.now_ns.to_bytes(8, "little"))
        turn += 1
        # A camera gives the newest frame after a stall, not all that were missed in a burst.
        never.wait(max(0.0, began + 1 / _RATE_HZ - time.monotonic()))


def _opens(path: Path) -> bool:
    """Say whether the library's own reader reads all of a file."""
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    library()
    try:
        with path.open("rb") as file:
            for _ in make_reader(file, validate_crcs=True).iter_messages():
                pass
    except (McapError, ValueError, RuntimeError, LookupError):
        return False
    return True


def measure_kills(
    folder: Path,
    frames: Sequence[Frame],
    count: int,
    seed: int = 0,
    progress: Callable[[int], None] = lambda done: None,
) -> list[Kill]:
    """Kill so many flights at random moments, every second one with depth recorded too."""
    rng, kills = np.random.default_rng([0x9, seed]), []
    for number in range(count):
        after_s = float(rng.uniform(0.0, 2.5))
        kills.append(kill_one(folder / "kill.mcap", frames, after_s, number % 2 == 1, seed + number))
        progress(number + 1)
    return kills


def account(kills: Sequence[Kill]) -> dict[str, Any]:
    """Return the figures of many kills."""
    lost = np.array([kill.lost_s for kill in kills])
    return {
        "kills": len(kills),
        "opened": sum(kill.opens for kill in kills),
        "needed_repair": sum(not kill.whole for kill in kills),
        "decided_alike": sum(kill.same for kill in kills),
        "lost_s_median": float(np.median(lost)),
        "lost_s_max": float(lost.max()),
        "lost_s": [round(float(s), 3) for s in lost],
        "turns_flown": sum(kill.flown_turns for kill in kills),
        "turns_kept": sum(kill.kept_turns for kill in kills),
    }


__all__ = ["Cost", "Kill", "account", "kill_one", "measure_cost", "measure_kills", "pictures"]
