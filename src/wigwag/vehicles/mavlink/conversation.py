"""Talking with one autopilot: bytes in, bytes out, commands with acknowledgement. No sockets, no clock."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from wigwag.vehicles.mavlink.autopilots import VEHICLES, Autopilot, CommandRequest, autopilot_of
from wigwag.vehicles.mavlink.dialect import dialect
from wigwag.vehicles.mavlink.parameters import decode
from wigwag.vehicles.mavlink.signing import sign
from wigwag.vehicles.mavlink.telemetry import Telemetry

Procedure = Generator[None, None, str]
"""Something that takes more than one turn: resumed at each, it returns why it failed, or nothing."""

_S = 1_000_000_000
_ACCEPTED, _BUSY, _IN_PROGRESS = 0, 1, 5
"""MAV_RESULT: accepted, temporarily rejected, in progress."""
_RESULTS = {1: "denied for now", 2: "denied", 3: "not supported", 4: "failed", 6: "cancelled"}
_SET_MODE, _SET_INTERVAL = 176, 511
_UNDATED = frozenset({"HEARTBEAT", "EXTENDED_SYS_STATE", "SYS_STATUS", "GLOBAL_POSITION_INT"})
"""Messages of the moment that do not tell, or are not asked, when it was."""
_BEHIND = 64
"""A packet that is so many numbers behind the newest, or fewer, is a late one; their 8 bits leave it open."""
_OWN_COMPONENT = 191
"""MAV_COMP_ID_ONBOARD_COMPUTER."""


class Conversation:
    """Everything that is said to and heard from one autopilot.

    Only the autopilot that was found first is heard (or the one with the system id asked for); whatever
    other systems and components share the link is left alone.

    Args:
        system: System id to wait for; ``None`` takes the first autopilot of something that hovers.
        key: Signing key of 32 bytes; unsigned packets are then not heard.
        wall_clock_s: Seconds since 1970, for signatures only.
        ack_s: How long an acknowledgement is waited for.
        tries: How often a command is sent before it counts as unanswered.
    """

    def __init__(
        self, system: int | None = None, key: bytes | None = None, wall_clock_s: float = 0.0,
        ack_s: float = 0.5, tries: int = 4,
    ) -> None:  # fmt: skip
        self.mavlink = dialect()
        self.ack_s, self.tries = ack_s, tries
        self.now_ns = 0
        self.out: list[bytes] = []
        """Packets to be sent, oldest first."""
        self.target = (0, 0)
        self.autopilot: Autopilot | None = None
        self.telemetry = Telemetry()
        self.parameters: dict[str, float] = {}
        self.passed_over = ""
        """What was heard that cannot be flown. For people to read."""
        self._system = system
        self._newest: int | None = None
        self._numbers: dict[str, int] = {}
        self._acks: dict[int, int] = {}
        self._asked_ns: dict[int, int] = {}
        """Our own clock messages that are on their way: sent when."""
        self._coder = self.mavlink.MAVLink(self, srcSystem=255, srcComponent=_OWN_COMPONENT)
        self._coder.robust_parsing = True
        if key is not None:
            sign(self._coder, key, wall_clock_s)

    def write(self, data: bytes) -> None:
        """Take a packet from pymavlink's coder."""
        self.out.append(bytes(data))

    def post(self, message: Any) -> None:
        """Put a message among those to be sent."""
        self._coder.send(message)

    @property
    def encode(self) -> Any:
        """The coder of pymavlink, for its ``..._encode`` methods."""
        return self._coder

    @property
    def broken(self) -> int:
        """How many packets came damaged, or with a wrong signature."""
        return int(self._coder.total_receive_errors)

    def receive(self, data: bytes, now_ns: int) -> bool:
        """Take in bytes; return whether a heartbeat of the autopilot was among them."""
        self.now_ns = max(self.now_ns, now_ns)
        beaten = False
        for message in self._coder.parse_buffer(data) or ():
            kind = message.get_type()
            if kind == "BAD_DATA":
                continue
            source = (message.get_srcSystem(), message.get_srcComponent())
            if kind == "HEARTBEAT" and self.autopilot is None:
                self._find(message, source)
            if self.autopilot is None or source != self.target:
                continue
            if self._late(kind, message.get_seq()) and kind in _UNDATED:
                continue
            self._take(kind, message)
            beaten |= kind == "HEARTBEAT"
        return beaten

    def echo(self) -> None:
        """Ask for the autopilot's clock: the answer shows that the link works both ways."""
        self._asked_ns = {k: v for k, v in self._asked_ns.items() if self.now_ns - v < 3 * _S}
        self._asked_ns[self.now_ns] = self.now_ns
        self.post(self._coder.timesync_encode(0, self.now_ns))

    def command(
        self, request: CommandRequest, done: Callable[[], bool] | None = None, within_s: float = 3.0
    ) -> Procedure:
        """Send a command until it is acknowledged.

        Args:
            request: What to send.
            done: Whether it has happened, seen in what the autopilot tells. Seeing it is enough, should the
                acknowledgement get lost; an acknowledgement alone is not.
            within_s: How long after the acknowledgement it may take to happen.
        """
        name = self.autopilot.name if self.autopilot else "the autopilot"
        self._acks.pop(request.command, None)
        answer = "not answered"
        for attempt in range(self.tries):
            self.post(
                self._coder.command_long_encode(*self.target, request.command, attempt, *request.params)
            )
            deadline, accepted = self.now_ns + int(self.ack_s * _S), False
            while self.now_ns < deadline:
                if done is not None and done():
                    return ""
                yield
                result = self._acks.pop(request.command, None)
                if result == _ACCEPTED and done is None:
                    return ""
                if result in (_ACCEPTED, _IN_PROGRESS):
                    deadline, accepted = self.now_ns + round(within_s * _S), True
                elif result is not None:
                    answer = _RESULTS.get(result, f"result {result}")
                    if result == _BUSY:
                        continue
                    # What is refused the second time may be under way since the first.
                    until = self.now_ns + (_S if attempt else 0)
                    while self.now_ns < until and done is not None and not done():
                        yield
                    return "" if done is not None and done() else self._refusal(request, answer)
            if accepted:
                return f"{name} accepted to {request.what}, but it did not happen"
        return self._refusal(request, answer)

    def _refusal(self, request: CommandRequest, answer: str) -> str:
        name = self.autopilot.name if self.autopilot else "the autopilot"
        said = self.telemetry.complaint(self.now_ns)
        return f"{name}: {request.what} {answer}" + (f" ({said})" if said else "")

    def set_mode(self, custom_mode: int) -> Procedure:
        """Change the flight mode; given up as soon as somebody else changes it."""
        assert self.autopilot is not None
        autopilot, telemetry, before = self.autopilot, self.telemetry, self.telemetry.custom_mode
        changed = f"{autopilot.name}: somebody else changed the mode"

        def done() -> bool:
            return telemetry.custom_mode == custom_mode

        what = f"change to {autopilot.mode_name(custom_mode)}"
        steps = self.command(CommandRequest(_SET_MODE, what, autopilot.mode_params(custom_mode)), done)
        while True:
            try:
                next(steps)
            except StopIteration as end:
                return str(end.value or "")
            yield
            if telemetry.custom_mode not in (before, custom_mode):
                return changed

    def set_interval(self, message_id: int, rate_hz: float) -> Procedure:
        """Ask for a message at a rate."""
        params = (float(message_id), 1e6 / rate_hz, 0.0, 0.0, 0.0, 0.0, 0.0)
        return self.command(CommandRequest(_SET_INTERVAL, f"send message {message_id}", params))

    def read_parameter(self, name: str, tries: int) -> Procedure:
        """Read one parameter into ``parameters``."""
        for _ in range(tries):
            self.post(self._coder.param_request_read_encode(*self.target, name.encode("ascii"), -1))
            deadline = self.now_ns + int(self.ack_s * _S)
            while self.now_ns < deadline:
                yield
                if name in self.parameters:
                    return ""
        return f"parameter {name} not answered"

    def _find(self, message: Any, source: tuple[int, int]) -> None:
        """Take the first autopilot that can be flown; remember what else there is."""
        if self._system is not None and source[0] != self._system:
            self.passed_over = f"system {source[0]} is not the system {self._system} asked for"
            return
        autopilot = autopilot_of(message.autopilot)
        if source[1] != 1 or message.type not in VEHICLES or autopilot is None:
            if source[1] == 1:
                self.passed_over = (
                    f"system {source[0]} is of MAV_TYPE {message.type}, MAV_AUTOPILOT {message.autopilot}; "
                    "wigwag flies multirotors with PX4 or ArduPilot"
                )
            return
        self.target, self.autopilot = source, autopilot
        # A companion computer is a part of the vehicle: it bears its system id (mavlink.io, 'MAVLink IDs').
        self._coder.srcSystem = source[0]
        self.telemetry = Telemetry(autopilot.prearm_present)

    def _is_ours(self, message: Any) -> bool:
        """Say whether a message is for us, and not for another companion on the same vehicle."""
        system, component = message.target_system, message.target_component
        return system in (0, self._coder.srcSystem) and component in (0, _OWN_COMPONENT)

    def _late(self, kind: str, number: int) -> bool:
        """Say whether a packet was sent before the last of its kind, or is the same, by its number."""
        if self._newest is None:
            self._newest = number
        step = (number - self._newest + _BEHIND) % 256 - _BEHIND
        number = self._newest + step  # counted on beyond 8 bits
        self._newest = max(self._newest, number)
        late = number <= self._numbers.get(kind, -1)
        self._numbers[kind] = max(number, self._numbers.get(kind, -1))
        return late

    def _take(self, kind: str, message: Any) -> None:
        self.telemetry.update(message, self.now_ns)
        if kind == "COMMAND_ACK" and self._is_ours(message):
            self._acks[int(message.command)] = int(message.result)
        elif kind == "PARAM_VALUE":
            name = message.param_id
            bytewise = self.autopilot is not None and self.autopilot.name == "PX4"
            self.parameters[name] = decode(message.param_value, message.param_type, bytewise)
        elif kind == "TIMESYNC" and message.tc1 and message.ts1 in self._asked_ns:
            self.telemetry.echoed(self._asked_ns[message.ts1], message.tc1, self.now_ns)
