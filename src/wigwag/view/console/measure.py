"""What the console costs the loop: turns of the whole chain with nobody, and with many, looking on."""

from __future__ import annotations

import asyncio
import multiprocessing
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from statistics import median
from typing import Any

import numpy as np

from wigwag.errors import InputError, ViewError
from wigwag.extras import load
from wigwag.fly.values import Command
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot
from wigwag.recognise.explain import Example, Explanation
from wigwag.rig import Rig
from wigwag.skeleton import N_LANDMARKS, Clip, Pose
from wigwag.view.console.console import Console
from wigwag.view.onlookers import Onlookers

LOADS = ("nobody", "viewers")
"""Who looks on while it is measured, one after the other, again and again."""
_CONNECT_S = 60.0
_FRAMES = 20
"""Of a movement, as recognisers compare it."""


class Asker:
    """Stands where gestures are spotted: asks for a take-off, then lets the drone fly round the operator."""

    def __init__(self) -> None:
        self._said = 0

    def update(self, pose: Pose | None) -> Gesture | None:
        """Say it once somebody has been seen for two seconds, and again a while later."""
        if pose is None:
            return None
        self._said += 1
        command = {60: Command.TAKE_OFF}.get(self._said, Command.ORBIT if self._said % 300 == 299 else None)
        if command is None:
            return None
        return Gesture(command.value, 1.0, pose.stamp_ns - 2 * 10**9, pose.stamp_ns, pose.stamp_ns)

    def explain(self) -> Explanation:
        """Say why, at the length at which a recogniser does: the page has it to draw, as in a flight."""
        views, movement = tuple(f"view {k}" for k in range(7)), np.zeros((_FRAMES, N_LANDMARKS, 3))
        path = np.repeat(np.arange(_FRAMES)[:, None], 2, axis=1)
        example = Example("orbit", "somebody's", 1.0, np.ones(len(views)), movement, path)
        said = Gesture("orbit", 1.0)
        return Explanation(
            said, "orbit", "up", 1.0, 0.5, 1.0, 1.0, views, np.ones(len(views)), 1, 100, (example,) * 3,
            movement, 2.0,
        )  # fmt: skip

    def reset(self) -> None:
        """Begin anew."""
        self._said = 0

    def recognise(self, clip: Clip) -> Gesture:
        """Refuse.

        Raises:
            InputError: Always.
        """
        raise InputError("Nothing is recognised here.")


@dataclass(frozen=True, slots=True)
class Load:
    """One load, over all rounds."""

    name: str
    turns: int
    rates_hz: tuple[float, ...]
    """Turns a second of the wall's clock, a value a round."""
    loop_ms: float
    """Processor milliseconds of the loop's own thread a turn, a median over the rounds."""
    process_ms: float
    """The same of the loop's whole process, with the thread that sends."""

    @property
    def rate_hz(self) -> float:
        """Turns a second, a median over the rounds."""
        return median(self.rates_hz)

    def left_of(self, other: Load) -> float:
        """Return the share of another load's rate that is left: a median over the rounds, each by itself.

        Example:
            >>> alone, looked_at = Load("", 1, (10.0, 20.0, 40.0), 1, 1), Load("", 1, (9.0, 20.0, 30.0), 1, 1)
            >>> looked_at.left_of(alone)
            0.9
        """
        return median(self._shares_of(other))

    def interval_of(self, other: Load) -> tuple[float, float]:
        """Return the 95 % interval of ``left_of``: percentiles of 2000 draws of the rounds, seeded."""
        shares = np.array(self._shares_of(other))
        drawn = np.random.default_rng(0).choice(shares, (2000, len(shares)))
        low, high = np.percentile(np.median(drawn, axis=1), [2.5, 97.5])
        return float(low), float(high)

    def _shares_of(self, other: Load) -> list[float]:
        return [mine / theirs for mine, theirs in zip(self.rates_hz, other.rates_hz, strict=True)]


