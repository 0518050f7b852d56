import math

import numpy as np
import pytest

from tests.vehicles.mavlink.flights import FAKES, connected, hovering, steered
from wigwag.errors import InputError, VehicleError
from wigwag.fly.values import HOVER, Setpoint
from wigwag.sim.autopilot_config import FakeConfig
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.pointmass import PointMass
from wigwag.sim.tethered import TetheredVehicle
from wigwag.vehicles import FlightMode, Vehicle
from wigwag.vehicles.mavlink import MavlinkConfig
from wigwag.vehicles.mavlink.setup import Origin

AHEAD = Setpoint((1.0, 0.0, 0.0))


@pytest.fixture(params=FAKES, ids=lambda fake: fake.__name__)
def fake(request):
    return request.param()


def test_a_whole_mission(fake):
    flight = connected(fake)
    vehicle: Vehicle = flight.vehicle
    assert vehicle.mode is FlightMode.DISARMED
    assert vehicle.arm()
    assert vehicle.take_off(3.0)
    flight.until(FlightMode.HOLDING)
    assert fake.height_m == pytest.approx(3.0, abs=0.5)
    state = fake.airframe.state
    moves = (
        (Setpoint((0.6, 0.0, 0.0)), 2.0), (Setpoint((0.0, 0.6, 0.0)), 2.0), (Setpoint((-0.6, 0.0, 0.0)), 2.0),
        (Setpoint((0.0, 0.0, 0.4)), 2.0), (Setpoint((0.0, 0.0, 0.0), 0.5), 2.0),
    )  # fmt: skip
    for setpoint, seconds in moves:
        flight.until(FlightMode.STEERED, setpoint=HOVER)
        flight.turns(1.0, HOVER)
        before = fake.airframe.state
        flight.turns(seconds, setpoint)
        flight.turns(1.5, HOVER)
        after = fake.airframe.state
        cos, sin = math.cos(before.heading_rad), math.sin(before.heading_rad)
        x, y, z = after.position_m - before.position_m
        flown = np.array([cos * x + sin * y, -sin * x + cos * y, z])
        assert flown == pytest.approx(np.array(setpoint.velocity_m_s) * seconds, abs=0.1)
        assert after.heading_rad - before.heading_rad == pytest.approx(
            setpoint.yaw_rate_rad_s * seconds, abs=0.06
        )
    assert vehicle.land()
    flight.until(FlightMode.DISARMED)
    assert not fake.armed
    assert fake.height_m == 0
    assert flight.modes == [
        FlightMode.DISARMED, FlightMode.TAKING_OFF, FlightMode.HOLDING, FlightMode.STEERED,
        FlightMode.LANDING, FlightMode.DISARMED,
    ]  # fmt: skip
    assert not vehicle.state.armed
    # And again, out of the mode it landed in.
    assert vehicle.arm()
    assert vehicle.take_off(2.0)
    flight.until(FlightMode.HOLDING)
    assert fake.height_m == pytest.approx(2.0, abs=0.3)
    assert state.armed


def test_the_state_is_the_vehicles(fake):
    flight = steered(fake, Setpoint((0.8, 0.3, 0.1), 0.2))
    state, truth = flight.vehicle.state, fake.airframe.state
    assert state.position_m == pytest.approx(truth.position_m, abs=0.08)
    assert state.velocity_m_s == pytest.approx(truth.velocity_m_s, abs=0.1)
    assert state.heading_rad == pytest.approx(truth.heading_rad, abs=0.03)
    assert state.battery == 0.9
    assert state.battery_v == 11.8
    assert state.armed and state.healthy
    now = flight.vehicle.now_ns
    assert max(state.position_age_s(now), state.attitude_age_s(now)) < 0.08
    assert state.link_age_s(now) < 0.3


