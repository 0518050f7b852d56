"""What all vehicles behind ROS have in common: services that are called, and set-points that flow."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from wigwag.errors import InputError
from wigwag.fly.values import HOVER, Setpoint, VehicleState
from wigwag.vehicles.calm import calm
from wigwag.vehicles.protocol import AIRBORNE, Capabilities, FlightMode

_S = 1_000_000_000
_NEVER_NS = -1_000_000 * _S
_UP_M, _DOWN_M, _CALM_M_S = 0.3, 0.15, 0.2
_SETTLED_S = 1.0

Answer = Callable[[bool, str], None]
"""Told whether a service did what it was asked for, and what it said."""


class Middleware(Protocol):
    """The ROS side of a vehicle."""

    services: frozenset[str]
    """Which of ``arm``, ``take_off``, ``land`` and ``hold`` it has."""

    def open(self) -> None:
        """Come up and wait for the vehicle; raises ``VehicleError`` if it is not there."""
        ...

    def close(self) -> None:
        """Go down; more than once does no harm."""
        ...

    def publish(self, setpoint: Setpoint) -> None:
        """Send a set-point now."""
        ...

    def call(self, service: str, answer: Answer) -> None:
        """Call a service without waiting for it."""
        ...


@dataclass(frozen=True, slots=True)
class StreamConfig:
    """How set-points flow; the same dead man's switch as over MAVLink."""

    rate_hz: float = 30.0
    fresh_s: float = 0.22
    """Nothing older is sent as it is."""
    still_s: float = 0.5
    """How long standing still is sent after that, before the vehicle is told to hold."""
    frozen_s: float = 0.3
    """A position repeated to the last bit for longer, while it flies, grows old."""

    def __post_init__(self) -> None:
        """Check what would otherwise be found out in the air."""
        if not 8 <= self.rate_hz <= 100:
            raise InputError(f"StreamConfig.rate_hz must be 8 to 100, but got {self.rate_hz}.")


