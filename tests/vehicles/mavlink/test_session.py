"""A session against whatever bytes there may be, and against an autopilot that says strange things."""

import math
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.vehicles.mavlink.flights import FAKES, hovering
from wigwag.fly.values import Setpoint
from wigwag.sim.autopilots import FakePx4
from wigwag.vehicles import FlightMode
from wigwag.vehicles.mavlink import Session
from wigwag.vehicles.mavlink.dialect import dialect
from wigwag.vehicles.mavlink.parameters import decode
from wigwag.vehicles.mavlink.telemetry import Telemetry

S = 10**9


class Autopilot:
    """Sends messages of any content as system 1, component 1."""

    def __init__(self):
        self.coder = dialect().MAVLink(self, srcSystem=1, srcComponent=1)
        self.packet = b""

    def write(self, data):
        self.packet += bytes(data)

    def say(self, name, *fields):
        self.packet = b""
        self.coder.send(getattr(self.coder, f"{name}_encode")(*fields))
        return self.packet


def met(autopilot=12, kind=2):
    session, other = Session(), Autopilot()
    session.receive(other.say("heartbeat", kind, autopilot, 1, 0, 3), S)
    return session, other


@settings(max_examples=200, deadline=None)
@given(st.lists(st.binary(max_size=300), max_size=8))
def test_no_bytes_are_too_strange(chunks):
    session, other = met()
    for index, chunk in enumerate(chunks):
        session.receive(chunk, (2 + index) * S)
        session.tick((2 + index) * S)
    assert np.isfinite(session.state(20 * S).position_m).all()
    # After whatever it was, a good message is heard again.
    for number in range(40):
        session.receive(other.say("attitude", 1000 + number, 0.1, 0.2, 0.3, 0, 0, 0), 21 * S)
    assert session.state(21 * S).roll_rad == pytest.approx(0.1)


numbers = st.floats(width=32)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(numbers, numbers, numbers, numbers, numbers, numbers), min_size=1, max_size=6))
def test_numbers_that_are_none_do_not_travel_on(rows):
    session, other = met()
    for index, row in enumerate(rows):
        session.receive(other.say("local_position_ned", 100 + index, *row), 2 * S)
        session.receive(other.say("attitude", 100 + index, *row), 2 * S)
    state = session.state(2 * S)
    values = [*state.position_m, *state.velocity_m_s, state.heading_rad, state.roll_rad, state.pitch_rad]
    assert np.isfinite(values).all()


@given(st.binary(max_size=50))
def test_texts_may_be_of_any_bytes(text):
    session, other = met()
    session.receive(other.say("statustext", 3, b"PreArm: " + text[:40]), 2 * S)
    assert isinstance(session.state(2 * S).trouble, str)


@pytest.mark.parametrize(
    "autopilot, kind, said",
    [(8, 6, "MAV_AUTOPILOT 8"), (12, 1, "MAV_TYPE 1"), (3, 10, "MAV_TYPE 10"), (0, 2, "MAV_AUTOPILOT 0")],
    ids=["a ground station", "a plane", "a rover", "another autopilot"],
)
def test_what_cannot_be_flown_is_passed_over_and_named(autopilot, kind, said):
    session, _ = met(autopilot, kind)
    assert session.talk.autopilot is None
    assert said in session.talk.passed_over
    assert session.mode is FlightMode.DISARMED
    assert not session.arm(2 * S)
    assert session.capabilities.name == "not connected"


def test_another_component_of_the_same_vehicle_is_not_its_autopilot():
    session, gimbal = Session(), Autopilot()
    gimbal.coder.srcComponent = 154
    session.receive(gimbal.say("heartbeat", 26, 8, 0, 0, 4), S)
    assert session.talk.autopilot is None and session.talk.passed_over == ""