def test_height_counts_from_where_it_stands_not_from_home_or_the_sea():
    """PX4 takes off to an altitude above the sea, ArduPilot above home; neither is where it stands."""
    for fake in (FakePx4(FakeConfig(amsl_m=1234.5)), FakeArduPilot(FakeConfig(amsl_m=1234.5))):
        flight = hovering(fake, 3.0)
        assert fake.height_m == pytest.approx(3.0, abs=0.3)
        assert flight.vehicle.state.position_m[2] == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize("make", FAKES)
def test_motors_that_take_long_to_lift_are_waited_for(make):
    """ArduPilot says that it stands until its motors have come up to speed."""
    flight = connected(make(FakeConfig(spool_up_s=5.0)))
    assert flight.vehicle.arm() and flight.vehicle.take_off(3.0)
    flight.until(FlightMode.HOLDING)
    assert flight.vehicle.state.denied == ""
    assert flight.fake.height_m == pytest.approx(3.0, abs=0.5)


def test_px4_gets_a_second_of_setpoints_before_offboard():
    flight = hovering(FakePx4())
    began = flight.vehicle.now_s
    flight.until(FlightMode.STEERED, setpoint=AHEAD)
    asked = [at for at, m in flight.sent("COMMAND_LONG", began) if m.command == 176]
    first = flight.sent("SET_POSITION_TARGET_LOCAL_NED", began)[0][0]
    assert len(asked) == 1  # granted the first time
    assert 1.0 < asked[0] - first < 1.4


def test_what_is_sent_is_a_velocity_in_the_frame_that_each_understands(fake):
    steered(fake, Setpoint((1.0, 0.5, 0.25), 0.3), seconds=1.0)
    message = fake.received[-1][1]
    assert message.type_mask == 0b010111000111
    assert message.vz == pytest.approx(-0.25)
    assert message.yaw_rate == pytest.approx(-0.3)
    if isinstance(fake, FakePx4):
        assert message.coordinate_frame == 1
        assert math.hypot(message.vx, message.vy) == pytest.approx(math.hypot(1.0, 0.5))
    else:
        assert (message.coordinate_frame, message.vx, message.vy) == (9, 1.0, -0.5)
    assert (message.target_system, message.target_component) == (1, 1)


def test_px4_is_steered_by_its_heading_of_the_moment():
    flight = hovering(FakePx4(airframe=PointMass(heading_rad=2.0)))
    flight.turns(3.0, AHEAD)
    x, y, _ = flight.fake.airframe.state.velocity_m_s
    assert math.atan2(y, x) == pytest.approx(2.0, abs=0.02)


def test_ardupilot_without_gps_is_given_an_origin():
    fake = FakeArduPilot(FakeConfig(gps=False))
    flight = connected(fake)
    assert flight.vehicle.now_s > 4.0  # waited whether one comes by itself
    assert len(flight.sent("SET_GPS_GLOBAL_ORIGIN")) == 1
    fake = FakeArduPilot(FakeConfig(gps=False))
    flight = connected(fake, config=MavlinkConfig(origin=Origin(52.0, 4.0, 7.0)))
    message = flight.sent("SET_GPS_GLOBAL_ORIGIN")[0][1]
    assert (message.latitude, message.longitude, message.altitude) == (520000000, 40000000, 7000)


def test_one_with_gps_finds_its_origin_itself():
    fake = FakeArduPilot(FakeConfig(settle_s=12.0))
    flight = connected(fake)
    assert not flight.sent("SET_GPS_GLOBAL_ORIGIN")
    assert flight.vehicle.now_s > 12.0


