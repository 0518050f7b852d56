"""The MRS UAV system: velocity references, and the services of its managers, in ROS 1 or ROS 2.

Its message types (``mrs_msgs``) are those of the user's own ROS installation.
"""

from __future__ import annotations

import importlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from wigwag.camera.address import Address
from wigwag.errors import InputError, MissingExtraError, VehicleError
from wigwag.fly.values import Setpoint
from wigwag.vehicles.odometry import state_of
from wigwag.vehicles.protocol import Capabilities, FlightMode
from wigwag.vehicles.rclnode import RclNode
from wigwag.vehicles.streamed import Answer, StreamConfig, StreamedVehicle

_FIND_S = 10.0
_HOVERS_AFTER_S = 0.5
"""The MPC tracker hovers when references stop for so long."""


class Ros(Protocol):
    """What is needed of ROS 1 or ROS 2."""

    def types(self) -> tuple[Any, Any, Any, Any]:
        """Return VelocityReferenceStamped, ControlManagerDiagnostics, Odometry and Trigger."""
        ...

    def publisher(self, topic: str, kind: Any) -> Callable[[Any], None]:
        """Return what publishes a message on a topic."""
        ...

    def subscribe(self, topic: str, kind: Any, take: Callable[[Any], None]) -> None:
        """Have a topic's messages taken."""
        ...

    def service(self, name: str, kind: Any) -> Callable[[Answer], None]:
        """Return what calls a ``Trigger`` service without waiting."""
        ...

    def now(self) -> Any:
        """Return the time as a message's stamp."""
        ...

    def wait(self, true: Callable[[], bool], seconds: float, what: str) -> None:
        """Wait for something; raises ``VehicleError``."""
        ...

    def close(self) -> None:
        """Go down."""
        ...


@dataclass(frozen=True, slots=True)
class MrsConfig:
    """Which UAV, and which ROS.

    Raises:
        InputError: If the name cannot be one.
    """

    uav: str = "uav1"
    ros: int = 0
    """1, 2, or 0: whichever can be imported, ROS 2 first."""

    def __post_init__(self) -> None:
        """Check the name."""
        if not self.uav or not all(c.isalnum() or c == "_" for c in self.uav):
            raise InputError(f"mrs: {self.uav!r} is no name of a UAV. Expected mrs:/uav1 or the like.")
        if self.ros not in (0, 1, 2):
            raise InputError(f"mrs: ?ros= must be 1 or 2, but got {self.ros}.")


