import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vehicles.messages import odometry
from wigwag.errors import InputError
from wigwag.fly.operator import rotation
from wigwag.fly.values import HOVER, Setpoint
from wigwag.vehicles import Capabilities, FlightMode, Vehicle
from wigwag.vehicles.odometry import state_of
from wigwag.vehicles.streamed import StreamConfig, StreamedVehicle

S = 10**9
AHEAD = Setpoint((1.0, 0.0, 0.0))


class Drone:
    """A middleware that notes what it is told, and a clock turned by hand."""

    def __init__(self, services=("arm", "take_off", "land", "hold")):
        self.services = frozenset(services)
        self.sent, self.called = [], []
        self.refuse, self.slow, self.pending = "", False, []
        self.now_ns = S
        self.vehicle = StreamedVehicle(self, Capabilities("test", 0.22), lambda: self.now_ns)
        self.height, self.x, self.moving = 0.0, 0.0, True

    def open(self): ...

    def close(self): ...

    def publish(self, setpoint):
        self.sent.append((self.now_ns, setpoint))

    def call(self, service, answer):
        self.called.append(service)
        if self.slow:
            self.pending.append(answer)
        else:
            answer(not self.refuse, self.refuse)

    def turn(self, setpoint=None, climb=0.0):
        self.now_ns += S // 30
        self.x += 1e-6 if self.moving else 0.0
        self.vehicle.observed(state_of(odometry((self.x, 0, self.height), (0, 0, climb)), self.now_ns))
        if setpoint:
            self.vehicle.send(setpoint, self.now_ns)
        self.vehicle.tick(self.now_ns)

    def turns(self, seconds, setpoint=None, climb=0.0):
        for _ in range(round(seconds * 30)):
            self.turn(setpoint, climb)

    def fly(self):
        self.turn()
        assert self.vehicle.arm() and self.vehicle.take_off(1.0)
        self.height = 1.5
        self.turns(1.5)
        assert self.vehicle.mode is FlightMode.HOLDING
        return self


def test_a_mission():
    drone = Drone()
    vehicle: Vehicle = drone.vehicle
    drone.turn()
    assert vehicle.mode is FlightMode.DISARMED
    assert not vehicle.state.armed
    assert not vehicle.take_off(1.0) and not vehicle.hold() and not vehicle.land()
    assert vehicle.arm()
    assert vehicle.mode is FlightMode.READY
    assert vehicle.take_off(1.0)
    drone.turns(1.0, climb=0.5)
    assert vehicle.mode is FlightMode.TAKING_OFF
    assert not vehicle.send(AHEAD, drone.now_ns)
    drone.height = 1.2
    drone.turns(1.2)
    assert vehicle.mode is FlightMode.HOLDING
    drone.turns(1.0, AHEAD)
    assert vehicle.mode is FlightMode.STEERED
    assert len(drone.sent) == 30 and drone.sent[-1][1] == AHEAD
    assert vehicle.land()
    drone.turns(0.5, AHEAD, climb=-0.5)
    assert vehicle.mode is FlightMode.LANDING
    assert len(drone.sent) == 30
    drone.height = 0.05
    drone.turns(1.2)
    assert vehicle.mode is FlightMode.DISARMED
    assert drone.called == ["arm", "take_off", "land"]


def test_a_loop_that_hangs_stands_still_then_holds_then_falls_silent():
    drone = Drone().fly()
    drone.turns(1.0, AHEAD)
    hung = drone.now_ns
    drone.turns(3.0)
    after = [((at - hung) / S, setpoint) for at, setpoint in drone.sent if at > hung]
    assert max(at for at, setpoint in after if setpoint == AHEAD) <= 0.22
    still = [at for at, setpoint in after if setpoint == HOVER]
    assert still[0] < 0.3 and still[-1] < 0.85
    assert drone.called[-1] == "hold"
    assert drone.vehicle.mode is FlightMode.HOLDING


def test_old_disordered_and_unfinished_setpoints_are_refused():
    drone = Drone().fly()
    vehicle, now = drone.vehicle, drone.now_ns
    assert not vehicle.send(AHEAD, now - 300_000_000)
    assert not vehicle.send(Setpoint((math.inf, 0, 0)), now)
    assert vehicle.send(AHEAD, now)
    assert not vehicle.send(AHEAD, now - 1)


