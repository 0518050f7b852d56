"""What goes wrong in flight, and how it ends: every fault of docs/safety.md, flown many times."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.sim.autopilot import FakeAutopilot
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.pointmass import PointMass
from wigwag.sim.response import Response, ardupilot_like, px4_like
from wigwag.sim.sketch import SketchConfig, SketchWorld, Walk
from wigwag.sim.tethered import TetheredVehicle
from wigwag.vehicles.protocol import FlightMode

SENSOR = SketchConfig(delay_s=0.05, jitter_s=0.03, lost=0.02)
START_M = (0.0, 0.0, 1.2)
STILL_M_S = 0.2
"""Slower than this, a drone in gusts stands still."""
NEAREST_M = 1.7
"""Nobody who walks about is ever come closer to than this, whatever happens."""
_HELD = (Mode.HOLDING, Mode.LOST_LINK, Mode.LOST_PERSON)


class FaultFlight(PromptedFlight):
    """A flight in which something is about to go wrong.

    Args:
        seed: Chooses vehicle, walk and moment.
        wire: Whether a fake autopilot is flown over real MAVLink bytes.
    """

    def __init__(self, seed: int, wire: bool) -> None:
        self.rng = np.random.default_rng([seed, 0xFA017])
        self.airframe: Response | PointMass
        self.tether: TetheredVehicle | None = None
        if wire:
            point = PointMass(seed=seed)
            fake: FakeAutopilot = (FakePx4, FakeArduPilot)[seed % 2](airframe=point)
            self.airframe, self.tether = point, TetheredVehicle(fake, seed=seed)
            self.tether.connect()
        else:
            self.airframe = Response((px4_like, ardupilot_like)[seed % 2](position_m=START_M), seed)
        super().__init__(SketchWorld(self.airframe, self._walk(), SENSOR, seed, self.tether))

    @property
    def mode(self) -> Mode:
        """What the supervisor flies."""
        return self.pilot.supervisor.mode

    @property
    def speed_m_s(self) -> float:
        """How fast it truly flies."""
        return float(np.linalg.norm(self.airframe.state.velocity_m_s))

    @property
    def fake(self) -> FakeAutopilot:
        """The fake autopilot; there must be one."""
        assert self.tether is not None
        return self.tether.autopilot

    def begin(self) -> None:
        """Take off, if it stands, and follow for a while."""
        if self.tether is not None:
            self.turns(2.0)
            self.turn(Command.TAKE_OFF)
            until_s = self.now_s + 30.0
            while self.mode is not Mode.FOLLOWING and self.now_s < until_s:
                self.turn()
        self.turns(float(self.rng.uniform(3.0, 5.0)))

    def _walk(self) -> Walk:
        """Stroll to and fro before the drone."""
        width, depth = self.rng.uniform(0.1, 0.8, 2)
        pace = self.rng.uniform(0.3, 0.7, 2)
        turn = self.rng.uniform(-math.pi, math.pi, 2)
        return lambda t: (
            float(4.5 + depth * math.sin(pace[0] * t + turn[0])),
            float(width * math.sin(pace[1] * t + turn[1])),
        )


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that goes wrong."""

    name: str
    happens: Callable[[FaultFlight], None]
    """Lets it happen, at the moment from which time counts."""
    ends: str
    """``"disarmed"``: on the ground; ``"holding"``: standing still in the air and not following;
    ``"following"``: it goes on as if nothing had been."""
    within_s: float
    """The documented time."""
    wire: bool = False
    """Flown over MAVLink, against a fake autopilot."""
    stays_s: float = 0.5
    """The end has lasted so long before it counts."""


def _camera_lost(flight: FaultFlight) -> None:
    flight.world.faults.no_frames = True


def _camera_frozen(flight: FaultFlight) -> None:
    flight.world.faults.frozen = True


def _camera_late(flight: FaultFlight) -> None:
    flight.world.faults.late_s = float(flight.rng.uniform(0.7, 2.0))


def _person_lost(flight: FaultFlight) -> None:
    flight.world.faults.hidden = True


def _person_swapped(flight: FaultFlight) -> None:
    x, y = flight.world.person_m
    aside = float(flight.rng.choice([-1.0, 1.0])) * float(flight.rng.uniform(1.6, 1.9))
    flight.world.faults.other = lambda t: (x + 1.8, y + aside)


def _pose_nan(flight: FaultFlight) -> None:
    flight.world.faults.broken_pose = True


def _recogniser_raising(flight: FaultFlight) -> None:
    flight.prompter.broken = True


def _wire(flight: FaultFlight, **changes: object) -> None:
    assert flight.tether is not None
    for wire in (flight.tether.up, flight.tether.down):
        for name, value in changes.items():
            setattr(wire.config, name, value)


def _link_lost(flight: FaultFlight) -> None:
    _wire(flight, cut=True)


def _link_slow(flight: FaultFlight) -> None:
    _wire(flight, delay_s=float(flight.rng.uniform(0.7, 1.2)))


def _link_lossy(flight: FaultFlight) -> None:
    """Follow over a lossy link for a while, fly a command, then say stop: from there time counts."""
    _wire(flight, loss=0.2)
    flight.turns(5.0)
    flight.turn(Command.LEFT)
    flight.turns(4.0)
    flight.turn(Command.STOP)


