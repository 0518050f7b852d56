"""A PX4 or ArduPilot multirotor over MAVLink: two threads around a session."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable

from wigwag.errors import VehicleError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.vehicles.calm import calm
from wigwag.vehicles.mavlink.config import MavlinkConfig
from wigwag.vehicles.mavlink.links import Link
from wigwag.vehicles.mavlink.session import Session
from wigwag.vehicles.protocol import Capabilities, FlightMode

_FIND_S, _SETTLE_S, _REOPEN_S, _JOIN_S = 15.0, 30.0, 0.5, 2.0
SENDER_PRIORITY = 10
"""Of the sending thread, where the system grants real-time scheduling (SCHED_FIFO)."""


class MavlinkVehicle:
    """A ``Vehicle`` that is an autopilot.

    One thread reads; one thread alone writes, and what it writes is decided by ``Session``: a set-point that
    is not renewed in time gives way to standing still, then to holding, whatever else this process does.
    No request waits for the autopilot.

    Args:
        link: The wire.
        config: How the autopilot is talked to.
        clock: Monotonic nanoseconds, the clock of all stamps.
        wall_clock: Seconds since 1970, for signatures only.
        find_s: How long ``connect`` looks for an autopilot.
        settle_s: How long ``connect`` then waits for a position; without one it returns all the same, and
            ``state`` says so.

    Example:
        >>> from wigwag.vehicles.mavlink.links import link_of
        >>> vehicle = MavlinkVehicle(link_of("udp:127.0.0.1:14550"))
        >>> vehicle.mode
        <FlightMode.DISARMED: 'disarmed'>
    """

    def __init__(
        self, link: Link, config: MavlinkConfig | None = None, *,
        clock: Callable[[], int] = time.monotonic_ns, wall_clock: Callable[[], float] = time.time,
        find_s: float = _FIND_S, settle_s: float = _SETTLE_S,
    ) -> None:  # fmt: skip
        self.link, self.clock = link, clock
        self.session = Session(config, wall_clock())
        self._find_s, self._settle_s = find_s, settle_s
        self._lock = threading.Lock()
        self._wake, self._closing, self._news = threading.Event(), threading.Event(), threading.Event()
        self._threads: list[threading.Thread] = []
        self._broken = ""

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        with self._lock:
            return self.session.mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        with self._lock:
            return self.session.capabilities

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is set on it in a way that is unwise."""
        with self._lock:
            return self.session.warnings

    @property
    def state(self) -> VehicleState:
        """What it says of itself; a link that is lost shows in the ages."""
        with self._lock:
            return self.session.state(self.clock())

    def connect(self) -> None:
        """Open the link, find the autopilot, agree on messages, read its settings.

        Raises:
            VehicleError: If the link cannot be opened or no autopilot that can be flown answers.
        """
        if self._threads:
            return
        self.link.open()
        calm()
        for name, work in (("mavlink-read", self._read), ("mavlink-send", self._send)):
            thread = threading.Thread(target=work, name=name, daemon=True)
            self._threads.append(thread)
            thread.start()
        if not self._until(lambda: self.session.talk.autopilot is not None, self._find_s):
            self._give_up("no autopilot answers")
        if not self._until(lambda: self.session.ready, 2 * self._find_s):
            self._give_up("the autopilot is heard, but answers nothing")
        self._until(lambda: self.session.talk.telemetry.position.stamp_ns > 0, self._settle_s)

    def close(self) -> None:
        """Let go: steered, it is told to hold, and that is waited for a second at most."""
        if not self._threads:
            return
        if self.mode is FlightMode.STEERED and self.hold():
            self._until(lambda: self.session.mode is not FlightMode.STEERED, 1.0)
        self._closing.set()
        self._wake.set()
        for thread in self._threads:
            thread.join(_JOIN_S)
        self._threads = []
        self.link.close()

    def beat(self, now_ns: int) -> None:
        """Say that the loop is alive."""
        with self._lock:
            self.session.beat(now_ns)

    def arm(self) -> bool:
        """Ask it to unlock the propellers."""
        calm()  # whatever was loaded since it was connected
        return self._request(self.session.arm)

    def take_off(self, height_m: float = 1.5) -> bool:
        """Ask it to climb to a height above where it stands and hold.

        Raises:
            InputError: If the height is not positive.
        """
        return self._request(lambda now: self.session.take_off(height_m, now))

    def land(self) -> bool:
        """Ask it to come down where it is."""
        return self._request(self.session.land)

    def hold(self) -> bool:
        """Ask it to stop and hover."""
        return self._request(self.session.hold)

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Hand over a set-point computed at ``stamp_ns``; it leaves within 1/30 s."""
        with self._lock:
            return not self._broken and self.session.send(setpoint, stamp_ns, self.clock())

    def _request(self, ask: Callable[[int], bool]) -> bool:
        with self._lock:
            accepted = not self._broken and ask(self.clock())
        self._wake.set()
        return accepted

    def _until(self, true: Callable[[], bool], seconds: float) -> bool:
        """Wait for something the autopilot tells; the caller is alive meanwhile."""
        end = self.clock() + int(seconds * 1e9)
        while self.clock() < end:
            with self._lock:
                self.session.beat(self.clock())
                if true():
                    return True
            self._news.wait(0.05)
            self._news.clear()
        return False

    def _give_up(self, what: str) -> None:
        with self._lock:
            seen = self.session.talk.passed_over
            damaged = self.session.talk.broken
        seen = f" Heard: {seen}." if seen else ""
        if damaged and not seen:
            seen = f" {damaged} packets came damaged, or signed with another key."
        self.close()
        raise VehicleError(
            f"{self.link.name}: {what}.{seen} Is the autopilot switched on, sending there, at this baud rate?"
        )

    def _read(self) -> None:
        while not self._closing.is_set():
            try:
                data = self.link.read()
            except VehicleError as error:
                self._lost(str(error))
                continue
            if data:
                with self._lock:
                    self.session.receive(data, self.clock())
                self._news.set()

    def _lost(self, why: str) -> None:
        """Open the link again, once a while."""
        with self._lock:
            self.session.trouble = why
        if self._closing.wait(_REOPEN_S):
            return
        try:
            self.link.open()
        except VehicleError:
            return
        with self._lock:
            self.session.trouble = ""

    def _send(self) -> None:
        if hasattr(os, "sched_setscheduler"):
            with contextlib.suppress(OSError):
                os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(SENDER_PRIORITY))
        try:
            while not self._closing.is_set():
                with self._lock:
                    packets, due_ns = self.session.tick(self.clock()), self.session.due_ns
                try:
                    for packet in packets:
                        self.link.write(packet)
                except VehicleError:
                    pass  # the reading thread finds out, too, and opens the link again
                self._wake.wait(max(0.0, (due_ns - self.clock()) * 1e-9))
                self._wake.clear()
        except Exception as error:
            # Whatever it is, nothing leaves from here on: the autopilot's own time-out does the rest.
            with self._lock:
                self._broken = self.session.trouble = f"the sender stopped: {error!r}"
            raise
