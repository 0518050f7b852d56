"""A real rclpy node at the other end; skipped where rclpy is not installed."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
import pytest

from wigwag.drones import open_vehicle
from wigwag.errors import InputError, MissingExtraError, VehicleError
from wigwag.fly.values import Setpoint
from wigwag.sim.pointmass import PointMass
from wigwag.vehicles import FlightMode
from wigwag.vehicles.ros2 import Ros2Config, ros2_vehicle


@pytest.fixture(scope="module")
def rclpy():
    # Before the middleware is loaded: these nodes meet on this machine alone.
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    try:
        import rclpy
    except ImportError as error:
        pytest.skip(f"rclpy is not installed here ({error})")
    return rclpy


class DroneNode:
    """A drone of a point mass: follows the set-points it hears, tells its odometry, answers services."""

    def __init__(self, namespace: str) -> None:
        from geometry_msgs.msg import TwistStamped
        from nav_msgs.msg import Odometry
        from std_srvs.srv import Trigger

        from wigwag.vehicles.rclnode import RclNode

        self.ros = RclNode("test_drone")
        self.body = PointMass()
        self.heard: list[tuple[float, TwistStamped]] = []
        self.called: list[str] = []
        self.doing = "stand"
        self.odometry = Odometry
        node = self.ros.node
        self.publisher = node.create_publisher(Odometry, f"{namespace}/odom", 1)
        node.create_subscription(TwistStamped, f"{namespace}/cmd_vel", self.hear, 10)
        for name in ("arm", "take_off", "land", "hold"):
            node.create_service(Trigger, f"{namespace}/{name}", lambda q, a, name=name: self.serve(name, a))
        node.create_timer(0.02, self.fly)

    def hear(self, message) -> None:
        self.heard.append((time.monotonic(), message))

    def serve(self, name, answer):
        self.called.append(name)
        self.doing = name
        self.body.set_motors(True)
        answer.success, answer.message = True, name
        return answer

    def fly(self) -> None:
        height = float(self.body.state.position_m[2])
        wanted = Setpoint()
        if self.doing == "take_off":
            wanted = Setpoint((0.0, 0.0, min(2.0, 3.0 * (1.5 - height))))
        elif self.doing == "land":
            wanted = Setpoint((0.0, 0.0, -1.0))
        if self.doing == "take_off" and self.heard and time.monotonic() - self.heard[-1][0] < 0.5:
            twist = self.heard[-1][1].twist
            wanted = Setpoint((twist.linear.x, twist.linear.y, twist.linear.z), twist.angular.z)
        self.body.step(wanted, 0.02)
        state, message = self.body.measured, self.odometry()
        message.header.frame_id, message.child_frame_id = "odom", "base_link"
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y, pose.position.z = (float(v) for v in state.position_m)
        pose.orientation.z, pose.orientation.w = (float(f(state.heading_rad / 2)) for f in (np.sin, np.cos))
        cos, sin = np.cos(state.heading_rad), np.sin(state.heading_rad)
        vx, vy, vz = state.velocity_m_s
        twist.linear.x, twist.linear.y = float(cos * vx + sin * vy), float(-sin * vx + cos * vy)
        twist.linear.z = float(vz)
        self.publisher.publish(message)


@pytest.fixture
def drone(rclpy):
    node = DroneNode("/drone1")
    yield node
    node.ros.close()


def until(true, limit_s=10.0, turn=lambda: None):
    pause, end = threading.Event(), time.monotonic() + limit_s
    while not true():
        turn()
        pause.wait(0.02)
        assert time.monotonic() < end, "too late"


def test_a_node_receives_setpoints_and_drives_the_chain_by_odometry(drone):
    vehicle = open_vehicle("ros2:/drone1?arm=arm")
    vehicle.connect()
    try:
        assert vehicle.capabilities.arms and vehicle.capabilities.takes_off
        until(
            lambda: vehicle.mode is FlightMode.TAKING_OFF, turn=lambda: vehicle.arm() and vehicle.take_off()
        )
        until(lambda: vehicle.mode is FlightMode.HOLDING)
        assert vehicle.state.position_m[2] == pytest.approx(1.5, abs=0.3)
        wanted = Setpoint((0.8, -0.4, 0.0), 0.5)
        until(
            lambda: vehicle.state.velocity_m_s[:2] @ vehicle.state.velocity_m_s[:2] > 0.7,
            turn=lambda: vehicle.send(wanted, time.monotonic_ns()),
        )
        message = drone.heard[-1][1]
        assert message.header.frame_id == "base_link"
        linear = message.twist.linear
        assert (linear.x, linear.y, linear.z) == (0.8, -0.4, 0.0)
        assert message.twist.angular.z == 0.5
        assert vehicle.mode is FlightMode.STEERED
        assert vehicle.state.position_age_s(time.monotonic_ns()) < 0.2
        assert abs(vehicle.state.heading_rad) > 0.05
        until(lambda: vehicle.mode is FlightMode.HOLDING)  # the loop fell silent
        assert drone.called[-1] == "hold"
        count = len(drone.heard)
        until(lambda: vehicle.land() and vehicle.mode is FlightMode.LANDING)
        until(lambda: vehicle.mode is FlightMode.DISARMED)
        assert len(drone.heard) <= count + 1
    finally:
        vehicle.close()
    assert list(dict.fromkeys(drone.called)) == ["arm", "take_off", "hold", "land"]


def test_a_drone_that_is_not_there(rclpy):
    vehicle = ros2_vehicle(Ros2Config("/nobody", find_s=0.3))
    with pytest.raises(VehicleError, match="no odometry came on /nobody/odom within"):
        vehicle.connect()


def test_without_rclpy_the_extra_is_named(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(MissingExtraError, match=r"wigwag\[ros2\]"):
        open_vehicle("ros2:/drone1").connect()


def test_names_are_checked():
    with pytest.raises(InputError, match="no name of a ROS topic"):
        open_vehicle("ros2:/drone 1")
    with pytest.raises(InputError, match="must not be empty"):
        Ros2Config(odom="")
    config = Ros2Config("/a/", odom="/absolute")
    assert config.full(config.cmd) == "/a/cmd_vel"
    assert config.full(config.odom) == "/absolute"
    vehicle = open_vehicle("ros2:/drone1?take_off=-&hold=-")
    assert not vehicle.capabilities.takes_off
    assert not vehicle.capabilities.arms
