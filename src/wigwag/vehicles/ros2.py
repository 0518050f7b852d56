"""Any ROS 2 drone that follows ``geometry_msgs/TwistStamped`` and tells ``nav_msgs/Odometry``."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from wigwag.camera.address import Address
from wigwag.errors import InputError
from wigwag.extras import load
from wigwag.fly.values import Setpoint
from wigwag.vehicles.odometry import state_of
from wigwag.vehicles.protocol import Capabilities
from wigwag.vehicles.rclnode import RclNode
from wigwag.vehicles.streamed import Answer, StreamConfig, StreamedVehicle

_WHAT = "A ROS 2 vehicle"


@dataclass(frozen=True, slots=True)
class Ros2Config:
    """Names of the vehicle's topics and services. Relative names lie in the namespace.

    Raises:
        InputError: If a name cannot be one.
    """

    namespace: str = ""
    """Such as ``/drone1``."""
    cmd: str = "cmd_vel"
    """Topic of the set-points, ``TwistStamped``."""
    odom: str = "odom"
    """Topic of the state, ``Odometry``."""
    frame: str = "base_link"
    """Frame of the set-points: level with the ground, x forward, y left, z up."""
    arm: str = ""
    """Service (``std_srvs/Trigger``) that arms; empty: a pilot arms it."""
    take_off: str = "take_off"
    """Service that takes off to the vehicle's own height; empty: a pilot takes off."""
    land: str = "land"
    hold: str = "hold"
    """Service that stops and hovers; empty: it hovers by itself when set-points stop."""
    find_s: float = 10.0
    """How long the first odometry is waited for."""

    def __post_init__(self) -> None:
        """Check the names."""
        for name in (self.namespace, self.cmd, self.odom, self.arm, self.take_off, self.land, self.hold):
            if not all(c.isalnum() or c in "_/~" for c in name):
                raise InputError(
                    f"ros2: {name!r} is no name of a ROS topic or service, such as /drone1/odom."
                )
        if not self.cmd or not self.odom or not self.land:
            raise InputError("ros2: the names cmd, odom and land must not be empty.")

    def full(self, name: str) -> str:
        """Return a name with its namespace."""
        return name if name.startswith("/") or not name else f"{self.namespace.rstrip('/')}/{name}"


class Ros2Middleware:
    """The ROS 2 side of ``ros2:``.

    Args:
        config: The names.
        clock: Monotonic nanoseconds.
    """

    def __init__(self, config: Ros2Config, clock: Callable[[], int]) -> None:
        self.config, self._clock = config, clock
        self.services = frozenset(s for s in ("arm", "take_off", "land", "hold") if getattr(config, s))
        self.vehicle: StreamedVehicle | None = None
        self._node: RclNode | None = None
        self._clients: dict[str, Any] = {}
        self._heard = False

    def open(self) -> None:
        """Bring up the node and wait for odometry."""
        c = self.config
        self._node = node = RclNode()
        geometry, nav = load("geometry_msgs.msg", "ros2", _WHAT), load("nav_msgs.msg", "ros2", _WHAT)
        self._trigger = load("std_srvs.srv", "ros2", _WHAT).Trigger
        qos = load("rclpy.qos", "ros2", _WHAT)
        self._twist = geometry.TwistStamped
        self._publisher = node.node.create_publisher(self._twist, c.full(c.cmd), 1)  # only the newest counts
        self._clients = {
            service: node.node.create_client(self._trigger, c.full(getattr(c, service)))
            for service in self.services
        }
        newest = qos.QoSProfile(depth=1, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
        node.node.create_subscription(nav.Odometry, c.full(c.odom), self._odometry, newest)
        try:
            node.wait(lambda: self._heard, c.find_s, f"no odometry came on {c.full(c.odom)}")
        except Exception:
            self.close()
            raise

    def close(self) -> None:
        """Take the node down."""
        if self._node is not None:
            self._node.close()
        self._node = None

    def publish(self, setpoint: Setpoint) -> None:
        """Send a set-point."""
        if self._node is None:
            return
        message = self._twist()
        message.header.stamp = self._node.now()
        message.header.frame_id = self.config.frame
        linear = message.twist.linear
        linear.x, linear.y, linear.z = (float(v) for v in setpoint.velocity_m_s)
        message.twist.angular.z = float(setpoint.yaw_rate_rad_s)
        self._publisher.publish(message)

    def call(self, service: str, answer: Answer) -> None:
        """Call a service."""
        if self._node is None:
            answer(False, "not connected")
            return
        self._node.trigger(self._clients[service], self._trigger.Request(), answer)

    def _odometry(self, message: Any) -> None:
        state = state_of(message, self._clock())
        if state is not None and self.vehicle is not None:
            self.vehicle.observed(state)
            self._heard = True


def ros2_vehicle(
    config: Ros2Config | None = None, clock: Callable[[], int] = time.monotonic_ns,
    stream: StreamConfig | None = None,
) -> StreamedVehicle:  # fmt: skip
    """Return a ROS 2 vehicle, not yet connected.

    Args:
        config: Names of topics and services.
        clock: Monotonic nanoseconds, the clock of all stamps.
        stream: How set-points flow.
    """
    config = config or Ros2Config()
    middleware = Ros2Middleware(config, clock)
    capabilities = Capabilities(
        f"ROS 2 drone {config.namespace or '/'}",
        (stream or StreamConfig()).fresh_s,
        arms="arm" in middleware.services,
        takes_off="take_off" in middleware.services,
    )
    vehicle = StreamedVehicle(middleware, capabilities, clock, stream)
    middleware.vehicle = vehicle
    return vehicle


def open_ros2(address: Address) -> StreamedVehicle:
    """Return the vehicle at an address such as ``ros2:/drone1?cmd=cmd_vel&odom=odom``, not yet connected."""
    default = Ros2Config()
    return ros2_vehicle(
        Ros2Config(
            namespace=address.target,
            cmd=address.text("cmd", default.cmd),
            odom=address.text("odom", default.odom),
            frame=address.text("frame", default.frame),
            arm=_service(address, "arm", default.arm),
            take_off=_service(address, "take_off", default.take_off),
            land=address.text("land", default.land),
            hold=_service(address, "hold", default.hold),
        )
    )


def _service(address: Address, name: str, default: str) -> str:
    """Return a service's name; ``-`` says that there is none."""
    text = address.text(name, default)
    return "" if text == "-" else text
