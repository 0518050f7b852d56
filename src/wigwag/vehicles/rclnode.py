"""One ROS 2 node in a thread of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from wigwag.errors import VehicleError
from wigwag.extras import load


class RclNode:
    """A node that is spun beside the program, in a context of its own.

    Args:
        name: Of the node.

    Raises:
        MissingExtraError: If rclpy is not installed.
    """

    def __init__(self, name: str = "wigwag") -> None:
        rclpy = load("rclpy", "ros2", "A ROS 2 vehicle")
        executors = load("rclpy.executors", "ros2", "A ROS 2 vehicle")
        self._context = load("rclpy.context", "ros2", "A ROS 2 vehicle").Context()
        rclpy.init(context=self._context)
        self.node: Any = rclpy.create_node(name, context=self._context)
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="wigwag-ros-spin", daemon=True)
        self._thread.start()

    def now(self) -> Any:
        """Return the time as a message."""
        return self.node.get_clock().now().to_msg()

    def trigger(self, client: Any, request: Any, answer: Callable[[bool, str], None]) -> None:
        """Call a service that answers with ``success`` and ``message``, without waiting."""
        if not client.service_is_ready():
            answer(False, f"no service {client.srv_name}")
            return

        def done(future: Any) -> None:
            response = future.result()
            answer(bool(response is not None and response.success), getattr(response, "message", ""))

        client.call_async(request).add_done_callback(done)

    def wait(self, true: Callable[[], bool], seconds: float, what: str) -> None:
        """Wait until something is there.

        Raises:
            VehicleError: If it does not come.
        """
        end = time.monotonic() + seconds
        while not true():
            if time.monotonic() > end:
                raise VehicleError(f"ROS 2: {what} within {seconds:g} s. Is it running, in this ROS domain?")
            self._closing.wait(0.02)

    def close(self) -> None:
        """Stop spinning and leave."""
        if self._closing.is_set():
            return
        self._closing.set()
        self._executor.wake()
        self._thread.join(2.0)
        self._executor.shutdown(timeout_sec=1.0)
        self.node.destroy_node()
        self._context.try_shutdown()

    def _spin(self) -> None:
        while not self._closing.is_set() and self._context.ok():
            self._executor.spin_once(timeout_sec=0.1)