@pytest.mark.parametrize("number", [0, 1, 5, -1, -2147483648, 2147483647])
def test_px4_puts_whole_numbers_into_the_bytes_of_a_float(number):
    on_the_wire = struct.unpack("<f", struct.pack("<i", number))[0]
    if not math.isnan(on_the_wire):
        assert decode(on_the_wire, 6, bytewise=True) == number
    assert decode(float(min(number, 2**24)), 6, bytewise=False) == min(number, 2**24)
    assert decode(1.5, 9, bytewise=True) == 1.5


def test_an_acknowledgement_for_somebody_else_is_not_ours():
    session, other = met()
    session.receive(other.say("command_ack", 400, 0, 0, 0, 255, 190), 2 * S)
    session.receive(other.say("command_ack", 400, 0, 0, 0, 1, 195), 2 * S)  # another companion's
    assert session.talk._acks == {}
    session.receive(other.say("command_ack", 400, 4, 0, 0, 1, 191), 2 * S)
    assert session.talk._acks == {400: 4}


def test_prearm_is_read_where_each_autopilot_puts_it():
    """PX4 sets 'health' alone; ArduPilot marks the bit as present first."""
    prearm = 0x10000000
    for present_needed, present, health, healthy in (
        (False, 0, prearm, True), (False, 0, 0, False),
        (True, prearm, prearm, True), (True, prearm, 0, False), (True, 0, 0, True),
    ):  # fmt: skip
        telemetry, other = Telemetry(present_needed), Autopilot()
        packet = other.say("sys_status", present, present, health, 0, 65535, 0, -1, 0, 0, 0, 0, 0, 0)
        telemetry.update(other.coder.parse_buffer(packet)[0], S)
        assert telemetry.healthy is healthy
        assert telemetry.battery is None and telemetry.battery_v is None


def test_one_late_message_is_no_restart_three_in_order_are():
    telemetry, other = Telemetry(), Autopilot()

    def hear(boot_ms, now_ns):
        packet = other.say("local_position_ned", boot_ms, boot_ms * 1e-3, 0, 0, 0, 0, 0)
        telemetry.update(other.coder.parse_buffer(packet)[0], now_ns)

    for index in range(100):
        hear(60_000 + 30 * index, S + 30_000_000 * index)
    stamp = telemetry.position.stamp_ns
    hear(58_000, 5 * S)
    hear(58_000, 5 * S)
    assert telemetry.restarts == 0 and telemetry.position.stamp_ns == stamp
    for index in range(4):
        hear(500 + 30 * index, 6 * S + 30_000_000 * index)
    assert telemetry.restarts == 1
    assert telemetry.position.stamp_ns > 6 * S


@pytest.mark.parametrize("make", FAKES)
def test_setpoints_leave_on_an_even_grid_whatever_the_loops_own_rate(make):
    flight = hovering(make())
    flight.until(FlightMode.STEERED, setpoint=Setpoint())
    began = flight.vehicle.now_s
    rng = np.random.default_rng(4)
    while flight.vehicle.now_s < began + 5.0:
        flight.vehicle.send(Setpoint((0.1, 0.0, 0.0)), flight.vehicle.now_ns)
        flight.vehicle.step(float(rng.uniform(0.005, 0.12)))
    times = [at for at, _ in flight.sent("SET_POSITION_TARGET_LOCAL_NED", began + 0.1)]
    assert np.diff(times) == pytest.approx(1 / 30, abs=0.006)


def test_a_late_tick_does_not_shift_the_grid_nor_burst():
    session = Session()
    period = round(S / 30)
    session.tick(S)
    assert session.due_ns == S + period
    session.tick(S + 10 * period + 1000)
    assert session.due_ns == S + 11 * period


def test_px4s_position_in_hand_is_told_by_name():
    fake = FakePx4()
    flight = hovering(fake)
    name = flight.vehicle.session.talk.autopilot.mode_name
    assert [name(m) for m in (fake.POSITION, fake.OFFBOARD, fake.HOLD, fake.RETURN, 99 << 16)] == [
        "Position", "Offboard", "Hold", "Return", "mode 99",
    ]  # fmt: skip
