import numpy as np
import pytest

from wigwag.drones import open_vehicle, vehicle_forms
from wigwag.fly.values import Setpoint
from wigwag.sim.clocked import ClockedVehicle
from wigwag.vehicles import FlightMode, Vehicle


def test_every_form_is_named():
    for kind in ("sim:", "mavlink:", "ros2:", "mrs:"):
        assert kind in vehicle_forms()


def test_every_vehicle_keeps_the_protocol():
    for address in ("sim:", "mavlink:udp:127.0.0.1:14550", "ros2:/d", "mrs:/uav1"):
        vehicle: Vehicle = open_vehicle(address)
        assert vehicle.mode is FlightMode.DISARMED
        assert vehicle.capabilities.max_setpoint_age_s <= 0.5
        assert vehicle.warnings == ()
        assert not vehicle.state.armed
        vehicle.beat(1)
        vehicle.close()


def test_a_simulated_drone_lives_on_the_clock():
    now = [5 * 10**9]
    drone = ClockedVehicle(seed=3, clock=lambda: now[0])
    drone.connect()

    def turns(seconds, setpoint=None):
        for _ in range(round(seconds * 30)):
            now[0] += 33_333_333
            drone.beat(now[0])
            if setpoint:
                drone.send(setpoint, now[0])

    assert drone.state.stamp_ns == now[0]
    assert drone.arm() and drone.take_off(1.2)
    turns(4.0)
    assert drone.mode is FlightMode.HOLDING
    turns(2.0, Setpoint((0.8, 0.0, 0.0)))
    assert drone.mode is FlightMode.STEERED
    assert np.linalg.norm(drone.state.velocity_m_s) > 0.6
    assert drone.state.stamp_ns == pytest.approx(now[0], abs=2)
    assert drone.hold()
    before = drone.state.position_m
    now[0] += 60 * 10**9  # the program slept: so did the drone
    assert np.linalg.norm(drone.state.position_m - before) < 1.0
    assert drone.state.stamp_ns == pytest.approx(now[0], abs=2)
    assert drone.land()
    turns(5.0)
    assert drone.mode is FlightMode.DISARMED
    drone.close()
