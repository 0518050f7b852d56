"""Everything that goes wrong between wigwag and an autopilot, and how it ends."""

import math

import numpy as np
import pytest

from tests.vehicles.mavlink.flights import FAKES, connected, hovering, steered
from wigwag.fly.values import HOVER, Setpoint
from wigwag.sim.autopilot_config import FakeConfig
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.wire import WireConfig
from wigwag.vehicles import FlightMode

AHEAD, BACK = Setpoint((1.0, 0.0, 0.0)), Setpoint((-1.0, 0.0, 0.0))
ARM, TAKE_OFF, SET_MODE, INTERVAL = 400, 22, 176, 511


@pytest.fixture(params=FAKES, ids=lambda fake: fake.__name__)
def fake(request):
    return request.param()


def sticks(fake):
    return fake.POSITION if isinstance(fake, FakePx4) else fake.LOITER


# The loop.


def test_a_loop_that_hangs_stands_still_then_holds(fake):
    """Zero velocity within 300 ms, hold within a second, while everything but the loop lives."""
    flight = steered(fake, AHEAD)
    hung_s = flight.vehicle.now_s
    flight.freeze(0.30)
    last = flight.sent("SET_POSITION_TARGET_LOCAL_NED", hung_s)
    assert last[-1][1].vx == 0.0 == last[-1][1].vy
    flight.freeze(0.70)
    assert flight.vehicle.mode is FlightMode.HOLDING
    assert fake.mode == (fake.HOLD if isinstance(fake, FakePx4) else fake.BRAKE)
    flight.freeze(3.0)
    assert flight.speed_m_s < 0.05
    after = [at for at, _ in flight.sent("SET_POSITION_TARGET_LOCAL_NED", hung_s + 1.0)]
    assert not after
    assert not [at for at, _ in flight.sent("HEARTBEAT", hung_s + 2.0)]  # nor a heartbeat


def test_nothing_older_than_a_quarter_of_a_second_is_sent(fake):
    flight = steered(fake, AHEAD)
    hung_s = flight.vehicle.now_s
    flight.freeze(1.0)
    late = [m.vx or m.vy for at, m in flight.sent("SET_POSITION_TARGET_LOCAL_NED", hung_s + 0.25)]
    assert late and not any(late)


def test_what_is_old_disordered_or_no_number_is_refused_at_once(fake):
    flight = steered(fake, AHEAD)
    vehicle, now_ns = flight.vehicle, flight.vehicle.now_ns
    assert vehicle.send(AHEAD, now_ns)
    assert not vehicle.send(AHEAD, now_ns - 300_000_000), "old"
    assert not vehicle.send(AHEAD, now_ns - 20_000_000), "older than the one before"
    for nothing in (math.nan, math.inf):
        assert not vehicle.send(Setpoint((nothing, 0.0, 0.0)), now_ns)
        assert not vehicle.send(Setpoint(yaw_rate_rad_s=nothing), now_ns)
    assert vehicle.send(AHEAD, now_ns)


def test_a_set_point_that_is_the_newest_and_old_is_refused(fake):
    flight = steered(fake, AHEAD)
    flight.freeze(0.6)
    assert not flight.vehicle.send(AHEAD, flight.vehicle.now_ns - 300_000_000)
    assert flight.vehicle.send(AHEAD, flight.vehicle.now_ns - 200_000_000)


def test_a_set_point_from_just_before_a_hold_does_not_steer_after_it(fake):
    """The autopilot holds within a tenth of a second; what was sent last would be fresh for another tenth."""
    flight = steered(fake, AHEAD)
    assert flight.vehicle.send(AHEAD, flight.vehicle.now_ns)
    assert flight.vehicle.hold()
    held_s = flight.vehicle.now_s
    flight.freeze(1.0)
    assert fake.mode == (fake.HOLD if isinstance(fake, FakePx4) else fake.BRAKE)
    sent = flight.sent("SET_POSITION_TARGET_LOCAL_NED", held_s)
    assert not any(m.vx or m.vy for _, m in sent)