def test_settings_are_read_and_warned_about():
    safe_px4, safe_ardupilot = connected(FakePx4()).vehicle, connected(FakeArduPilot()).vehicle
    assert [w.split(" ")[0] for w in safe_px4.warnings] == ["NAV_RCL_ACT"]
    assert safe_ardupilot.warnings == ()
    px4, ardupilot = FakePx4(), FakeArduPilot()
    px4.parameters |= {
        "COM_OBL_RC_ACT": (3, 6), "COM_OF_LOSS_T": (4.0, 9), "COM_RCL_EXCEPT": (4, 6), "NAV_RCL_ACT": (1, 6),
        "GF_ACTION": (0, 6), "COM_DISARM_LAND": (-1.0, 9),
    }  # fmt: skip
    del px4.parameters["RTL_RETURN_ALT"]
    ardupilot.parameters |= {"GUID_TIMEOUT": (3.0, 9), "FS_GCS_ENABLE": (1, 2), "FENCE_ENABLE": (0, 2)}
    said = "\n".join(connected(px4).vehicle.warnings)
    assert "COM_OBL_RC_ACT is 3 (Return)" in said
    assert "COM_OF_LOSS_T is 4 s" in said
    assert "COM_RCL_EXCEPT is 4" in said
    assert "no geofence" in said
    assert "COM_DISARM_LAND is -1: PX4 never locks" in said
    assert "RTL_RETURN_ALT could not be read" in said
    said = "\n".join(connected(ardupilot).vehicle.warnings)
    assert "GUID_TIMEOUT is 3 s" in said
    assert "FS_GCS_ENABLE is 1: when a ground station is lost, ArduPilot climbs to 15 m" in said
    assert "FENCE_ENABLE is 0" in said
    assert connected(ardupilot).vehicle.capabilities.own_timeout_s == 3.0


def test_px4_that_wants_a_ground_station_gets_one_unless_told_otherwise():
    fake = FakePx4()
    fake.parameters["NAV_DLL_ACT"] = (2, 6)
    flight = hovering(fake)
    assert fake.heartbeats[-1][2] == 6
    assert "NAV_DLL_ACT = 2 (Return)" not in flight.vehicle.warnings
    assert any("NAV_DLL_ACT" in warning for warning in flight.vehicle.warnings)
    fake = FakePx4()
    fake.parameters["NAV_DLL_ACT"] = (2, 6)
    flight = connected(fake, config=MavlinkConfig(heartbeat="onboard"))
    assert not flight.vehicle.state.healthy
    assert flight.vehicle.arm()
    flight.turns(4.0)
    assert "No connection to the GCS" in flight.vehicle.state.denied
    assert flight.vehicle.mode is FlightMode.DISARMED


def test_a_companion_is_a_part_of_the_vehicle(fake):
    connected(fake)
    assert {(system, kind) for _, system, kind in fake.heartbeats[1:]} == {(1, 18)}
    times = [at for at, _, _ in fake.heartbeats[1:]]
    assert np.diff(times) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("make", FAKES)
def test_not_ready_to_arm_says_why(make):
    fake = make(FakeConfig(settle_s=100.0))
    vehicle = TetheredVehicle(fake)
    with pytest.raises(VehicleError, match="no autopilot within"):
        vehicle.connect()
    vehicle.step(1.0)
    assert not vehicle.state.healthy
    assert "it has no position yet" in vehicle.state.trouble


def test_requests_out_of_place_are_refused(fake):
    flight = connected(fake)
    vehicle = flight.vehicle
    assert not vehicle.take_off(3.0)
    assert not vehicle.land()
    assert not vehicle.hold()
    assert not vehicle.send(AHEAD, vehicle.now_ns)
    for height in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="above 0 m"):
            vehicle.take_off(height)
    flight = hovering(fake)
    vehicle = flight.vehicle
    assert not vehicle.arm()
    assert not vehicle.take_off(3.0)
    assert not vehicle.send(AHEAD, vehicle.now_ns - 300_000_000)
    assert not vehicle.send(Setpoint((math.nan, 0.0, 0.0)), vehicle.now_ns)
    assert vehicle.send(AHEAD, vehicle.now_ns)
    assert not vehicle.send(AHEAD, vehicle.now_ns - 10_000_000)  # older than the last


def test_armed_without_a_take_off_it_locks_again(fake):
    flight = connected(fake)
    assert flight.vehicle.arm()
    flight.until(FlightMode.READY)
    assert flight.vehicle.arm()
    assert flight.until(FlightMode.DISARMED) == pytest.approx(10.0, abs=1.0)


