"""A MAVLink vehicle and its fake autopilot on one clock that is turned by hand: real bytes, no threads."""

from __future__ import annotations

from wigwag.errors import VehicleError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.autopilot import FakeAutopilot
from wigwag.sim.wire import Wire, WireConfig
from wigwag.vehicles.mavlink.session import MavlinkConfig, Session
from wigwag.vehicles.protocol import Capabilities, FlightMode

_STEP_S = 0.005
_CONNECT_S = 30.0


class TetheredVehicle:
    """A ``Vehicle`` whose every byte passes between a real session and a fake autopilot.

    What ``MavlinkVehicle`` does with two threads, a step does here: faults and whole flights run many times
    faster than time, and always alike.

    Args:
        autopilot: The fake.
        config: How it is talked to.
        up: From the session to the autopilot.
        down: Back.
        seed: Draws the links' faults.

    Example:
        >>> from wigwag.sim.autopilots import FakePx4
        >>> vehicle = TetheredVehicle(FakePx4())
        >>> vehicle.connect()
        >>> vehicle.capabilities.name
        'PX4 1.16.0'
    """

    def __init__(
        self, autopilot: FakeAutopilot, config: MavlinkConfig | None = None, *,
        up: WireConfig | None = None, down: WireConfig | None = None, seed: int = 0,
    ) -> None:  # fmt: skip
        self.autopilot, self.session = autopilot, Session(config)
        self.up, self.down = Wire(up, 2 * seed), Wire(down, 2 * seed + 1)
        self.now_s = 1.0
        self.sent: list[tuple[float, bytes]] = []
        """Every packet that left the session: when, and what. For judging."""

    @property
    def now_ns(self) -> int:
        """The time."""
        return round(self.now_s * 1e9)

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        return self.session.mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        return self.session.capabilities

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is set on it in a way that is unwise."""
        return self.session.warnings

    @property
    def state(self) -> VehicleState:
        """What it says of itself."""
        return self.session.state(self.now_ns)

    def connect(self) -> None:
        """Let time go on until everything is agreed on and a position came.

        Raises:
            VehicleError: If that takes more than half a minute.
        """
        end_s = self.now_s + _CONNECT_S
        while not (self.session.ready and self.session.talk.telemetry.position.stamp_ns):
            self.session.beat(self.now_ns)
            self.step(_STEP_S)
            if self.now_s > end_s:
                raise VehicleError(f"no autopilot within {_CONNECT_S:g} s. {self.session.talk.passed_over}")

    def close(self) -> None:
        """Hold, if it is steered."""
        if self.mode is FlightMode.STEERED:
            self.hold()

    def beat(self, now_ns: int) -> None:
        """Say that the loop is alive."""
        self.session.beat(now_ns)

    def arm(self) -> bool:
        """Ask it to arm."""
        return self.session.arm(self.now_ns)

    def take_off(self, height_m: float = 1.5) -> bool:
        """Ask it to take off."""
        return self.session.take_off(height_m, self.now_ns)

    def land(self) -> bool:
        """Ask it to land."""
        return self.session.land(self.now_ns)

    def hold(self) -> bool:
        """Ask it to hold."""
        return self.session.hold(self.now_ns)

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Hand over a set-point."""
        return self.session.send(setpoint, stamp_ns, self.now_ns)

    def step(self, dt_s: float) -> None:
        """Let session, links and autopilot go on for ``dt_s`` seconds."""
        end_s = self.now_s + dt_s
        while self.now_s < end_s - 1e-9:
            self.now_s = min(self.now_s + _STEP_S, end_s)
            for packet in self.session.tick(self.now_ns):
                self.sent.append((self.now_s, packet))
                self.up.send(packet, self.now_s)
            for packet in self.up.arrived(self.now_s):
                self.autopilot.receive(packet)
            for packet in self.autopilot.step(self.now_s):
                self.down.send(packet, self.now_s)
            for packet in self.down.arrived(self.now_s):
                self.session.receive(packet, self.now_ns)