def test_a_stamp_from_the_future_does_not_stay_fresh(fake):
    flight = steered(fake, AHEAD)
    assert flight.vehicle.send(AHEAD, flight.vehicle.now_ns + 5_000_000_000)
    flight.freeze(0.5)
    assert fake.received[-1][1].vx == 0.0 == fake.received[-1][1].vy


def test_a_loop_that_stutters_is_not_put_on_hold(fake):
    flight = steered(fake, AHEAD)
    for _ in range(5):
        flight.freeze(0.4)
        flight.turns(0.5, AHEAD)
        assert flight.vehicle.mode is FlightMode.STEERED
    assert fake.mode == (fake.OFFBOARD if isinstance(fake, FakePx4) else fake.GUIDED)


def test_a_loop_that_lives_without_setpoints_keeps_its_heartbeat_and_holds(fake):
    flight = steered(fake, AHEAD)
    quiet_s = flight.vehicle.now_s
    flight.turns(3.0)
    assert flight.vehicle.mode is FlightMode.HOLDING
    assert len(flight.sent("HEARTBEAT", quiet_s)) >= 3


def test_a_program_that_dies_leaves_the_vehicle_to_its_own_timeout(fake):
    flight = steered(fake, AHEAD)
    flight.vehicle.up.config.cut = True  # nothing leaves any more
    x = fake.airframe.state.position_m[0]
    flight.freeze(3.0)
    assert flight.speed_m_s < 0.05
    assert fake.airframe.state.position_m[0] - x < 2.0
    assert fake.mode == (fake.HOLD if isinstance(fake, FakePx4) else fake.GUIDED)


# The link.


