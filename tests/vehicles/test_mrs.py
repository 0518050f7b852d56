"""What is said to and understood of the MRS UAV system, with stand-ins for its messages and for ROS."""

import sys
from types import ModuleType
from types import SimpleNamespace as Message

import pytest

from tests.vehicles.messages import odometry, vector
from wigwag.drones import open_vehicle
from wigwag.errors import InputError, MissingExtraError, VehicleError
from wigwag.fly.values import Setpoint
from wigwag.vehicles import FlightMode
from wigwag.vehicles.mrs import MrsConfig, Ros1, mode_of, mrs_vehicle, start_ros

S = 10**9


def reference():
    return Message(
        header=Message(stamp=None, frame_id=""),
        reference=Message(
            velocity=vector(), altitude=0.0, heading=0.0, heading_rate=0.0, use_altitude=True,
            use_heading=True, use_heading_rate=False,
        ),
    )  # fmt: skip


def diagnostics(tracker="MpcTracker", motors=True, flying=True, rc=False):
    return Message(motors=motors, flying_normally=flying, rc_mode=rc, active_tracker=tracker)


class Ros:
    """Stands where ROS is."""

    def __init__(self):
        self.published, self.called, self.takers = [], [], {}
        self.closed = False

    def types(self):
        return reference, "Diagnostics", "Odometry", "Trigger"

    def publisher(self, topic, kind):
        return lambda message: self.published.append((topic, message))

    def subscribe(self, topic, kind, take):
        self.takers[topic] = take

    def service(self, name, kind):
        def call(answer):
            self.called.append(name)
            answer(True, "")

        return call

    def now(self):
        return "now"

    def wait(self, true, seconds, what):
        self.tell(odometry(), diagnostics("NullTracker"))
        if not true():
            raise VehicleError(what)

    def close(self):
        self.closed = True

    def tell(self, odom, diag):
        self.takers["/uav3/estimation_manager/odom_main"](odom)
        self.takers["/uav3/control_manager/diagnostics"](diag)


def test_a_flight_with_the_managers_of_one_uav():
    ros, now = Ros(), [S]
    vehicle = mrs_vehicle(MrsConfig("uav3"), lambda: now[0], lambda: ros)
    vehicle.connect()
    try:
        assert vehicle.mode is FlightMode.READY
        assert vehicle.arm()  # the pilot did
        assert vehicle.take_off(2.0)
        ros.tell(odometry((0, 0, 0.5)), diagnostics("LandoffTracker", flying=False))
        assert vehicle.mode is FlightMode.TAKING_OFF
        ros.tell(odometry((0, 0, 2.0)), diagnostics())
        assert vehicle.mode is FlightMode.HOLDING
        assert vehicle.send(Setpoint((0.5, 0.2, -0.1), 0.3), now[0])
        vehicle.tick(now[0])
        topic, message = ros.published[-1]
        assert topic == "/uav3/control_manager/velocity_reference"
        assert message.header.frame_id == "uav3/fcu_untilted"
        assert message.header.stamp == "now"
        velocity = message.reference.velocity
        assert (velocity.x, velocity.y, velocity.z) == (0.5, 0.2, -0.1)
        assert message.reference.heading_rate == 0.3
        assert message.reference.use_heading_rate
        assert not message.reference.use_heading and not message.reference.use_altitude
        assert vehicle.mode is FlightMode.STEERED
        assert vehicle.hold()
        assert vehicle.land()
        ros.tell(odometry((0, 0, 1.0)), diagnostics("LandoffTracker", flying=False))
        assert vehicle.mode is FlightMode.LANDING
        ros.tell(odometry(), diagnostics("NullTracker", motors=False, flying=False))
        assert vehicle.mode is FlightMode.DISARMED
        assert not vehicle.arm()  # a pilot does
    finally:
        vehicle.close()
    assert ros.called == [
        "/uav3/uav_manager/takeoff",
        "/uav3/control_manager/hover",
        "/uav3/uav_manager/land",
    ]
    assert ros.closed


