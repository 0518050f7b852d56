"""A bad link: packets lost, late, doubled, out of order or damaged, by a seed."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np


@dataclass(slots=True)
class WireConfig:
    """How bad the link is; may be changed while it is used. Shares are of packets, 0 to 1."""

    delay_s: float = 0.003
    jitter_s: float = 0.001
    loss: float = 0.0
    late: float = 0.0
    """Share that comes ``late_s`` later, behind what was sent after it."""
    late_s: float = 0.4
    twice: float = 0.0
    damaged: float = 0.0
    cut: bool = False
    """Nothing passes."""


class Wire:
    """One direction of a link.

    Args:
        config: How bad it is.
        seed: Draws what happens to each packet.

    Example:
        >>> wire = Wire(WireConfig(delay_s=0.1, jitter_s=0.0))
        >>> wire.send(b"hello", 1.0)
        >>> wire.arrived(1.05), wire.arrived(1.11)
        ([], [b'hello'])
    """

    def __init__(self, config: WireConfig | None = None, seed: int = 0) -> None:
        self.config = config or WireConfig()
        self._rng = np.random.default_rng([seed, 0x317E])
        self._count = 0
        self._under_way: list[tuple[float, int, bytes]] = []

    def send(self, packet: bytes, now_s: float) -> None:
        """Put a packet on its way."""
        c, draw = self.config, self._rng.random(5)
        if c.cut or draw[0] < c.loss:
            return
        at_s = now_s + c.delay_s + c.jitter_s * draw[1] + (c.late_s if draw[2] < c.late else 0.0)
        if draw[3] < c.damaged:
            where = int(self._rng.integers(len(packet)))
            packet = packet[:where] + bytes([packet[where] ^ 0x5A]) + packet[where + 1 :]
        for _ in range(2 if draw[4] < c.twice else 1):
            self._count += 1
            heapq.heappush(self._under_way, (at_s, self._count, packet))

    def arrived(self, now_s: float) -> list[bytes]:
        """Return what has come by now, in the order of its arrival."""
        packets = []
        while self._under_way and self._under_way[0][0] <= now_s:
            packets.append(heapq.heappop(self._under_way)[2])
        return packets