@pytest.mark.parametrize(
    "bad",
    [
        {"loss": 0.2}, {"delay_s": 0.15, "jitter_s": 0.1}, {"late": 0.2}, {"twice": 0.5}, {"damaged": 0.1},
        {"loss": 0.1, "late": 0.1, "twice": 0.2, "damaged": 0.05, "jitter_s": 0.05},
    ],
    ids=["lossy", "slow", "reordered", "doubled", "damaged", "all of it"],
)  # fmt: skip
@pytest.mark.parametrize("seed", range(3))
def test_a_mission_over_a_bad_link(fake, bad, seed):
    flight = hovering(fake, up=WireConfig(**bad), down=WireConfig(**bad), seed=seed)
    assert fake.height_m == pytest.approx(3.0, abs=0.5)
    flight.until(FlightMode.STEERED, setpoint=AHEAD)
    before = fake.airframe.state.position_m[0]
    flight.turns(4.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.STEERED
    assert fake.airframe.state.position_m[0] - before == pytest.approx(4.0, abs=0.6)
    assert flight.vehicle.session.talk.telemetry.restarts == 0
    assert flight.vehicle.land()
    flight.until(FlightMode.DISARMED)
    assert fake.height_m == 0


def test_late_messages_do_not_turn_back_time():
    flight = hovering(FakePx4(), down=WireConfig(late=0.3, late_s=0.3))
    stamps = []
    for _ in range(90):
        flight.turn(AHEAD)
        stamps.append(flight.vehicle.state.stamp_ns)
    assert (np.diff(stamps) >= 0).all()


@pytest.mark.parametrize("rate", [0.5, 0.95, 1.0, 1.05, 2.0])
@pytest.mark.parametrize("late_s", [0.003, 0.15])
@pytest.mark.parametrize("make", FAKES)
def test_the_clock_of_a_simulator_that_does_not_keep_up_is_followed(make, late_s, rate):
    """And no state is told younger than it is, over a slow link either."""
    fake = make(FakeConfig(clock_rate=rate))
    flight = steered(fake, AHEAD)
    vehicle, heard = flight.vehicle, flight.vehicle.session.talk.telemetry.position
    vehicle.up.config.delay_s = vehicle.down.config.delay_s = late_s
    ages = []
    for turn in range(600):
        flight.turn(AHEAD if turn % 60 < 30 else BACK)
        measured_s = fake.booted_s + heard.boot_ms * 1e-3 / rate
        told_s = heard.stamp_ns * 1e-9
        assert told_s <= measured_s + 0.01 + (late_s if rate > 1 else 0.0)
        ages.append(vehicle.now_s - told_s)
    assert vehicle.mode is FlightMode.STEERED and max(ages[90:]) < 0.12 + 2 * late_s


def test_a_link_that_is_cut_ages_and_the_autopilot_holds(fake):
    flight = steered(fake, AHEAD)
    flight.vehicle.up.config.cut = flight.vehicle.down.config.cut = True
    flight.turns(3.0, AHEAD)
    state = flight.vehicle.state
    assert state.link_age_s(flight.vehicle.now_ns) == pytest.approx(3.0, abs=0.3)
    assert state.position_age_s(flight.vehicle.now_ns) == pytest.approx(3.0, abs=0.3)
    assert flight.speed_m_s < 0.1
    flight.vehicle.up.config.cut = flight.vehicle.down.config.cut = False
    flight.turns(3.0)
    assert flight.vehicle.mode is FlightMode.HOLDING  # and not: in a pilot's hands
    assert fake.mode == (fake.HOLD if isinstance(fake, FakePx4) else fake.BRAKE)
    assert not fake.critical
    flight.until(FlightMode.STEERED, 3.0, AHEAD)


def test_a_hold_that_the_autopilot_began_by_itself_is_asked_for(fake):
    """It heard nothing, and was seen to hold: PX4's time-out alone would go on as a failsafe."""
    flight = steered(fake, AHEAD)
    flight.vehicle.up.config.cut = True
    flight.turns(0.5, AHEAD)
    flight.turns(4.0)
    assert fake.critical is isinstance(fake, FakePx4)
    flight.vehicle.up.config.cut = False
    flight.turns(3.0)
    assert flight.vehicle.mode is FlightMode.HOLDING and not fake.critical


def test_a_link_that_is_mute_one_way_shows_in_its_age(fake):
    """The vehicle is heard well and hears nothing."""
    flight = steered(fake, AHEAD)
    flight.vehicle.up.config.cut = True
    flight.turns(2.0, AHEAD)
    state, now = flight.vehicle.state, flight.vehicle.now_ns
    assert state.position_age_s(now) < 0.1
    assert state.link_age_s(now) == pytest.approx(2.0, abs=0.3)
    flight.turns(2.0, AHEAD)
    assert flight.speed_m_s < 0.1
    assert flight.vehicle.mode in (FlightMode.HOLDING, FlightMode.STEERED)


# The autopilot.


def test_other_systems_on_the_link_are_not_heard(fake):
    flight = steered(fake, AHEAD)
    fake.faults.system = 7
    began = flight.vehicle.state.stamp_ns
    flight.turns(1.0, AHEAD)
    assert flight.vehicle.state.stamp_ns - began < 100_000_000
    assert flight.vehicle.state.link_age_s(flight.vehicle.now_ns) > 0.9


def test_a_reboot_in_flight_is_noticed_and_nothing_is_sent_on(fake):
    flight = steered(fake, AHEAD)
    fake.reboot()
    at_s = flight.vehicle.now_s
    flight.turns(4.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.DISARMED
    assert "restarted" in flight.vehicle.state.trouble
    assert not flight.sent("SET_POSITION_TARGET_LOCAL_NED", at_s + 2.5)
    assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) < 0.1  # messages asked for anew


def test_a_reboot_on_the_ground_does_not_stand_in_the_way(fake):
    flight = connected(fake)
    fake.reboot()
    flight.turns(5.0)
    assert flight.vehicle.arm()
    assert flight.vehicle.take_off(2.0)
    flight.until(FlightMode.HOLDING)


@pytest.mark.parametrize("command", [ARM, TAKE_OFF, SET_MODE])
def test_a_denied_command_is_told_and_the_vehicle_stays_down(fake, command):
    flight = connected(fake)
    fake.faults.deny.add(command)
    assert flight.vehicle.arm()
    assert flight.vehicle.take_off(3.0)
    flight.turns(6.0)
    assert "denied" in flight.vehicle.state.denied
    assert flight.vehicle.mode in (FlightMode.DISARMED, FlightMode.READY)
    assert fake.height_m == 0
    fake.faults.deny.clear()
    flight.until(FlightMode.DISARMED)
    assert flight.vehicle.arm()
    assert flight.vehicle.state.denied == ""


@pytest.mark.parametrize("command", [ARM, TAKE_OFF, SET_MODE])
def test_an_acknowledgement_that_never_comes_is_not_needed(fake, command):
    """What the autopilot is seen to do counts."""
    fake.faults.mute.add(command)
    flight = hovering(fake)
    flight.until(FlightMode.STEERED, setpoint=AHEAD)
    assert flight.vehicle.land()
    flight.until(FlightMode.DISARMED)


@pytest.mark.parametrize("make", FAKES)
def test_an_acknowledgement_of_what_does_not_happen_is_told(make):
    class Liar(make):
        def _arm_request(self, message):
            return 0  # accepted

    flight = connected(Liar())
    assert flight.vehicle.arm()
    flight.turns(6.0)
    assert "accepted to arm, but it did not happen" in flight.vehicle.state.denied
    assert flight.vehicle.mode is FlightMode.DISARMED


def test_commands_that_are_never_answered_end(fake):
    flight = connected(fake)
    fake.faults.deaf = True
    assert flight.vehicle.arm()
    flight.turns(6.0)
    assert "not answered" in flight.vehicle.state.denied
    assert flight.vehicle.mode is FlightMode.DISARMED


def test_a_hold_that_is_denied_is_told_and_asked_for_again():
    flight = steered(FakePx4(), AHEAD)
    flight.fake.faults.deny.add(SET_MODE)
    assert flight.vehicle.hold()
    flight.turns(0.3)
    for _ in range(30):  # it is asked again and again, and what was refused stays said meanwhile
        flight.turn()
        assert "denied" in flight.vehicle.state.denied
    assert flight.speed_m_s < 0.1  # it stands still meanwhile
    flight.fake.faults.deny.clear()
    assert flight.vehicle.hold()
    flight.until(FlightMode.HOLDING, 1.0)
    assert flight.vehicle.state.denied == ""


def test_a_position_that_freezes_grows_old_though_messages_go_on(fake):
    flight = steered(fake, AHEAD)
    assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) < 0.1
    fake.faults.frozen = True
    flight.turns(1.0, AHEAD)
    assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) == pytest.approx(1.0, abs=0.15)
    assert flight.vehicle.state.stamp_ns == flight.vehicle.state.position_ns
    assert flight.vehicle.state.link_age_s(flight.vehicle.now_ns) < 0.3
    fake.faults.frozen = False
    flight.turns(0.2, AHEAD)
    assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) < 0.1