def test_hold_cuts_a_take_off_and_a_landing_short(fake):
    flight = connected(fake)
    flight.vehicle.arm()
    flight.vehicle.take_off(6.0)
    flight.until(lambda: fake.height_m > 2.0)
    assert flight.vehicle.hold()
    flight.until(FlightMode.HOLDING, 1.0)
    flight.turns(3.0)
    assert fake.height_m < 3.6
    assert flight.vehicle.land()
    flight.until(FlightMode.LANDING, 1.0)
    assert flight.vehicle.land()  # says so again, and does nothing
    assert flight.vehicle.hold()
    flight.until(FlightMode.HOLDING, 1.0)
    height = fake.height_m
    flight.turns(2.0)
    assert fake.height_m == pytest.approx(height, abs=0.3)


def test_after_a_hold_only_new_setpoints_steer(fake):
    flight = steered(fake, AHEAD)
    assert flight.vehicle.hold()
    assert not flight.vehicle.send(AHEAD, flight.vehicle.now_ns)
    flight.until(FlightMode.HOLDING, 1.0)
    flight.turns(2.0)
    assert flight.vehicle.mode is FlightMode.HOLDING
    assert flight.speed_m_s < 0.1
    flight.until(FlightMode.STEERED, 2.0, AHEAD)


def test_let_go_of_it_holds(fake):
    flight = steered(fake, AHEAD)
    flight.vehicle.close()
    flight.until(FlightMode.HOLDING, 1.0)


def test_met_in_the_air_what_hovers_is_taken_over_and_what_is_flown_by_stick_is_not(fake):
    hovering(fake)
    second = TetheredVehicle(fake)
    second.now_s = fake.now_s
    second.connect()
    assert second.mode is FlightMode.HOLDING
    fake.pilot(fake.POSITION if isinstance(fake, FakePx4) else fake.LOITER)
    third = TetheredVehicle(fake)
    third.now_s = fake.now_s
    third.connect()
    assert third.mode is FlightMode.MANUAL
    assert not third.hold()


def test_met_while_somebody_lands_it_it_is_not_taken_over(fake):
    hovering(fake)
    fake.pilot(fake.LAND)
    second = TetheredVehicle(fake)
    second.now_s = fake.now_s
    second.connect()
    assert second.mode is FlightMode.MANUAL
    assert not second.hold() and fake.mode == fake.LAND


def test_met_armed_on_the_ground_it_is_ready_whatever_its_mode(fake):
    flight = connected(fake)
    fake.pilot(fake.POSITION if isinstance(fake, FakePx4) else fake.LOITER)
    fake._arm()
    flight.turns(0.2)
    second = TetheredVehicle(fake)
    second.now_s = fake.now_s
    second.connect()
    for _ in range(45):
        second.beat(second.now_ns)
        second.step(1 / 30)
    assert second.mode is FlightMode.READY


def test_met_in_the_air_in_a_failsafe_it_is_not_taken_over(fake):
    hovering(fake)
    fake.critical = True
    second = TetheredVehicle(fake)
    second.now_s = fake.now_s
    second.connect()
    assert second.mode is FlightMode.MANUAL
    assert not second.hold()


def test_configuration_is_checked():
    with pytest.raises(InputError, match="rate_hz must be 8 to 100"):
        MavlinkConfig(rate_hz=2)
    with pytest.raises(InputError, match="stream_hz"):
        MavlinkConfig(stream_hz=0)
    with pytest.raises(InputError, match="fresh_s"):
        MavlinkConfig(fresh_s=1.0)


@pytest.mark.parametrize("action", [1, 3, 4, 6])
def test_whatever_returns_first_is_warned_about(action):
    """FS_GCS_ENABLE 6 (landing sequence, or return to launch) used to pass."""
    fake = FakeArduPilot()
    fake.parameters |= {"FS_GCS_ENABLE": (action, 2), "FENCE_ACTION": (0, 2)}
    said = "\n".join(connected(fake).vehicle.warnings)
    assert f"FS_GCS_ENABLE is {action}" in said
    assert "FENCE_ACTION is 0" in said