def test_without_services_a_pilot_does_it_and_holding_is_silence():
    drone = Drone(services=("land",))
    drone.turn()
    assert drone.vehicle.arm()
    assert not drone.vehicle.take_off(1.0)
    drone = Drone(services=("land",))
    drone.height = 2.0  # met in the air
    drone.turn()
    assert drone.vehicle.mode is FlightMode.HOLDING
    assert drone.vehicle.state.position_m[2] == 2.0
    drone.turns(0.5, AHEAD)
    assert drone.vehicle.hold()
    assert drone.sent[-1][1] == HOVER
    count = len(drone.sent)
    drone.turns(1.0)
    assert len(drone.sent) == count
    assert drone.called == []


def test_a_refused_service_is_told():
    drone = Drone()
    drone.refuse = "battery low"
    drone.turn()
    assert drone.vehicle.arm()
    assert drone.vehicle.mode is FlightMode.DISARMED
    assert drone.vehicle.state.denied == "arm was refused: battery low"
    drone.refuse = ""
    assert drone.vehicle.arm()
    assert drone.vehicle.state.denied == ""


def test_a_take_off_may_be_asked_for_while_it_arms():
    drone = Drone()
    drone.slow = True
    drone.turn()
    assert drone.vehicle.arm() and drone.vehicle.take_off(1.0)
    assert drone.called == ["arm"]
    drone.pending.pop()(False, "not now")
    assert drone.called == ["arm"]
    assert drone.vehicle.arm() and drone.vehicle.take_off(1.0)
    drone.pending.pop()(True, "")
    assert drone.called == ["arm", "arm", "take_off"]
    drone.pending.pop()(True, "")
    assert drone.vehicle.mode is FlightMode.TAKING_OFF


def test_a_frozen_position_grows_old():
    drone = Drone().fly()
    drone.turns(0.5, AHEAD)
    assert drone.vehicle.state.position_age_s(drone.now_ns) == 0.0
    drone.moving = False
    drone.turns(1.0, AHEAD)
    assert 0.6 < drone.vehicle.state.position_age_s(drone.now_ns) < 0.8
    assert drone.vehicle.state.link_age_s(drone.now_ns) == 0.0


def test_what_is_reported_counts_more_than_what_was_asked():
    drone = Drone().fly()
    drone.turns(0.5, AHEAD)
    drone.vehicle.report(FlightMode.HOLDING)
    assert drone.vehicle.mode is FlightMode.STEERED
    drone.vehicle.report(FlightMode.MANUAL)
    assert not drone.vehicle.send(AHEAD, drone.now_ns)
    assert not drone.vehicle.hold() and not drone.vehicle.land()
    count = len(drone.sent)
    drone.turns(1.0, AHEAD)
    assert len(drone.sent) == count


def test_let_go_of_it_holds():
    drone = Drone().fly()
    drone.vehicle.connect()
    drone.vehicle.connect()
    drone.turns(0.3, AHEAD)
    drone.vehicle.close()
    drone.vehicle.close()
    assert drone.called[-1] == "hold"


def test_bad_numbers_are_errors():
    with pytest.raises(InputError, match="8 to 100"):
        StreamConfig(rate_hz=1)
    with pytest.raises(InputError, match="above 0 m"):
        Drone().vehicle.take_off(-1)


angles = st.floats(-1.4, 1.4)


@given(st.floats(-3.1, 3.1), angles, angles, st.tuples(angles, angles, angles))
def test_odometry_speaks_of_the_body(heading, pitch, roll, velocity):
    quaternion = _product(
        (0, 0, math.sin(heading / 2), math.cos(heading / 2)),
        _product(
            (0, math.sin(pitch / 2), 0, math.cos(pitch / 2)), (math.sin(roll / 2), 0, 0, math.cos(roll / 2))
        ),
    )
    state = state_of(odometry((1, 2, 3), velocity, quaternion), 5)
    assert (state.heading_rad, state.pitch_rad, state.roll_rad) == pytest.approx(
        (heading, pitch, roll), abs=1e-6
    )
    assert state.velocity_m_s == pytest.approx(rotation(state) @ np.array(velocity), abs=1e-9)
    world = state_of(odometry((1, 2, 3), velocity, quaternion, child="odom"), 5)
    assert world.velocity_m_s == pytest.approx(np.array(velocity))
    assert state.stamp_ns == 5


@pytest.mark.parametrize(
    "broken", [{"position": (math.nan, 0, 0)}, {"velocity": (0, math.inf, 0)}, {"quaternion": (0, 0, 0, 0)}]
)
def test_odometry_that_is_none(broken):
    assert state_of(odometry(**broken), 5) is None


def _product(a, b):
    (x1, y1, z1, w1), (x2, y2, z2, w2) = a, b
    return (
        w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
        w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
        w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
    )
