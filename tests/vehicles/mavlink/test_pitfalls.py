"""What real autopilots do that a fake easily leaves out."""

from __future__ import annotations

import pytest
from pymavlink import mavutil

from tests.vehicles.mavlink.flights import FAKES, Flight, connected, hovering, steered
from wigwag.fly.values import Setpoint
from wigwag.sim.autopilot_config import FakeConfig
from wigwag.sim.autopilots import FakePx4
from wigwag.sim.tethered import TetheredVehicle
from wigwag.vehicles import FlightMode
from wigwag.vehicles.mavlink.autopilots import ArduCopter, Px4

AHEAD = Setpoint((1.0, 0.0, 0.0))
SET_INTERVAL, HEARTBEAT, GLOBAL_POSITION = 511, 0, 33


def refusing(make: type, message_id: int) -> type:
    """A fake that sends one message at its own rate alone."""

    class Fake(make):  # type: ignore[misc]
        def _command(self, command: int, message: object) -> int:
            if command == SET_INTERVAL and int(message.param1) == message_id:  # type: ignore[attr-defined]
                return 3  # not supported
            return super()._command(command, message)  # type: ignore[no-any-return]

    return Fake


def test_modes_have_the_numbers_that_pymavlink_knows() -> None:
    copter, names = ArduCopter(), mavutil.mode_mapping_acm
    assert {number: names[number] for number in ArduCopter._NAMES if number in names} == {
        number: name for number, name in ArduCopter._NAMES.items() if number in names
    }
    assert [names[m] for m in (copter.steer_mode, copter.hold_mode, copter.land_mode)] == [
        "GUIDED", "BRAKE", "LAND",
    ]  # fmt: skip
    by_sticks = {names[number] for number in range(29) if number in names and copter.by_sticks(number)}
    assert by_sticks - {"TURTLE"} == {
        "STABILIZE", "ACRO", "ALT_HOLD", "LOITER", "DRIFT", "SPORT", "FLIP", "AUTOTUNE", "POSHOLD",
        "FLOWHOLD", "ZIGZAG", "AUTOROTATE",
    }  # fmt: skip
    px4, armed = Px4(), 1 | 8 | 128
    told = [
        mavutil.interpret_px4_mode(armed, mode)
        for mode in (px4.steer_mode, px4.hold_mode, px4.take_off_mode, px4.land_mode)
    ]
    assert told == ["OFFBOARD", "LOITER", "TAKEOFF", "LAND"]


@pytest.mark.parametrize("make", FAKES)
def test_a_battery_that_nobody_measures_is_no_empty_one(make: type) -> None:
    class Fake(make):  # type: ignore[misc]
        def _send_sys_status(self) -> None:
            present, health = self._prearm_bits()
            self._post(self._coder.sys_status_encode(present, present, health, 0, 65535, -1, -1, *[0] * 6))

    flight = hovering(Fake())
    state = flight.vehicle.state
    assert (state.battery, state.battery_v, state.healthy) == (None, None, True)
    assert not flight.vehicle.capabilities.battery, "the checklist says that nobody watches it"


@pytest.mark.parametrize("make", FAKES)
def test_heartbeats_that_come_once_a_second_are_enough(make: type) -> None:
    flight = steered(refusing(make, HEARTBEAT)(), AHEAD)
    fake = flight.fake
    fake.pilot(fake.POSITION if make is FakePx4 else fake.LOITER)  # type: ignore[attr-defined]
    mode = fake.mode
    flight.turns(1.2, AHEAD)
    assert flight.vehicle.mode is FlightMode.MANUAL
    seen_s = flight.vehicle.now_s
    flight.turns(3.0, AHEAD)
    assert fake.mode == mode and not flight.sent("SET_POSITION_TARGET_LOCAL_NED", seen_s)


def test_px4_is_not_sent_up_to_an_altitude_that_is_not_known() -> None:
    class Fake(refusing(FakePx4, GLOBAL_POSITION)):  # type: ignore[misc]
        def _send_global_position_int(self) -> None:
            pass

    flight = connected(Fake())
    assert flight.vehicle.arm() and flight.vehicle.take_off(3.0)
    flight.turns(4.0)
    assert "has not said at which it stands" in flight.vehicle.state.denied
    assert flight.fake.height_m == 0.0 and not flight.sent("COMMAND_LONG", flight.vehicle.now_s - 1.0)


@pytest.mark.parametrize("make", FAKES)
def test_a_simulator_at_half_its_speed_is_flown_all_the_way(make: type) -> None:
    flight = Flight(TetheredVehicle(make(FakeConfig(clock_rate=0.5))))
    flight.vehicle.connect()
    flight.turns(2.0)
    assert flight.vehicle.arm() and flight.vehicle.take_off(3.0)
    flight.until(FlightMode.HOLDING)
    flight.until(FlightMode.STEERED, setpoint=AHEAD)
    for _ in range(300):
        flight.turn(AHEAD)
        assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) < 0.3
    assert flight.vehicle.land()
    flight.until(FlightMode.DISARMED)