def measure(
    rig: Rig, pilot: Pilot, page: Console, *, viewers: int, rounds: int, turns: int,
    told: Callable[[int], None] = lambda number: None,
) -> list[Load]:  # fmt: skip
    """Fly a simulated rig as fast as it goes, under each load in turn.

    Args:
        rig: Camera and vehicle of one simulated world.
        pilot: The chain.
        page: The console.
        viewers: How many look on under the last load.
        rounds: How often each load comes.
        turns: Of the loop, each time.
        told: Is called before each round, with its number.
    """
    onlookers = Onlookers(None, page)
    onlookers.begin(pilot)  # as if live: nothing holds it to the wall's clock
    rows: dict[str, list[tuple[float, float, float]]] = {name: [] for name in LOADS}
    _fly(rig, pilot, onlookers, turns)
    # The viewers stay; without the console's part in the loop nothing is sent to them.
    with _looking(page.url, viewers):
        for number in range(rounds):
            told(number)
            for name in LOADS[::-1] if number % 2 else LOADS:  # what drifts, drifts against each of them
                rows[name].append(_fly(rig, pilot, onlookers if name == "viewers" else None, turns))
    loads = []
    for name, measured in rows.items():
        rates, loop_ms, process_ms = zip(*measured, strict=True)
        loads.append(Load(name, rounds * turns, rates, median(loop_ms), median(process_ms)))
    return loads


def _fly(rig: Rig, pilot: Pilot, onlookers: Onlookers | None, turns: int) -> tuple[float, float, float]:
    """Return turns a second, and milliseconds a turn of this thread and of this process."""
    wall, thread, process = time.perf_counter(), time.thread_time(), time.process_time()
    for _ in range(turns):
        frame = rig.camera.latest()
        now_ns = rig.now_ns()
        step = pilot.step(frame, now_ns, None if onlookers is None else onlookers.asked())
        if onlookers is not None:
            onlookers.turn(frame, step)
    spent_s = time.perf_counter() - wall
    return (
        turns / spent_s,
        1e3 * (time.thread_time() - thread) / turns,
        1e3 * (time.process_time() - process) / turns,
    )


@contextmanager
def _looking(url: str, viewers: int) -> Iterator[None]:
    """Let so many viewers look on, from a process of their own that takes all that is sent to them."""
    context = multiprocessing.get_context("spawn")
    link, theirs = context.Pipe()
    process = context.Process(target=look_on, args=(theirs, url, viewers), daemon=True)
    process.start()
    theirs.close()
    try:
        if not link.poll(_CONNECT_S) or link.recv() != viewers:
            raise ViewError(f"{viewers} viewers could not connect to {url}.")
        yield
        link.send(None)
        received = link.recv() if link.poll(_CONNECT_S) else []
        if len(received) != viewers or not all(received):
            raise ViewError(f"Of {viewers} viewers some were sent nothing: {received}.")
    finally:
        link.close()
        process.join(5.0)
        process.terminate()


def look_on(link: Connection, url: str, viewers: int) -> None:
    """Connect as browsers do, take everything, and say in the end how many messages each was sent."""
    asyncio.run(_look_on(link, url, viewers))


async def _look_on(link: Connection, url: str, viewers: int) -> None:
    client: Any = load("websockets.asyncio.client", "console", "The console")
    version = load("viser", "console", "The console").__version__
    target = url.replace("http", "ws", 1)
    received = [0] * viewers
    sockets = [
        await client.connect(target, subprotocols=[f"viser-v{version}"], max_size=None, compression=None)
        for _ in range(viewers)
    ]

    async def take(number: int) -> None:
        async for _ in sockets[number]:
            received[number] += 1

    for number, socket in enumerate(sockets):  # the page as it is, which everybody is sent first
        await socket.recv()
        received[number] += 1
    tasks = [asyncio.create_task(take(number)) for number in range(viewers)]
    link.send(len(sockets))
    await asyncio.get_running_loop().run_in_executor(None, link.recv)
    for task in tasks:
        task.cancel()
    link.send(received)


__all__ = ["LOADS", "Asker", "Load", "look_on", "measure"]