def _state_stale(flight: FaultFlight) -> None:
    flight.fake.faults.frozen = True


def _battery_low(flight: FaultFlight) -> None:
    flight.fake.battery = 0.2


def _wind_gust(flight: FaultFlight) -> None:
    """Blow it away for a second; from the end of the gust time counts."""
    assert isinstance(flight.airframe, Response)
    angle = float(flight.rng.uniform(-math.pi, math.pi))
    flight.airframe.push_m_s2 = 3.0 * np.array([math.cos(angle), math.sin(angle), 0.0])
    flight.turns(1.0)
    flight.airframe.push_m_s2 = np.zeros(3)


def _clock_jump(flight: FaultFlight) -> None:
    flight.clock_off_ns = int(flight.rng.choice([-60.0, -3.0, 3.0, 60.0]) * 1e9)


def _loop_hung(flight: FaultFlight) -> None:
    """Let the world go on without the loop."""
    for _ in range(round(float(flight.rng.uniform(1.0, 4.0)) * 30)):
        flight.world.step()


FAULTS: tuple[Fault, ...] = (
    Fault("camera lost", _camera_lost, "disarmed", 20.0),
    Fault("camera frozen", _camera_frozen, "disarmed", 20.0),
    Fault("camera late", _camera_late, "disarmed", 20.0),
    Fault("person lost", _person_lost, "disarmed", 40.0),
    Fault("person swapped", _person_swapped, "holding", 3.0, stays_s=5.0),
    Fault("pose NaN", _pose_nan, "disarmed", 40.0),
    Fault("recogniser raising", _recogniser_raising, "disarmed", 30.0),
    Fault("link lost", _link_lost, "holding", 4.0, wire=True),
    Fault("link slow", _link_slow, "holding", 6.0, wire=True),
    Fault("link lossy 20 %", _link_lossy, "holding", 3.0, wire=True),
    Fault("state stale", _state_stale, "disarmed", 15.0, wire=True),
    Fault("battery low", _battery_low, "disarmed", 10.0, wire=True),
    Fault("wind gust", _wind_gust, "following", 6.0),
    Fault("clock jump", _clock_jump, "disarmed", 15.0),
    Fault("loop hung", _loop_hung, "holding", 4.0),
)
"""Every fault, and how it is documented to end."""


@dataclass(frozen=True, slots=True)
class Ending:
    """How one flight ended."""

    state: str
    time_s: float
    """From the fault to the beginning of the documented end; to the end of the run, if it did not come."""
    as_documented: bool
    nearest_m: float
    """The least true distance to the person."""


def state_of(flight: FaultFlight) -> str:
    """Say in a word how it stands, by what the vehicle truly does."""
    if flight.airframe.on_ground and flight.world.vehicle.mode is FlightMode.DISARMED:
        return "disarmed"
    if flight.tether is not None and flight.airframe.on_ground and not flight.fake.armed:
        return "disarmed"
    if flight.mode in _HELD and flight.speed_m_s < STILL_M_S:
        return "holding"
    if flight.mode in (Mode.FOLLOWING, Mode.EXECUTING) and flight.step is not None:
        off_m = abs(flight.world.distance_m - flight.step.goal.distance_m)
        return "following" if off_m < 0.5 and abs(flight.world.bearing_rad) < 0.15 else "off its place"
    return str(flight.mode)


def fly_fault(fault: Fault, seed: int) -> Ending:
    """Fly until something goes wrong, and on to its documented end, or past its documented time.

    Args:
        fault: One of ``FAULTS``.
        seed: Chooses vehicle, walk and moment, and draws all noise.
    """
    flight = FaultFlight(seed, fault.wire)
    flight.begin()
    if flight.mode is not Mode.FOLLOWING:
        return Ending(f"never flew: {flight.mode}", 0.0, False, flight.world.distance_m)
    fault.happens(flight)
    began_s, since_s, nearest = flight.now_s, math.inf, math.inf
    while flight.now_s - began_s < fault.within_s + fault.stays_s:
        flight.turn()
        nearest = min(nearest, flight.world.distance_m)
        since_s = min(since_s, flight.now_s) if state_of(flight) == fault.ends else math.inf
        if flight.now_s - since_s >= fault.stays_s:
            break
    state = state_of(flight)
    time_s = min(since_s, flight.now_s) - began_s
    fine = state == fault.ends and time_s <= fault.within_s and nearest > NEAREST_M
    return Ending(state, time_s, fine, nearest)


def summary(fault: Fault, runs: int, seed: int) -> dict[str, Any]:
    """Fly one fault with each of several seeds; return its record."""
    endings = [fly_fault(fault, seed + k) for k in range(runs)]
    states = sorted({ending.state for ending in endings})
    return {
        "fault": fault.name,
        "runs": runs,
        "ended_as_documented": sum(ending.as_documented for ending in endings),
        "end_state": ", ".join(states),
        "time_s_max": round(max(ending.time_s for ending in endings), 3),
        "documented_state": fault.ends,
        "documented_s": fault.within_s,
        "nearest_m": round(min(ending.nearest_m for ending in endings), 3),
    }


__all__ = ["FAULTS", "Ending", "Fault", "FaultFlight", "fly_fault", "state_of", "summary"]
