"""Every fault ends as it is documented, over MAVLink where the link or the vehicle fails."""

from __future__ import annotations

import math

import pytest

from wigwag.evaluate.faults import FAULTS, STILL_M_S, Fault, FaultFlight, fly_fault, summary
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.sim.autopilots import FakeArduPilot, FakePx4

NAMES = (
    "camera lost", "camera frozen", "camera late", "person lost", "person swapped", "pose NaN",
    "recogniser raising", "link lost", "link slow", "link lossy 20 %", "state stale", "battery low",
    "wind gust", "clock jump",
)  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
@pytest.mark.parametrize("seed", [1000, 1001])  # PX4 and ArduPilot, or responses like theirs
def test_every_fault_ends_as_documented(fault: Fault, seed: int) -> None:
    ending = fly_fault(fault, seed)
    assert ending.as_documented, ending


def test_all_that_was_asked_for_is_there() -> None:
    assert set(NAMES) <= {fault.name for fault in FAULTS}


def test_documented_times_leave_room_for_the_limits_and_no_more_than_half_a_minute() -> None:
    limits, times = SupervisorConfig(), {fault.name: fault.within_s for fault in FAULTS}
    assert limits.land_when_blind_s < times["camera lost"] < limits.land_when_blind_s + 30
    assert limits.land_when_lost_s < times["person lost"] < limits.land_when_lost_s + 30
    assert limits.land_when_deaf_s < times["recogniser raising"] < limits.land_when_deaf_s + 30


def test_a_fault_that_does_not_end_so_is_told() -> None:
    harmless = Fault("nothing", lambda flight: None, "disarmed", 1.0)
    record = summary(harmless, 2, 0)
    assert record["ended_as_documented"] == 0
    assert record["end_state"] == "following"
    assert record["time_s_max"] >= 1.0


@pytest.mark.parametrize("seed", range(4))
def test_stop_ends_motion_on_the_wire_within_200_ms_of_the_decision(seed: int) -> None:
    flight = FaultFlight(seed, wire=True)
    flight.begin()
    flight.turn(Command.LEFT)
    flight.turns(1.5)
    received = flight.fake.received
    assert math.hypot(received[-1][1].vx, received[-1][1].vy) > 0.2, "it is under way"
    flight.prompter.says = Command.STOP
    while flight.turn().verdict.accepted is not Command.STOP:
        pass
    decided_s = flight.fake.now_s
    flight.turns(1.5)
    hold = FakePx4.HOLD if isinstance(flight.fake, FakePx4) else FakeArduPilot.BRAKE
    assert flight.fake.mode == hold
    assert flight.speed_m_s < STILL_M_S
    flight.turns(1.5)  # it turns to the operator again, and goes nowhere
    later = [m for at_s, m in received if at_s > decided_s + 0.2]
    assert all((m.vx, m.vy, m.vz) == (0.0, 0.0, 0.0) for m in later)
    assert flight.mode is Mode.HOLDING
