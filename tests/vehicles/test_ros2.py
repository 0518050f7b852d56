"""A real rclpy node at the other end; skipped where rclpy is not installed."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
import pytest

from wigwag.drones import open_vehicle
from wigwag.errors import InputError, MissingExtraError, VehicleError
from wigwag.evaluate.following import missed, place_around
from wigwag.evaluate.prompted import Nobody, Prompter
from wigwag.fly.follow import Goal
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command, Setpoint
from wigwag.pilot import Pilot, PilotConfig
from wigwag.sim.pointmass import PointMass
from wigwag.sim.stage import Stage, StageConfig
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
        self.doing, self.flown_s = "stand", time.monotonic()
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
        steered = self.doing in ("take_off", "hold")
        if steered and self.heard and time.monotonic() - self.heard[-1][0] < 0.5:
            twist = self.heard[-1][1].twist
            wanted = Setpoint((twist.linear.x, twist.linear.y, twist.linear.z), twist.angular.z)
        now_s = time.monotonic()
        self.body.step(wanted, min(now_s - self.flown_s, 0.1))  # a late timer slows no time down
        self.flown_s = now_s
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
        until(lambda: drone.called[-1] == "hold")  # asked for; the service may be served a moment later
        count = len(drone.heard)
        until(lambda: vehicle.land() and vehicle.mode is FlightMode.LANDING)
        until(lambda: vehicle.mode is FlightMode.DISARMED)
        assert len(drone.heard) <= count + 1
    finally:
        vehicle.close()
    assert list(dict.fromkeys(drone.called)) == ["arm", "take_off", "hold", "land"]


def test_the_chain_follows_a_walking_person_by_odometry_and_twists(drone):
    """Take off, follow an arc, fly a command, land: supervisor, follow law and movements over ROS."""
    vehicle, pause = open_vehicle("ros2:/drone1?arm=arm"), threading.Event()
    vehicle.connect()
    stage = Stage(lambda: vehicle.state, pause.wait, time.monotonic_ns, StageConfig(seed=3))
    config = PilotConfig(mount=stage.config.mount, goal=Goal(altitude_m=1.5))
    pilot = Pilot(stage, Nobody(), vehicle, config=config, time_ns=time.monotonic_ns)
    pilot.spotter = Prompter()  # says nothing: commands come from the console
    off: list[tuple[float, float]] = []

    def turn(asked=None):
        pilot.step(stage.read(), time.monotonic_ns(), asked)
        state, (x, y) = drone.body.state, stage.place_m
        east, north = x - state.position_m[0], y - state.position_m[1]
        bearing = np.degrees(np.angle(np.exp(1j * (np.arctan2(north, east) - state.heading_rad))))
        off.append((abs(bearing), abs(np.hypot(east, north) - pilot.helm.movement.goal.distance_m)))

    def fly(true, limit_s=20.0, asked=None):
        end_s = time.monotonic() + limit_s
        while not true():
            turn(asked)
            asked = None
            assert time.monotonic() < end_s, (pilot.supervisor.mode, vehicle.mode, drone.called)

    def stand(seconds):
        end_s = time.monotonic() + seconds
        fly(lambda: time.monotonic() > end_s)

    try:
        stand(1.5)
        fly(lambda: pilot.supervisor.mode is Mode.FOLLOWING and not pilot.helm.moving, asked=Command.TAKE_OFF)
        assert drone.body.state.position_m[2] == pytest.approx(1.5, abs=0.3)
        stage.walk(0.75, 3.0, 6.0)
        began = len(off)
        stand(6.0)
        bearing, distance = np.mean(off[began:], axis=0)
        assert bearing < 2.0 and distance < 0.3
        assert pilot.supervisor.mode is Mode.FOLLOWING
        stand(2.5)
        before = place_around(drone.body.state.position_m, stage.place_m, 0.0)
        fly(lambda: pilot.supervisor.mode is Mode.EXECUTING, asked=Command.LEFT)
        fly(lambda: pilot.supervisor.mode is Mode.FOLLOWING)
        stand(2.0)
        after = place_around(drone.body.state.position_m, stage.place_m, before[0])
        assert missed(Command.LEFT, before, after, config.movement) < 0.15
        fly(lambda: vehicle.mode is FlightMode.DISARMED, asked=Command.LAND)
        assert drone.body.on_ground
    finally:
        vehicle.close()
    assert list(dict.fromkeys(drone.called)) == ["arm", "take_off", "land"]
    assert len(drone.heard) > 300, "set-points, thirty a second"


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
