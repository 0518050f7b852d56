"""A fake autopilot on a UDP port, in real time: what a program is tried against that opens a real address."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable
from types import TracebackType

from wigwag.sim.autopilot import FakeAutopilot

_TURN_S = 0.005


class AutopilotServer:
    """Lets a fake autopilot live on the clock, and talk to a UDP address as a simulator does.

    Args:
        autopilot: The fake; read or set it under ``lock`` while it runs.
        to: Where it sends: host and port of who listens.
        clock: Monotonic seconds.

    Example:
        >>> from wigwag.sim.autopilots import FakePx4
        >>> with AutopilotServer(FakePx4(), ("127.0.0.1", 14999)) as server:
        ...     server.autopilot.armed
        False
    """

    def __init__(
        self, autopilot: FakeAutopilot, to: tuple[str, int], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.autopilot, self.lock = autopilot, threading.Lock()
        self._to, self._clock = to, clock
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(_TURN_S)
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="fake-autopilot", daemon=True)

    @property
    def now_s(self) -> float:
        """The time on the autopilot's clock, which is the host's monotonic one."""
        return self._clock()

    def __enter__(self) -> AutopilotServer:
        """Start it."""
        self.autopilot.now_s = self.autopilot.booted_s = self._clock()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop it."""
        self._ending.set()
        self._thread.join()
        self._socket.close()

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                data = self._socket.recv(4096)
            except (TimeoutError, ConnectionRefusedError):
                data = b""
            with self.lock:
                now_s = self._clock()
                packets = self.autopilot.step(now_s)
                if data:
                    self.autopilot.receive(data)
            for packet in packets:
                with contextlib.suppress(ConnectionRefusedError):  # nobody listens yet
                    self._socket.sendto(packet, self._to)