def test_position_without_attitude_steers_nowhere():
    flight = steered(FakePx4(), AHEAD)
    flight.fake._intervals[30] = float("inf")
    flight.turns(1.0, AHEAD)
    assert flight.vehicle.state.attitude_age_s(flight.vehicle.now_ns) > 0.8
    message = flight.fake.received[-1][1]
    assert (message.vx, message.vy) == (0.0, 0.0)


def test_streams_that_stop_are_asked_for_again(fake):
    flight = steered(fake, AHEAD)
    fake._intervals[30] = fake._intervals[32] = float("inf")
    flight.turns(4.0, AHEAD)
    assert flight.vehicle.state.position_age_s(flight.vehicle.now_ns) < 0.1


# Who decides.


def test_a_pilot_wins_and_is_never_fought(fake):
    flight = steered(fake, AHEAD)
    fake.pilot(sticks(fake))
    at_s = flight.vehicle.now_s
    flight.turns(8.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.MANUAL
    assert fake.mode == sticks(fake)
    assert not flight.vehicle.hold()
    assert not flight.vehicle.land()
    assert not flight.vehicle.take_off(2.0)
    assert not flight.vehicle.send(AHEAD, flight.vehicle.now_ns)
    flight.turns(1.0, AHEAD)
    assert fake.mode == sticks(fake)
    assert not flight.sent("COMMAND_LONG", at_s)
    assert not flight.sent("SET_POSITION_TARGET_LOCAL_NED", at_s + 0.3)  # seen within a fifth of a second


@pytest.mark.parametrize("mode", ["RETURN", "LAND", "HOLD"])
def test_a_pilot_who_has_it_return_land_or_hold_is_not_fought_either(mode):
    px4, ardupilot = FakePx4(), FakeArduPilot()
    for fake, name in ((px4, mode), (ardupilot, {"RETURN": "RTL", "HOLD": "BRAKE"}.get(mode, mode))):
        flight = steered(fake, AHEAD)
        fake.pilot(getattr(fake, name))
        flight.turns(3.0, AHEAD)
        assert flight.vehicle.mode is FlightMode.MANUAL
        assert not flight.vehicle.hold()
        flight.turns(1.0, AHEAD)
        assert fake.mode == getattr(fake, name)


@pytest.mark.parametrize("mode", ["sticks", "RETURN", "LAND"])
def test_a_pilot_who_takes_over_because_of_a_warning_is_a_pilot(fake, mode):
    """PX4 goes on saying critical once a pilot took over (FailsafeBase::inFailsafe): that is no failsafe."""
    flight = steered(fake, AHEAD)
    fake.faults.warning = True
    flight.turns(1.5, AHEAD)
    assert flight.vehicle.mode is FlightMode.STEERED and not flight.vehicle.state.healthy
    name = "RTL" if mode == "RETURN" and isinstance(fake, FakeArduPilot) else mode
    chosen = sticks(fake) if mode == "sticks" else getattr(fake, name)
    fake.pilot(chosen)
    flight.turns(2.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.MANUAL
    assert not flight.vehicle.hold() and not flight.vehicle.land()
    flight.turns(1.0, AHEAD)
    assert fake.mode == chosen


def test_sticks_are_a_pilots_even_if_the_warning_comes_up_with_them(fake):
    flight = steered(fake, AHEAD)
    fake.faults.warning = True
    fake.pilot(sticks(fake))
    flight.turns(2.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.MANUAL and not flight.vehicle.hold()


def test_a_failsafe_that_leads_to_the_next_is_one(fake):
    flight = steered(fake, AHEAD)
    fake.critical, fake.mode = True, FakePx4.HOLD if isinstance(fake, FakePx4) else FakeArduPilot.BRAKE
    flight.turns(3.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.FAILSAFE
    fake.mode = FakePx4.RETURN if isinstance(fake, FakePx4) else FakeArduPilot.RTL
    flight.turns(2.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.FAILSAFE
    assert flight.vehicle.hold(), "an operator's stop is passed on"


def test_a_fence_that_was_met_long_ago_does_not_make_a_pilot_a_failsafe():
    fake = FakeArduPilot(FakeConfig(radius_m=6.0))
    fake.parameters["FENCE_ENABLE"] = (1, 2)
    flight = steered(fake, AHEAD)
    flight.turns(6.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.FAILSAFE
    fake.pilot(FakeArduPilot.GUIDED)
    flight.turns(3.0)
    fake.pilot(FakeArduPilot.RTL)
    flight.turns(2.0)
    assert flight.vehicle.mode is FlightMode.MANUAL


def test_a_pilot_who_takes_the_sticks_at_the_fence_is_a_pilot():
    fake = FakeArduPilot(FakeConfig(radius_m=6.0))
    fake.parameters["FENCE_ENABLE"] = (0, 2)  # it tells, and does nothing
    flight = steered(fake, AHEAD)
    flight.until(lambda: flight.vehicle.state.position_m[0] > 6.05, setpoint=AHEAD)
    fake.pilot(FakeArduPilot.LOITER)
    flight.turns(2.0)
    assert flight.vehicle.mode is FlightMode.MANUAL and not flight.vehicle.hold()


def test_a_pilot_gives_it_back_by_choosing_the_mode_that_listens():
    flight = steered(FakeArduPilot(), AHEAD)
    flight.fake.pilot(FakeArduPilot.LOITER)
    flight.turns(2.0, AHEAD)
    flight.fake.pilot(FakeArduPilot.GUIDED)
    flight.until(FlightMode.STEERED, 1.0, AHEAD)
    # PX4 wants a stream before Offboard: it flows, standing still, while the pilot lets PX4 hold.
    flight = steered(FakePx4(), AHEAD)
    flight.fake.pilot(FakePx4.POSITION)
    flight.turns(2.0, AHEAD)
    flight.fake.pilot(FakePx4.HOLD)
    flight.turns(2.0, AHEAD)
    assert flight.vehicle.mode is FlightMode.MANUAL
    assert flight.fake.received[-1][1].vx == 0.0
    flight.fake.pilot(FakePx4.OFFBOARD)
    flight.until(FlightMode.STEERED, 1.0, AHEAD)


def test_a_pilot_who_takes_over_while_a_mode_is_asked_for_wins():
    flight = hovering(FakePx4())
    flight.turns(1.0, HOVER)
    flight.fake.faults.deny.add(SET_MODE)
    flight.turns(0.2, HOVER)
    flight.fake.pilot(FakePx4.POSITION)
    flight.fake.faults.deny.clear()
    flight.turns(3.0, HOVER)
    assert flight.fake.mode == FakePx4.POSITION
    assert flight.vehicle.mode is FlightMode.MANUAL


def test_a_pilot_who_takes_over_what_was_asked_for_in_vain_wins(fake):
    """The request was not heard, and would be sent again: not any more."""
    flight = steered(fake, AHEAD)
    fake.faults.deaf = True
    assert flight.vehicle.land()
    flight.turns(0.2)
    fake.pilot(sticks(fake))
    flight.turns(0.2)
    fake.faults.deaf = False
    flight.turns(3.0)
    assert fake.mode == sticks(fake) and flight.vehicle.mode is FlightMode.MANUAL


def test_a_pilot_who_lands_it_gives_it_back_on_the_ground(fake):
    flight = steered(fake, AHEAD)
    fake.pilot(fake.LAND)
    flight.until(FlightMode.DISARMED)
    assert flight.vehicle.arm()
    flight.until(FlightMode.READY)


def test_the_autopilots_own_failsafe_is_told_from_a_pilot(fake):
    flight = steered(fake, AHEAD)
    fake.battery = 0.05
    flight.until(FlightMode.FAILSAFE, 2.0, AHEAD)
    mode = fake.mode
    assert not flight.vehicle.send(AHEAD, flight.vehicle.now_ns)
    flight.turns(2.0, AHEAD)
    assert fake.mode == mode
    assert not flight.vehicle.state.healthy
    assert flight.vehicle.state.battery == pytest.approx(0.05, abs=0.01)


def test_a_fence_ends_the_flight_outwards():
    for make in FAKES:
        fake = make(FakeConfig(radius_m=6.0))
        flight = steered(fake, AHEAD)
        flight.turns(6.0, AHEAD)
        assert flight.vehicle.mode is FlightMode.FAILSAFE
        assert flight.vehicle.land()  # an operator may still have it land
        flight.until(FlightMode.LANDING, 2.0)
