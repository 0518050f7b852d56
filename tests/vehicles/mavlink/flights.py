"""Flying a tethered vehicle: a loop at 30 Hz on a clock that is turned by hand."""

from __future__ import annotations

from collections.abc import Callable

from wigwag.fly.values import Setpoint
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.tethered import TetheredVehicle
from wigwag.vehicles import FlightMode

FAKES = (FakePx4, FakeArduPilot)
TURN_S = 1 / 30


class Flight:
    """A vehicle and the loop that flies it."""

    def __init__(self, vehicle: TetheredVehicle) -> None:
        self.vehicle, self.fake = vehicle, vehicle.autopilot
        self.modes: list[FlightMode] = []

    def turn(self, setpoint: Setpoint | None = None) -> bool:
        """One turn of the loop."""
        v = self.vehicle
        v.beat(v.now_ns)
        flown = setpoint is not None and v.send(setpoint, v.now_ns)
        v.step(TURN_S)
        if not self.modes or v.mode is not self.modes[-1]:
            self.modes.append(v.mode)
        return flown

    def turns(self, seconds: float, setpoint: Setpoint | None = None) -> None:
        for _ in range(round(seconds / TURN_S)):
            self.turn(setpoint)

    def until(
        self, true: Callable[[], bool] | FlightMode, limit_s: float = 20.0, setpoint: Setpoint | None = None
    ) -> float:
        """Go on until something is true; return how long it took."""
        began_s = self.vehicle.now_s
        while not (self.vehicle.mode is true if isinstance(true, FlightMode) else true()):
            self.turn(setpoint)
            spent = self.vehicle.now_s - began_s
            assert spent < limit_s, f"{self.vehicle.mode} after {spent:.1f} s; {self.vehicle.state.denied!r}"
        return self.vehicle.now_s - began_s

    def freeze(self, seconds: float) -> None:
        """The loop hangs: time goes on, nothing is called."""
        self.vehicle.step(seconds)

    @property
    def speed_m_s(self) -> float:
        """How fast it truly flies."""
        velocity = self.fake.airframe.state.velocity_m_s
        return float((velocity @ velocity) ** 0.5)

    def sent(self, kind: str, since_s: float = 0.0) -> list[tuple[float, object]]:
        """Return what left the session, of one kind of message."""
        coder = self.fake.mavlink.MAVLink(None)
        found = []
        for at_s, packet in self.vehicle.sent:
            for message in coder.parse_buffer(packet) or ():
                if at_s >= since_s and message.get_type() == kind:
                    found.append((at_s, message))
        return found


def connected(fake, **settings) -> Flight:
    """Return a flight whose vehicle is connected and ready to arm."""
    flight = Flight(TetheredVehicle(fake, **settings))
    flight.vehicle.connect()
    flight.turns(1.0)
    return flight


def hovering(fake, height_m: float = 3.0, **settings) -> Flight:
    """Return a flight that hovers."""
    flight = connected(fake, **settings)
    assert flight.vehicle.arm()
    assert flight.vehicle.take_off(height_m)
    flight.until(FlightMode.HOLDING)
    return flight


def steered(fake, setpoint: Setpoint, seconds: float = 3.0, **settings) -> Flight:
    """Return a flight that follows a set-point."""
    flight = hovering(fake, **settings)
    flight.until(FlightMode.STEERED, setpoint=setpoint)
    flight.turns(seconds, setpoint)
    return flight