class MrsMiddleware:
    """The MRS side of ``mrs:``.

    Args:
        config: Which UAV.
        clock: Monotonic nanoseconds.
        ros: Brings up ROS; chosen by the configuration by default.
    """

    services = frozenset({"take_off", "land", "hold"})

    def __init__(
        self, config: MrsConfig, clock: Callable[[], int], ros: Callable[[], Ros] | None = None
    ) -> None:
        self.config, self._clock = config, clock
        self._start = ros or (lambda: start_ros(config.ros))
        self._ros: Ros | None = None
        self.vehicle: StreamedVehicle | None = None
        self._odometry_heard = self._diagnostics_heard = False

    def open(self) -> None:
        """Bring up ROS; wait for odometry and for the control manager's diagnostics."""
        self._ros = ros = self._start()
        self._reference, diagnostics, odometry, trigger = ros.types()
        base = f"/{self.config.uav}"
        self._publish = ros.publisher(f"{base}/control_manager/velocity_reference", self._reference)
        self._calls = {
            "take_off": ros.service(f"{base}/uav_manager/takeoff", trigger),
            "land": ros.service(f"{base}/uav_manager/land", trigger),
            "hold": ros.service(f"{base}/control_manager/hover", trigger),
        }
        ros.subscribe(f"{base}/estimation_manager/odom_main", odometry, self._take_odometry)
        ros.subscribe(f"{base}/control_manager/diagnostics", diagnostics, self._take_diagnostics)
        try:
            ros.wait(
                lambda: self._odometry_heard and self._diagnostics_heard, _FIND_S,
                f"nothing was heard of {base}'s estimation and control managers",
            )  # fmt: skip
        except VehicleError:
            self.close()
            raise

    def close(self) -> None:
        """Go down."""
        if self._ros is not None:
            self._ros.close()
        self._ros = None

    def publish(self, setpoint: Setpoint) -> None:
        """Send a velocity reference, in the UAV's level frame: MRS turns it itself."""
        if self._ros is None:
            return
        message = self._reference()
        message.header.stamp = self._ros.now()
        message.header.frame_id = f"{self.config.uav}/fcu_untilted"
        velocity = message.reference.velocity
        velocity.x, velocity.y, velocity.z = (float(v) for v in setpoint.velocity_m_s)
        message.reference.heading_rate = float(setpoint.yaw_rate_rad_s)
        message.reference.use_heading_rate = True
        message.reference.use_heading = False
        message.reference.use_altitude = False
        self._publish(message)

    def call(self, service: str, answer: Answer) -> None:
        """Call a service."""
        if self._ros is None:
            answer(False, "not connected")
            return
        self._calls[service](answer)

    def _take_odometry(self, message: Any) -> None:
        state = state_of(message, self._clock())
        if state is not None and self.vehicle is not None:
            self.vehicle.observed(state)
            self._odometry_heard = True

    def _take_diagnostics(self, message: Any) -> None:
        if self.vehicle is not None:
            mode = mode_of(message, self.vehicle.asked)
            trouble = "MRS is in emergency or failsafe" if mode is FlightMode.FAILSAFE else ""
            self.vehicle.report(mode, trouble)
            self._diagnostics_heard = True


def mode_of(diagnostics: Any, asked: FlightMode) -> FlightMode:
    """Tell from the control manager's diagnostics what the UAV is doing.

    Args:
        diagnostics: ``mrs_msgs/ControlManagerDiagnostics``.
        asked: What was asked for last; it tells a take-off from a landing, both flown by one tracker.
    """
    if not diagnostics.motors:
        return FlightMode.DISARMED
    if getattr(diagnostics, "rc_mode", False):
        return FlightMode.MANUAL
    tracker = str(diagnostics.active_tracker)
    if tracker == "NullTracker":
        return FlightMode.READY
    if tracker == "LandoffTracker":
        return FlightMode.LANDING if asked is FlightMode.LANDING else FlightMode.TAKING_OFF
    return FlightMode.HOLDING if diagnostics.flying_normally else FlightMode.FAILSAFE


def mrs_vehicle(
    config: MrsConfig | None = None, clock: Callable[[], int] = time.monotonic_ns,
    ros: Callable[[], Ros] | None = None, stream: StreamConfig | None = None,
) -> StreamedVehicle:  # fmt: skip
    """Return a UAV of the MRS system, not yet connected. A pilot arms it and switches it to Offboard.

    Args:
        config: Which UAV.
        clock: Monotonic nanoseconds, the clock of all stamps.
        ros: Brings up ROS; chosen by the configuration by default.
        stream: How set-points flow.
    """
    config = config or MrsConfig()
    middleware = MrsMiddleware(config, clock, ros)
    fresh_s = (stream or StreamConfig()).fresh_s
    capabilities = Capabilities(f"MRS {config.uav}", fresh_s, _HOVERS_AFTER_S, arms=False, pilot=True)
    vehicle = StreamedVehicle(middleware, capabilities, clock, stream)
    middleware.vehicle = vehicle
    return vehicle


def open_mrs(address: Address) -> StreamedVehicle:
    """Return the UAV at an address such as ``mrs:/uav1?ros=1``, not yet connected."""
    return mrs_vehicle(MrsConfig(address.target.strip("/"), address.whole("ros", 0)))