@pytest.mark.parametrize(
    "told, asked, mode",
    [
        (diagnostics(motors=False), FlightMode.HOLDING, FlightMode.DISARMED),
        (diagnostics(rc=True), FlightMode.HOLDING, FlightMode.MANUAL),
        (diagnostics("NullTracker"), FlightMode.DISARMED, FlightMode.READY),
        (diagnostics("LandoffTracker"), FlightMode.TAKING_OFF, FlightMode.TAKING_OFF),
        (diagnostics("LandoffTracker"), FlightMode.LANDING, FlightMode.LANDING),
        (diagnostics("MpcTracker"), FlightMode.HOLDING, FlightMode.HOLDING),
        (diagnostics("MpcTracker", flying=False), FlightMode.HOLDING, FlightMode.FAILSAFE),
    ],
)
def test_what_the_control_manager_tells(told, asked, mode):
    assert mode_of(told, asked) is mode


def test_a_pilot_at_the_radio_has_it():
    ros, now = Ros(), [S]
    vehicle = mrs_vehicle(MrsConfig("uav3"), lambda: now[0], lambda: ros)
    vehicle.connect()
    try:
        ros.tell(odometry((0, 0, 2.0)), diagnostics(rc=True))
        assert vehicle.mode is FlightMode.MANUAL
        assert not vehicle.send(Setpoint(), now[0])
        assert not vehicle.land()
        ros.tell(odometry((0, 0, 2.0)), diagnostics("EmergencyTracker", flying=False))
        assert vehicle.mode is FlightMode.FAILSAFE
        assert "emergency" in vehicle.state.trouble
    finally:
        vehicle.close()


def test_names_are_checked_and_missing_ros_says_what_to_source():
    for text in ("mrs:", "mrs:/uav 1", "mrs:/uav1/x"):
        with pytest.raises(InputError, match="no name of a UAV"):
            open_vehicle(text)
    with pytest.raises(InputError, match="must be 1 or 2"):
        open_vehicle("mrs:/uav1?ros=3")
    vehicle = open_vehicle("mrs:/uav1")
    assert vehicle.capabilities.name == "MRS uav1"
    assert not vehicle.capabilities.arms
    with pytest.raises(MissingExtraError, match="Source the workspace that holds mrs_msgs"):
        start_ros(0)


def test_ros_1_is_spoken_through_rospy(monkeypatch):
    """The calls that are made of rospy, not rospy itself."""
    rospy = ModuleType("rospy")
    log = []

    class ServiceException(Exception): ...

    def proxy(name, kind):
        def call():
            if name == "/broken":
                raise ServiceException("gone")
            return Message(success=True, message="done")

        return call

    rospy.init_node = lambda name, **options: log.append((name, options))
    rospy.Publisher = lambda topic, kind, queue_size: Message(publish=lambda m: log.append((topic, m)))
    rospy.Subscriber = lambda topic, kind, take, queue_size: log.append((topic, take))
    rospy.ServiceProxy, rospy.ServiceException = proxy, ServiceException
    rospy.Time = Message(now=lambda: "now")
    rospy.rostime = Message(wallsleep=lambda s: None)
    rospy.signal_shutdown = lambda why: log.append(("shutdown", why))
    mrs = ModuleType("mrs_msgs.msg")
    mrs.VelocityReferenceStamped, mrs.ControlManagerDiagnostics = "reference", "diagnostics"
    nav, std = ModuleType("nav_msgs.msg"), ModuleType("std_srvs.srv")
    nav.Odometry, std.Trigger = "odometry", "trigger"
    modules = {"rospy": rospy, "mrs_msgs.msg": mrs, "nav_msgs.msg": nav, "std_srvs.srv": std}
    for name in ("mrs_msgs", "nav_msgs", "std_srvs"):
        modules[name] = ModuleType(name)
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    ros = start_ros(1)
    assert isinstance(ros, Ros1)
    assert ros.types() == ("reference", "diagnostics", "odometry", "trigger")
    ros.publisher("/t", "kind")("message")
    ros.subscribe("/s", "kind", "take")
    answers = []
    for count, name in enumerate(("/works", "/broken"), 1):
        ros.service(name, "trigger")(lambda accepted, said: answers.append((accepted, said)))
        ros.wait(lambda count=count: len(answers) == count, 1.0, "an answer")
    assert answers == [(True, "done"), (False, "gone")]
    with pytest.raises(VehicleError, match="ROS 1: nothing"):
        ros.wait(lambda: False, 0.0, "nothing")
    assert ros.now() == "now"
    ros.close()
    assert log == [
        ("wigwag", {"anonymous": True, "disable_signals": True}), ("/t", "message"), ("/s", "take"),
        ("shutdown", "wigwag lets go"),
    ]  # fmt: skip
