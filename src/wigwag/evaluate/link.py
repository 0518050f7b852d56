"""How evenly set-points leave, and how soon after they were decided, through a real UDP socket."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import socket
import struct
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint
from wigwag.vehicles.mavlink import MavlinkConfig, MavlinkVehicle
from wigwag.vehicles.mavlink.links import UdpLink
from wigwag.vehicles.mavlink.vehicle import SENDER_PRIORITY

_RATE_HZ = 30.0
_STEP_M_S = 1e-4
"""Every decision asks for another speed by this, so that it is known again on the wire."""
_SETTLE_S = 2.0
_SO_TIMESTAMPNS = 35
"""Linux; Python has no name for it."""


@dataclass(frozen=True, slots=True)
class LinkFigures:
    """What was measured at the other end of the link. Milliseconds."""

    load: str
    """What the loop did beside."""
    setpoints: int
    rate_hz: float
    jitter_p50_ms: float
    """Of the interval between two set-points, against 1/30 s."""
    jitter_p99_ms: float
    jitter_max_ms: float
    decision_p50_ms: float
    """From a decision to the first set-point on the wire that obeys it, or a later one."""
    decision_p99_ms: float
    decision_max_ms: float
    loop_p50_ms: float
    """What a turn of the loop took."""
    machine_p99_ms: float
    """How late the machine itself woke a bare process of the same priority, that only slept, at the same
    time: no program on it can be more even."""
    machine_max_ms: float

    def row(self) -> dict[str, Any]:
        """Return the record."""
        return asdict(self)


def measure_link(seconds: float, work: Callable[[], object], load: str) -> LinkFigures:
    """Fly a fake ArduPilot, which lives in a process of its own, and note when set-points come there.

    Args:
        seconds: How long.
        work: What the loop does in each of its turns before it decides.
        load: What that is called.

    Raises:
        InputError: Elsewhere than on Linux.
    """
    if not sys.platform.startswith("linux"):
        raise InputError("wigwag benchmark link stamps packets in the Linux kernel: it needs Linux.")
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    port = _free_port()
    vehicle = MavlinkVehicle(UdpLink("127.0.0.1", port, listen=True), MavlinkConfig(rate_hz=_RATE_HZ))
    process = context.Process(target=_other_end, args=(there, port), daemon=True)
    process.start()
    ours, theirs = context.Pipe()
    sleeper = context.Process(target=_sleep, args=(theirs,), daemon=True)
    sleeper.start()
    try:
        vehicle.connect()
        decided, turns = _fly(vehicle, seconds, work)
    finally:
        vehicle.close()
        here.send("enough")
        arrived = here.recv() if here.poll(10.0) else []
        ours.send("enough")
        woken = ours.recv() if ours.poll(10.0) else []
        process.join(5.0)
        sleeper.join(5.0)
    came = np.array(arrived, float).reshape(-1, 2)
    return _figures(came, np.array(decided), np.array(turns), np.array(woken).reshape(-1, 2), load)


def _fly(
    vehicle: MavlinkVehicle, seconds: float, work: Callable[[], object]
) -> tuple[list[tuple[float, float]], list[float]]:
    """Run the loop at 30 Hz; return when each speed was decided, and how long the turns took."""
    decided: list[tuple[float, float]] = []
    turns = []
    pause = threading.Event()
    began = due = time.monotonic()
    while time.monotonic() - began < seconds:
        turn = time.monotonic()
        work()
        speed = 0.2 + len(decided) * _STEP_M_S
        now_ns = time.monotonic_ns()
        vehicle.send(Setpoint((speed, 0.0, 0.0)), now_ns)
        decided.append((now_ns * 1e-9, speed))
        turns.append(time.monotonic() - turn)
        due = max(due + 1 / _RATE_HZ, time.monotonic())
        pause.wait(due - time.monotonic())
    return decided, turns


def _other_end(pipe: Connection, port: int) -> None:
    """Be an ArduPilot that hovers already, until told that it is enough; tell what came and when."""
    from wigwag.sim.autopilot_config import FakeConfig
    from wigwag.sim.autopilots import FakeArduPilot
    from wigwag.sim.pointmass import PointMass

    fake = FakeArduPilot(
        FakeConfig(settle_s=0.1, radius_m=1e6, ceiling_m=1e6), PointMass(position_m=(0.0, 0.0, 3.0))
    )
    fake.armed, fake.origin, fake.mode = True, True, fake.GUIDED
    fake.now_s = fake.booted_s = time.monotonic()
    came: list[tuple[float, float]] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.bind(("127.0.0.1", 0))
        wire.settimeout(0.005)
        wire.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        ahead_s = time.time() - time.monotonic()
        while not pipe.poll():
            known = len(fake.received)
            with contextlib.suppress(TimeoutError, ConnectionRefusedError):
                data, control, _, _ = wire.recvmsg(4096, 64)
                fake.receive(data)
                # When the kernel got it, not when this process was let run.
                seconds, nanoseconds = struct.unpack("qq", control[0][2][:16])
                at_s = seconds + nanoseconds * 1e-9 - ahead_s
                came += [(at_s, message.vx) for _, message in fake.received[known:]]
            for packet in fake.step(time.monotonic()):
                with contextlib.suppress(ConnectionRefusedError):
                    wire.sendto(packet, ("127.0.0.1", port))
    pipe.send(came)


def _sleep(pipe: Connection) -> None:
    """Do nothing at 30 Hz until told that it is enough; tell when it was woken, and how much too late."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(SENDER_PRIORITY))
    woken: list[tuple[float, float]] = []
    due_s = time.monotonic()
    while not pipe.poll():
        due_s = max(due_s + 1 / _RATE_HZ, time.monotonic())
        time.sleep(max(0.0, due_s - time.monotonic()))
        now_s = time.monotonic()
        woken.append((now_s, now_s - due_s))
    pipe.send(woken)