def start_ros(version: int) -> Ros:
    """Bring up ROS 1 or ROS 2.

    Raises:
        MissingExtraError: If it, or ``mrs_msgs`` in it, cannot be imported.
    """
    tried = []
    for kind in {0: (Ros2, Ros1), 1: (Ros1,), 2: (Ros2,)}[version]:
        try:
            return kind()
        except ImportError as error:
            tried.append(str(error))
    raise MissingExtraError(
        f"mrs: neither works: {'; '.join(tried)}. Source the workspace that holds mrs_msgs, and start wigwag "
        "with the Python of that ROS installation."
    )


class _Types:
    """The message types, which bear the same names in both."""

    def __init__(self) -> None:
        self._messages = importlib.import_module("mrs_msgs.msg")
        self._odometry = importlib.import_module("nav_msgs.msg").Odometry
        self._trigger = importlib.import_module("std_srvs.srv").Trigger

    def types(self) -> tuple[Any, Any, Any, Any]:
        """Return VelocityReferenceStamped, ControlManagerDiagnostics, Odometry and Trigger."""
        m = self._messages
        return m.VelocityReferenceStamped, m.ControlManagerDiagnostics, self._odometry, self._trigger


class Ros2(_Types):
    """ROS 2, through rclpy."""

    def __init__(self) -> None:
        super().__init__()
        self._qos = importlib.import_module("rclpy.qos")
        self._node = RclNode()

    def publisher(self, topic: str, kind: Any) -> Callable[[Any], None]:
        """Return what publishes."""
        publish: Callable[[Any], None] = self._node.node.create_publisher(kind, topic, 1).publish
        return publish

    def subscribe(self, topic: str, kind: Any, take: Callable[[Any], None]) -> None:
        """Have messages taken, the newest only."""
        qos = self._qos.QoSProfile(depth=1, reliability=self._qos.ReliabilityPolicy.BEST_EFFORT)
        self._node.node.create_subscription(kind, topic, take, qos)

    def service(self, name: str, kind: Any) -> Callable[[Answer], None]:
        """Return what calls the service."""
        client = self._node.node.create_client(kind, name)
        return lambda answer: self._node.trigger(client, kind.Request(), answer)

    def now(self) -> Any:
        """Return the time."""
        return self._node.now()

    def wait(self, true: Callable[[], bool], seconds: float, what: str) -> None:
        """Wait for something."""
        self._node.wait(true, seconds, what)

    def close(self) -> None:
        """Go down."""
        self._node.close()


class Ros1(_Types):
    """ROS 1, through rospy."""

    def __init__(self) -> None:
        super().__init__()
        self._rospy = importlib.import_module("rospy")
        self._rospy.init_node("wigwag", anonymous=True, disable_signals=True)

    def publisher(self, topic: str, kind: Any) -> Callable[[Any], None]:
        """Return what publishes."""
        publish: Callable[[Any], None] = self._rospy.Publisher(topic, kind, queue_size=1).publish
        return publish

    def subscribe(self, topic: str, kind: Any, take: Callable[[Any], None]) -> None:
        """Have messages taken, the newest only."""
        self._rospy.Subscriber(topic, kind, take, queue_size=1)

    def service(self, name: str, kind: Any) -> Callable[[Answer], None]:
        """Return what calls the service; rospy waits, so each call has a thread of its own."""
        proxy = self._rospy.ServiceProxy(name, kind)

        def call(answer: Answer) -> None:
            try:
                response = proxy()
            except self._rospy.ServiceException as error:
                answer(False, str(error))
            else:
                answer(bool(response.success), str(response.message))

        return lambda answer: threading.Thread(target=call, args=(answer,), daemon=True).start()

    def now(self) -> Any:
        """Return the time."""
        return self._rospy.Time.now()

    def wait(self, true: Callable[[], bool], seconds: float, what: str) -> None:
        """Wait for something.

        Raises:
            VehicleError: If it does not come.
        """
        end = time.monotonic() + seconds
        while not true():
            if time.monotonic() > end:
                raise VehicleError(
                    f"ROS 1: {what} within {seconds:g} s. Is it running, with this ROS master?"
                )
            self._rospy.rostime.wallsleep(0.02)

    def close(self) -> None:
        """Go down."""
        self._rospy.signal_shutdown("wigwag lets go")
