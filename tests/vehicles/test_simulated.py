import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.sim.quadrotor import EstimateConfig, Quadrotor, QuadrotorConfig
from wigwag.sim.wind import WindConfig
from wigwag.vehicles import FlightMode, SimulatedVehicle, Vehicle

DT = 1 / 30
AHEAD = Setpoint((0.8, 0.0, 0.0))


def make(height=0.0, gust=0.0, estimate=None):
    config = QuadrotorConfig(
        (0.0, 0.0, height), wind=WindConfig(gust_m_s=gust), estimate=estimate or EstimateConfig.exact()
    )
    quad = Quadrotor(config, seed=2)
    return SimulatedVehicle(quad, airborne=height > 0), quad


def run(vehicle, seconds, setpoint=None):
    for _ in range(round(seconds / DT)):
        if setpoint is not None:
            vehicle.send(setpoint, vehicle.state.stamp_ns)
        vehicle.step(DT)


def until(vehicle, mode, limit_s=15.0):
    steps = 0
    while vehicle.mode is not mode:
        vehicle.step(DT)
        steps += 1
        assert steps * DT < limit_s, f"still {vehicle.mode} after {limit_s} s"
    return steps * DT


def test_it_is_a_vehicle():
    vehicle: Vehicle = make()[0]
    vehicle.connect()
    vehicle.beat(0)
    assert vehicle.mode is FlightMode.DISARMED
    assert not vehicle.state.armed
    assert vehicle.warnings == ()
    assert vehicle.capabilities.own_timeout_s == 0.5
    vehicle.close()
    assert vehicle.mode is FlightMode.DISARMED


def test_let_go_of_while_steered_it_holds():
    vehicle, _ = make(height=1.5)
    run(vehicle, 0.2, AHEAD)
    vehicle.close()
    assert vehicle.mode is FlightMode.HOLDING


def test_a_state_tells_the_age_of_its_parts():
    state = VehicleState(np.zeros(3), np.zeros(3), 0.0, 10**9)
    assert (
        state.position_age_s(2 * 10**9)
        == state.attitude_age_s(2 * 10**9)
        == state.link_age_s(2 * 10**9)
        == 1.0
    )
    frozen = VehicleState(np.zeros(3), np.zeros(3), 0.0, 10**9, position_ns=10**9, link_ns=3 * 10**9)
    assert frozen.link_age_s(3 * 10**9) == 0.0
    assert frozen.position_age_s(3 * 10**9) == 2.0


@pytest.mark.parametrize("gust, estimate", [(0.0, EstimateConfig.exact()), (2.0, EstimateConfig())])
def test_takes_off_hovers_and_lands(gust, estimate):
    vehicle, quad = make(gust=gust, estimate=estimate)
    assert vehicle.arm()
    run(vehicle, 0.5)
    assert vehicle.mode is FlightMode.READY
    assert quad.on_ground
    assert vehicle.take_off(1.5)
    until(vehicle, FlightMode.HOLDING)
    run(vehicle, 1.0)
    assert quad.state.position_m[2] == pytest.approx(1.5, abs=0.2)
    assert np.linalg.norm(quad.state.position_m[:2]) < 0.4
    assert vehicle.land()
    until(vehicle, FlightMode.DISARMED)
    assert quad.on_ground
    assert not quad.state.armed
    run(vehicle, 0.5)
    assert quad.state.position_m[2] == 0.0
    # And again.
    assert vehicle.arm()
    assert vehicle.take_off(1.0)
    until(vehicle, FlightMode.HOLDING)
    assert quad.state.position_m[2] == pytest.approx(1.0, abs=0.25)


def test_touches_down_gently():
    vehicle, quad = make(height=1.5)
    vehicle.land()
    sink = 0.0
    while not quad.on_ground:
        sink = quad.state.velocity_m_s[2]
        vehicle.step(DT)
    assert -0.4 < sink < 0


def test_a_silent_pilot_is_a_dead_man():
    vehicle, quad = make(height=1.5)
    run(vehicle, 1.5, AHEAD)
    assert vehicle.mode is FlightMode.STEERED
    run(vehicle, 0.45)
    assert quad.state.velocity_m_s[0] > 0.7  # still flies the last set-point
    run(vehicle, 0.1)
    assert vehicle.mode is FlightMode.HOLDING
    run(vehicle, 1.0)
    assert abs(quad.state.velocity_m_s[0]) < 0.1
    at = quad.state.position_m[0]
    run(vehicle, 2.0)
    assert abs(quad.state.position_m[0] - at) < 0.1


def test_an_old_setpoint_is_refused_and_repeating_it_does_not_help():
    vehicle, quad = make(height=1.5)
    run(vehicle, 1.0)
    stamp = vehicle.state.stamp_ns
    assert not vehicle.send(AHEAD, stamp - 600_000_000)
    assert vehicle.mode is FlightMode.HOLDING
    for _ in range(60):
        vehicle.send(AHEAD, stamp)
        vehicle.step(DT)
    assert vehicle.mode is FlightMode.HOLDING
    assert quad.state.position_m[0] < 0.8


def test_requests_out_of_place_are_refused():
    vehicle, _ = make()
    assert not vehicle.take_off(1.0)  # not armed
    assert not vehicle.land()
    assert not vehicle.hold()
    assert not vehicle.send(AHEAD, 0)
    assert vehicle.arm()
    assert not vehicle.send(AHEAD, 0)  # on the ground
    assert vehicle.take_off(1.5)
    run(vehicle, 0.3)
    assert not vehicle.arm()
    assert not vehicle.take_off(2.0)
    assert not vehicle.send(AHEAD, vehicle.state.stamp_ns)  # take-off goes first
    assert vehicle.hold()  # stop always wins
    assert vehicle.mode is FlightMode.HOLDING


def test_hold_stops_a_landing():
    vehicle, quad = make(height=1.5)
    vehicle.land()
    run(vehicle, 0.8)
    assert vehicle.hold()
    height = quad.state.position_m[2]
    run(vehicle, 2.0)
    assert quad.state.position_m[2] == pytest.approx(height, abs=0.2)


def test_take_off_to_nowhere_is_an_error():
    vehicle, _ = make()
    vehicle.arm()
    for height in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="above 0 m"):
            vehicle.take_off(height)