def _figures(
    arrived: np.ndarray, decided: np.ndarray, turns: np.ndarray, woken: np.ndarray, load: str
) -> LinkFigures:
    """Compare what came with what was decided, the first two seconds left out."""
    arrived = arrived[arrived[:, 1] > 0.1]  # standing still at the end is another matter
    since = arrived[0, 0] + _SETTLE_S
    arrived, decided = arrived[arrived[:, 0] > since], decided[decided[:, 0] > since]
    jitter = np.abs(np.diff(arrived[:, 0]) - 1 / _RATE_HZ) * 1e3
    newest = np.maximum.accumulate(arrived[:, 1])
    obeyed = np.searchsorted(newest, decided[:, 1] - _STEP_M_S / 2)
    known = obeyed < len(arrived)
    waited = (arrived[obeyed[known], 0] - decided[known, 0]) * 1e3
    late = woken[(woken[:, 0] > since) & (woken[:, 0] < arrived[-1, 0]), 1] * 1e3
    jitters = [float(v) for v in np.percentile(jitter, (50, 99, 100))]
    waits = [float(v) for v in np.percentile(waited, (50, 99, 100))]
    return LinkFigures(
        load=load,
        setpoints=len(arrived),
        rate_hz=float(1 / np.mean(np.diff(arrived[:, 0]))),
        jitter_p50_ms=jitters[0],
        jitter_p99_ms=jitters[1],
        jitter_max_ms=jitters[2],
        decision_p50_ms=waits[0],
        decision_p99_ms=waits[1],
        decision_max_ms=waits[2],
        loop_p50_ms=float(np.median(turns)) * 1e3,
        machine_p99_ms=float(np.percentile(late, 99)) if len(late) else float("nan"),
        machine_max_ms=float(late.max()) if len(late) else float("nan"),
    )


def pose_work() -> Callable[[], object]:
    """Return what finds the operator in the next of some simulated pictures: the pose network's own work."""
    from itertools import cycle

    from wigwag.cameras import open_camera
    from wigwag.pose.blazepose import BlazePose

    with open_camera("sim:?duration_s=1&noise=0") as camera:
        pictures = cycle([frame.rgb for frame in camera])
    network = BlazePose()
    return lambda: network.detect(next(pictures))


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


__all__ = ["LinkFigures", "measure_link", "pose_work"]
