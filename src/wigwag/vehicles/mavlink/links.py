"""The wire: UDP, TCP and serial lines, opened by name, closed and opened again when lost."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from typing import Any, Protocol

from wigwag.errors import InputError, VehicleError
from wigwag.extras import load

_WAIT_S = 0.1
_PEER_SILENT_NS = 2_000_000_000


class Link(Protocol):
    """Something that carries bytes both ways."""

    @property
    def name(self) -> str:
        """What it is. For people to read."""
        ...

    def open(self) -> None:
        """Open it, or open it again; raises ``VehicleError``."""
        ...

    def read(self) -> bytes:
        """Wait a tenth of a second at most for bytes; raises ``VehicleError`` if it is lost."""
        ...

    def write(self, packet: bytes) -> None:
        """Send one packet; raises ``VehicleError`` if it is lost. What cannot leave now is dropped."""
        ...

    def close(self) -> None:
        """Close it; more than once does no harm."""
        ...


class UdpLink:
    """UDP: listening for an autopilot to come, or going to meet it.

    Args:
        host: To listen at, or to go to.
        port: Likewise.
        listen: Which of the two.
        clock: Monotonic nanoseconds.
    """

    def __init__(
        self, host: str, port: int, listen: bool, clock: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._address, self._listen, self._clock = (host, port), listen, clock
        self._socket: socket.socket | None = None
        self._peer: tuple[str, int] | None = None if listen else self._address
        self._peer_ns = 0

    @property
    def name(self) -> str:
        """What it is."""
        return f"UDP {'at' if self._listen else 'to'} {self._address[0]}:{self._address[1]}"

    @property
    def port(self) -> int:
        """The port it has here."""
        return int(self._socket.getsockname()[1]) if self._socket else 0

    def open(self) -> None:
        """Open the socket."""
        self.close()
        try:
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            if self._listen:
                self._socket.bind(self._address)
            self._socket.settimeout(_WAIT_S)
        except OSError as error:
            self.close()
            raise VehicleError(
                f"{self.name}: cannot be opened ({error}). Is another program there?"
            ) from error

    def read(self) -> bytes:
        """Return the next packet. Listening, the first to speak is answered until it falls silent."""
        if self._socket is None:
            raise VehicleError(f"{self.name}: is closed.")
        try:
            data, peer = self._socket.recvfrom(4096)
        except (TimeoutError, ConnectionRefusedError):
            return b""
        except OSError as error:
            raise VehicleError(f"{self.name}: lost ({error}).") from error
        if not self._listen:
            return data
        now = self._clock()
        if self._peer is None or now - self._peer_ns > _PEER_SILENT_NS:
            self._peer = peer
        if peer != self._peer:
            return b""
        self._peer_ns = now
        return data

    def write(self, packet: bytes) -> None:
        """Send a packet, if somebody is known to be there."""
        if self._socket is None or self._peer is None:
            return
        try:
            self._socket.sendto(packet, self._peer)
        except (TimeoutError, BlockingIOError, ConnectionRefusedError):
            pass  # nobody there yet, or no room: the next one tells more
        except OSError as error:
            raise VehicleError(f"{self.name}: lost ({error}).") from error

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None


class TcpLink:
    """TCP, as simulators offer it. On a bad network UDP is better: TCP delivers late what is old.

    Args:
        host: To connect to.
        port: Likewise.
    """

    def __init__(self, host: str, port: int) -> None:
        self._address = (host, port)
        self._socket: socket.socket | None = None

    @property
    def name(self) -> str:
        """What it is."""
        return f"TCP to {self._address[0]}:{self._address[1]}"

    def open(self) -> None:
        """Connect."""
        self.close()
        try:
            self._socket = socket.create_connection(self._address, timeout=2.0)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)  # little room for what is old
            self._socket.settimeout(_WAIT_S)
        except OSError as error:
            self.close()
            raise VehicleError(f"{self.name}: cannot be reached ({error}).") from error

    def read(self) -> bytes:
        """Return what has come."""
        if self._socket is None:
            raise VehicleError(f"{self.name}: is closed.")
        try:
            data = self._socket.recv(4096)
        except TimeoutError:
            return b""
        except OSError as error:
            raise VehicleError(f"{self.name}: lost ({error}).") from error
        if not data:
            raise VehicleError(f"{self.name}: was closed by the other side.")
        return data

    def write(self, packet: bytes) -> None:
        """Send a packet."""
        if self._socket is None:
            return
        try:
            self._socket.sendall(packet)
        except OSError as error:  # a packet that left in part spoils what follows: begin anew
            raise VehicleError(f"{self.name}: lost ({error}).") from error

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None


class SerialLink:
    """A serial line: USB, UART or a telemetry radio.

    Args:
        device: Such as ``/dev/ttyACM0``.
        baud: Bits a second; without meaning over USB.
    """

    def __init__(self, device: str, baud: int) -> None:
        self._device, self._baud = device, baud
        self._serial: Any = None

    @property
    def name(self) -> str:
        """What it is."""
        return f"serial line {self._device} at {self._baud} baud"

    def open(self) -> None:
        """Open the device."""
        self.close()
        serial = load("serial", "mavlink", "A serial line")
        try:
            self._serial = serial.Serial(self._device, self._baud, timeout=_WAIT_S, write_timeout=_WAIT_S)
        except (OSError, ValueError) as error:
            raise VehicleError(
                f"{self.name}: cannot be opened ({error}). Is it plugged in, and may you use it (on Linux: "
                "are you in the group dialout)?"
            ) from error

    def read(self) -> bytes:
        """Return what has come."""
        if self._serial is None:
            raise VehicleError(f"{self.name}: is closed.")
        try:
            data = self._serial.read(max(1, min(self._serial.in_waiting, 4096)))
        except (OSError, TypeError) as error:  # pyserial: TypeError if closed meanwhile
            raise VehicleError(f"{self.name}: lost ({error}). Was it unplugged?") from error
        return bytes(data)

    def write(self, packet: bytes) -> None:
        """Send a packet."""
        if self._serial is None:
            return
        try:
            self._serial.write(packet)
        except (OSError, TypeError) as error:
            raise VehicleError(f"{self.name}: lost ({error}). Was it unplugged?") from error

    def close(self) -> None:
        """Close the device."""
        if self._serial is not None:
            self._serial.close()
        self._serial = None


def link_of(target: str, baud: int = 57600) -> Link:
    """Return the link that an address names, still closed.

    Args:
        target: ``udp:HOST:PORT`` or ``udpin:HOST:PORT`` listens, ``udpout:HOST:PORT`` and
            ``tcp:HOST:PORT`` go there, ``serial:DEVICE`` opens a device.
        baud: Of a serial line.

    Raises:
        InputError: If it names none.

    Example:
        >>> link_of("udp:127.0.0.1:14550").name
        'UDP at 127.0.0.1:14550'
    """
    kind, _, rest = target.partition(":")
    if kind == "serial" and rest:
        return SerialLink(rest, baud)
    host, colon, port = rest.rpartition(":")
    if kind in ("udp", "udpin", "udpout", "tcp") and colon and port.isdigit() and int(port) < 65536:
        if kind == "tcp":
            return TcpLink(host, int(port))
        return UdpLink(host or "0.0.0.0", int(port), listen=kind != "udpout")
    raise InputError(
        f"mavlink: {target!r} is no link. Expected udp:HOST:PORT or udpin:HOST:PORT (both listen), "
        "udpout:HOST:PORT, tcp:HOST:PORT or serial:DEVICE, such as mavlink:udp:127.0.0.1:14550."
    )