class StreamedVehicle:
    """A ``Vehicle`` over a middleware.

    What it is doing is told from what was asked for and from its height, unless the middleware reports it
    (``report``). One thread sends, as for MAVLink: the stream ends with the loop that feeds it.

    Args:
        middleware: The ROS side.
        capabilities: What the vehicle can do.
        clock: Monotonic nanoseconds, the clock of all stamps.
        config: How set-points flow.
    """

    def __init__(
        self, middleware: Middleware, capabilities: Capabilities, clock: Callable[[], int],
        config: StreamConfig | None = None,
    ) -> None:  # fmt: skip
        self.config = config or StreamConfig()
        self._middleware, self._capabilities, self._clock = middleware, capabilities, clock
        self._lock = threading.RLock()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._state = VehicleState(np.zeros(3), np.zeros(3), 0.0, 0, armed=False)
        self._reported: FlightMode | None = None
        self._asked = FlightMode.DISARMED
        self._since_ns = 0
        self._met = False
        self._ground_m = 0.0
        self._moved_ns = 0
        self._denied = self._trouble = ""
        self._setpoint, self._stamp_ns = HOVER, _NEVER_NS
        self._steered = self._arming = self._then_take_off = False

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        with self._lock:
            mode = self._reported or self._asked
            return FlightMode.STEERED if mode is FlightMode.HOLDING and self._steered else mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        return self._capabilities

    @property
    def warnings(self) -> tuple[str, ...]:
        """None: its settings are not read."""
        return ()

    @property
    def state(self) -> VehicleState:
        """What it says of itself."""
        with self._lock:
            armed = self.mode is not FlightMode.DISARMED
            return replace(self._state, armed=armed, denied=self._denied, trouble=self._trouble)

    def connect(self) -> None:
        """Come up and wait for the vehicle's position.

        Raises:
            VehicleError: If none comes.
        """
        if self._thread is not None:
            return
        self._middleware.open()
        calm()
        self._thread = threading.Thread(target=self._send, name="wigwag-ros-send", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Let go: steered, it is told to hold."""
        if self._thread is None:
            return
        if self.mode is FlightMode.STEERED:
            self.hold()
        self._closing.set()
        self._thread.join(2.0)
        self._thread = None
        self._middleware.close()

    def beat(self, now_ns: int) -> None:
        """Nothing to keep alive: the set-points' own age is watched."""

    def arm(self) -> bool:
        """Call the arming service; without one a pilot arms it, and it counts as ready."""
        with self._lock:
            if self.mode not in (FlightMode.DISARMED, FlightMode.READY):
                return False
            if "arm" not in self._middleware.services:
                if self._reported is None:
                    self._become(FlightMode.READY)
                return self.mode is FlightMode.READY
            self._arming, self._then_take_off = True, False
            return self._call("arm", FlightMode.READY)

    def take_off(self, height_m: float = 1.5) -> bool:
        """Call the take-off service, now or once it is armed; the height is the vehicle's own.

        Raises:
            InputError: If the height is not positive.
        """
        if not height_m > 0:
            raise InputError(f"take_off needs a height above 0 m, but got {height_m}.")
        with self._lock:
            if "take_off" not in self._middleware.services:
                return False
            if self._arming:
                self._then_take_off = True
                return True
            return self.mode is FlightMode.READY and self._call("take_off", FlightMode.TAKING_OFF)

    def land(self) -> bool:
        """Call the landing service."""
        with self._lock:
            if self.mode in (FlightMode.DISARMED, FlightMode.READY, FlightMode.MANUAL):
                return False
            self._forget()
            return self._call("land", FlightMode.LANDING)

    def hold(self) -> bool:
        """Call the holding service; without one, stand still and let the stream end."""
        with self._lock:
            if self.mode in (FlightMode.DISARMED, FlightMode.READY, FlightMode.MANUAL):
                return False
            self._forget()
            self._middleware.publish(HOVER)
            if "hold" not in self._middleware.services:
                self._become(FlightMode.HOLDING)
                return True
            return self._call("hold", FlightMode.HOLDING)

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Take a set-point; it leaves within 1/30 s."""
        now_ns = self._clock()
        values = (*setpoint.velocity_m_s, setpoint.yaw_rate_rad_s)
        with self._lock:
            if self.mode not in AIRBORNE or not np.isfinite(values).all():
                return False
            if now_ns - stamp_ns > self.config.fresh_s * _S or stamp_ns < self._stamp_ns:
                return False
            self._setpoint, self._stamp_ns = setpoint, min(stamp_ns, now_ns)
            self._steered = True
            return True

    # What the middleware tells.

    def observed(self, state: VehicleState) -> None:
        """Take in where the vehicle is; the height counts from where it stood when last on the ground."""
        with self._lock:
            now_ns = self._clock()
            height = float(state.position_m[2])
            if not self._met:
                self._met, self._moved_ns = True, now_ns
                if height - self._ground_m > _UP_M:
                    self._become(FlightMode.HOLDING)  # met in the air
            if self.mode is FlightMode.DISARMED:
                self._ground_m = height
            position = state.position_m - np.array([0.0, 0.0, self._ground_m])
            if not np.array_equal(position, self._state.position_m) or self.mode is FlightMode.DISARMED:
                self._moved_ns = now_ns
            frozen = now_ns - self._moved_ns > self.config.frozen_s * _S
            fresh_ns = self._state.stamp_ns if frozen else state.stamp_ns
            self._state = replace(
                state, position_m=position, stamp_ns=fresh_ns, position_ns=fresh_ns,
                attitude_ns=state.stamp_ns, link_ns=now_ns,
            )  # fmt: skip
            self._see(now_ns)

    def report(self, mode: FlightMode | None, trouble: str = "") -> None:
        """Take in what the vehicle says it is doing; ``None`` leaves that to what was asked and seen."""
        with self._lock:
            if mode not in (None, FlightMode.HOLDING):
                self._steered = False
            self._reported, self._trouble = mode, trouble

    @property
    def asked(self) -> FlightMode:
        """What was asked for last."""
        return self._asked

    def _see(self, now_ns: int) -> None:
        """Tell by height and calm when a take-off or a landing is done."""
        height, climb = float(self._state.position_m[2]), float(self._state.velocity_m_s[2])
        up = self._asked is FlightMode.TAKING_OFF
        there = height > _UP_M if up else height < _DOWN_M
        if (
            self._asked not in (FlightMode.TAKING_OFF, FlightMode.LANDING)
            or not there
            or abs(climb) > _CALM_M_S
        ):
            self._since_ns = now_ns
        elif now_ns - self._since_ns > _SETTLED_S * _S:
            self._become(FlightMode.HOLDING if up else FlightMode.DISARMED)

    def _become(self, mode: FlightMode) -> None:
        self._asked, self._since_ns = mode, self._clock()

    def _forget(self) -> None:
        self._setpoint, self._stamp_ns, self._steered = HOVER, _NEVER_NS, False

    def _call(self, service: str, then: FlightMode) -> bool:
        self._denied = ""

        def answer(accepted: bool, said: str) -> None:
            with self._lock:
                if accepted:
                    self._become(then)
                else:
                    self._denied = f"{service} was refused" + (f": {said}" if said else "")
                if service == "arm":
                    self._arming, again = False, self._then_take_off and accepted
                    self._then_take_off = False
                    if again:
                        self._call("take_off", FlightMode.TAKING_OFF)

        if service not in self._middleware.services:
            return False
        self._middleware.call(service, answer)
        return True

    # What is sent.

    def tick(self, now_ns: int) -> None:
        """Send what is due: the newest set-point while it is fresh, then standing still, then nothing."""
        with self._lock:
            if not self._steered or self.mode is not FlightMode.STEERED:
                return
            age_s = (now_ns - self._stamp_ns) * 1e-9
            if age_s <= self.config.fresh_s:
                self._middleware.publish(self._setpoint)
            elif age_s <= self.config.fresh_s + self.config.still_s:
                self._middleware.publish(HOVER)
            else:
                self.hold()

    def _send(self) -> None:
        period_ns = round(_S / self.config.rate_hz)
        due_ns = self._clock()
        while not self._closing.is_set():
            self.tick(self._clock())
            due_ns += period_ns
            now_ns = self._clock()
            due_ns = max(due_ns, now_ns)  # late: no burst to make up for it
            self._closing.wait((due_ns - now_ns) * 1e-9)
