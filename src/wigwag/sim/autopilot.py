"""A fake autopilot that speaks real MAVLink: what PX4 and ArduPilot have in common, and faults to inject.

It stands in for them in tests and in the fault benchmark. It is written from their documentation and
behaviour and shares no code with what talks to it but the turning of frames.
"""

from __future__ import annotations

import math
import struct
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from wigwag.fly.values import HOVER, Setpoint
from wigwag.sim.autopilot_config import FakeConfig, Faults
from wigwag.sim.pointmass import PointMass
from wigwag.vehicles.mavlink.dialect import dialect
from wigwag.vehicles.mavlink.frames import attitude_of, heading_of, ned_to_body
from wigwag.vehicles.mavlink.signing import sign

ACCEPTED, BUSY, DENIED, UNSUPPORTED, FAILED = 0, 1, 2, 3, 4
"""MAV_RESULT."""
_STEP_S = 0.01
_SENT = {
    0: "heartbeat", 1: "sys_status", 24: "gps_raw_int", 30: "attitude", 32: "local_position_ned",
    33: "global_position_int", 162: "fence_status", 245: "extended_sys_state",
}  # fmt: skip


class FakeAutopilot(ABC):
    """What both autopilots have in common. ``FakePx4`` and ``FakeArduPilot`` are the two.

    Args:
        config: What it is like.
        airframe: What flies.
        wall_clock_s: Seconds since 1970, for signatures only.
    """

    kind = 0
    parameters: dict[str, tuple[float, int]] = {}  # noqa: RUF012  the subclasses' tables
    """Value and MAV_PARAM_TYPE of every parameter it knows."""
    bytewise = False
    sends_unasked: dict[int, float] = {0: 1.0}  # noqa: RUF012
    """Messages it sends by itself, times a second."""

    def __init__(
        self, config: FakeConfig | None = None, airframe: PointMass | None = None, wall_clock_s: float = 0.0
    ) -> None:
        self.config = config or FakeConfig()
        self.airframe = airframe or PointMass()
        self.faults = Faults()
        self.parameters = dict(self.parameters)
        self.now_s = 0.0
        self.battery = self.config.battery
        self.received: list[tuple[float, Any]] = []
        """Every set-point that arrived: when, and the message. For judging."""
        self.heartbeats: list[tuple[float, int, int]] = []
        """Every heartbeat that arrived: when, from which system, of which type. For judging."""
        self._wall_clock_s = wall_clock_s
        self.mavlink = dialect()
        self._out: list[bytes] = []
        self._boot()

    def _boot(self) -> None:
        self.booted_s = self.now_s
        self.armed, self.critical, self.mode = False, False, self.first_mode
        self.origin = False
        self._intervals = {message: 1 / rate for message, rate in self.sends_unasked.items()}
        self._sent_s: dict[int, float] = {}
        self._setpoint, self._setpoint_s = HOVER, -math.inf
        self._target_m: float | None = None
        """Height that a take-off climbs to."""
        self._armed_s = self._landed_s = self._lifts_s = -math.inf
        self._home_m = self.config.amsl_m
        self._coder = self.mavlink.MAVLink(self, srcSystem=self.config.system, srcComponent=1)
        self._coder.robust_parsing = True
        if self.config.key is not None:
            sign(self._coder, self.config.key, self._wall_clock_s + self.now_s)
        self._believed = self.airframe.measured

    first_mode = 0

    def write(self, data: bytes) -> None:
        """Take a packet from pymavlink's coder."""
        self._out.append(bytes(data))

    # What a test does to it.

    def reboot(self) -> None:
        """Start anew, in the air or not; the motors stop if they may turn."""
        self._boot()
        self.airframe.set_motors(False)

    def pilot(self, mode: int) -> None:
        """Let a pilot choose a mode by radio."""
        self.mode, self.critical, self._target_m = mode, False, None

    # The flight.

    def receive(self, data: bytes) -> None:
        """Take in bytes."""
        messages = self._coder.parse_buffer(data) or ()
        if self.faults.deaf:
            return
        for message in messages:
            take = getattr(self, f"_on_{message.get_type().lower()}", None)
            if take is not None and getattr(message, "target_system", 0) in (0, self.config.system):
                take(message)

    def step(self, now_s: float) -> list[bytes]:
        """Fly on to ``now_s`` and return the packets that were sent on the way."""
        while self.now_s < now_s - 1e-9:
            dt_s = min(_STEP_S, now_s - self.now_s)
            self.now_s += dt_s
            self.battery = max(0.0, self.battery - self.config.drain_1_s * dt_s)
            self._rules()
            self.airframe.step(self._wanted(), dt_s)
            self._after()
            if not self.faults.frozen:
                self._believed = self.airframe.measured
            self._stream()
        packets, self._out = self._out, []
        return [] if self.faults.silent else packets

    @property
    def boot_ms(self) -> int:
        """Milliseconds since its start, by its own clock."""
        return round((self.now_s - self.booted_s) * self.config.clock_rate * 1e3)

    @property
    def settled(self) -> bool:
        """Whether its estimator is ready."""
        return self.now_s - self.booted_s >= self.config.settle_s and self.origin

    @property
    def height_m(self) -> float:
        """Height above the ground."""
        return float(self.airframe.state.position_m[2])

    def _rules(self) -> None:
        """What the autopilot does by itself at every step."""
        if self.config.gps and self.now_s - self.booted_s >= self.config.settle_s:
            self.origin = True

    def _outside(self) -> bool:
        x, y, z = self.airframe.state.position_m
        return math.hypot(x, y) > self.config.radius_m or z > self.config.ceiling_m

    @abstractmethod
    def _wanted(self) -> Setpoint:
        """What the mode of the moment flies."""

    def _after(self) -> None:
        """Disarm on the ground: after landing, or if no take-off came."""
        if not self.armed:
            return
        if not self.airframe.on_ground:
            self._landed_s = math.inf
        elif self._landed_s == math.inf:
            self._landed_s = self.now_s
        down_s = self.now_s - self._landed_s
        if down_s > 10.0 or (self._landing and down_s > 1.0):
            self.disarm()

    @property
    @abstractmethod
    def _landing(self) -> bool:
        """Whether its mode is to land."""

    def disarm(self) -> None:
        """Lock the propellers."""
        self.armed, self.critical, self._target_m = False, False, None
        self.airframe.set_motors(False)

    def _arm(self) -> None:
        self.armed, self._armed_s, self._landed_s = True, self.now_s, self.now_s
        self._home_m = self.config.amsl_m + self.height_m
        self.airframe.set_motors(True)

    def _descend(self) -> Setpoint:
        return Setpoint((0.0, 0.0, -self.config.descend_m_s if self.height_m > 0.7 else -0.4))

    def _climb(self) -> Setpoint:
        assert self._target_m is not None
        if self.now_s < self._lifts_s:
            return HOVER
        return Setpoint((0.0, 0.0, min(self.config.climb_m_s, 1.5 * (self._target_m - self.height_m))))

    # Messages that come.

    def _on_heartbeat(self, message: Any) -> None:
        self.heartbeats.append((self.now_s, message.get_srcSystem(), message.type))

    def _on_timesync(self, message: Any) -> None:
        if message.tc1 == 0:
            # Both count from their start, and read the clock when they are asked.
            self._post(self._coder.timesync_encode(self.boot_ms * 1_000_000 + 1, message.ts1))

    def _on_param_request_read(self, message: Any) -> None:
        name = message.param_id
        if name not in self.parameters:
            return
        value, kind = self.parameters[name]
        if self.bytewise and kind == 6:
            value = struct.unpack("<f", struct.pack("<i", int(value)))[0]
        count = len(self.parameters)
        self._post(self._coder.param_value_encode(name.encode(), value, kind, count, 0))

    def _on_set_gps_global_origin(self, message: Any) -> None:
        self.origin = True

    def _on_command_long(self, message: Any) -> None:
        command = int(message.command)
        result = DENIED if command in self.faults.deny else self._command(command, message)
        if command not in self.faults.mute:
            source = (message.get_srcSystem(), message.get_srcComponent())
            self._post(self._coder.command_ack_encode(command, result, 0, 0, *source))

    def _command(self, command: int, message: Any) -> int:
        match command:
            case 511:
                name = int(message.param1)
                if name not in _SENT or (name == 162 and self.kind == 12):
                    return UNSUPPORTED
                self._intervals[name] = message.param2 * 1e-6 if message.param2 > 0 else math.inf
                return ACCEPTED
            case 512:
                if int(message.param1) != 148:
                    return UNSUPPORTED
                version = 1 << 24 | 16 << 16
                self._post(self._coder.autopilot_version_encode(
                    0, version, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0))  # fmt: skip
                return ACCEPTED
            case 401:
                why = self._unready()
                if why:
                    self.say(why)
                return ACCEPTED
            case 176:
                return self._set_mode(message)
            case 400:
                return self._arm_request(message)
            case 22:
                self._lifts_s = self.now_s + self.config.spool_up_s
                return self._take_off(message)
            case _:
                return UNSUPPORTED

    def _on_set_position_target_local_ned(self, message: Any) -> None:
        self.received.append((self.now_s, message))
        frames = (1, 7, 8, 9) if self.kind == 3 else (1, 8)
        if message.coordinate_frame not in frames or message.type_mask & 0x5FF != 0x5C7 & 0x5FF:
            return
        self._setpoint_s = self.now_s
        velocity = (message.vx, message.vy, message.vz)
        if message.coordinate_frame in (8, 9):
            body = (velocity[0], -velocity[1], -velocity[2])
        else:
            body = ned_to_body(velocity, self.airframe.state.heading_rad)
        self._setpoint = Setpoint(body, -message.yaw_rate)

    @abstractmethod
    def _set_mode(self, message: Any) -> int:
        """Answer DO_SET_MODE."""

    @abstractmethod
    def _arm_request(self, message: Any) -> int:
        """Answer COMPONENT_ARM_DISARM."""

    @abstractmethod
    def _take_off(self, message: Any) -> int:
        """Answer NAV_TAKEOFF."""

    def _unready(self) -> str:
        return "" if self.settled else "EKF attitude is bad"

    # Messages that go.

    def say(self, text: str) -> None:
        """Send a text."""
        self._post(self._coder.statustext_encode(4, text.encode()))

    def _post(self, message: Any) -> None:
        self._coder.srcSystem = self.faults.system or self.config.system
        self._coder.send(message)

    def _stream(self) -> None:
        for message, interval_s in self._intervals.items():
            if self.now_s - self._sent_s.get(message, -math.inf) >= interval_s - _STEP_S / 2:
                self._sent_s[message] = self.now_s
                getattr(self, f"_send_{_SENT[message]}")()

    def _send_heartbeat(self) -> None:
        base = 1 | (128 if self.armed else 0)
        status = 5 if self.critical or (self.armed and self.faults.warning) else 4 if self.armed else 3
        self._post(self._coder.heartbeat_encode(2, self.kind, base, self.mode, status))

    def _send_sys_status(self) -> None:
        present, health = self._prearm_bits()
        self._post(self._coder.sys_status_encode(
            present, present, health, 200, 11_800, 900, round(self.battery * 100), 0, 0, 0, 0, 0, 0
        ))  # fmt: skip

    @abstractmethod
    def _prearm_bits(self) -> tuple[int, int]:
        """Sensors 'present' and 'health' of SYS_STATUS."""

    def _send_gps_raw_int(self) -> None:
        fix = 0 if not self.config.gps else 3 if self.origin else 1
        self._post(self._coder.gps_raw_int_encode(self.boot_ms * 1000, fix, 0, 0, 0, 100, 100, 0, 0, 12))

    def _send_attitude(self) -> None:
        s = self._believed if self.faults.frozen else self.airframe.measured
        roll, pitch, yaw = attitude_of(s.roll_rad, s.pitch_rad, s.heading_rad)
        rate = -self.airframe.yaw_rate_rad_s
        self._post(self._coder.attitude_encode(self.boot_ms, roll, pitch, yaw, 0, 0, rate))

    def _send_local_position_ned(self) -> None:
        if not self.origin:
            return
        (e, n, u), (ve, vn, vu) = self._believed.position_m, self._believed.velocity_m_s
        self._post(self._coder.local_position_ned_encode(self.boot_ms, n, e, -u, vn, ve, -vu))

    def _send_global_position_int(self) -> None:
        if not self.origin:
            return
        amsl = self.config.amsl_m + float(self._believed.position_m[2])
        yaw = heading_of(self._believed.heading_rad) % (2 * np.pi)
        self._post(self._coder.global_position_int_encode(
            self.boot_ms, 473_977_420, 85_455_940, round(amsl * 1e3), round((amsl - self._home_m) * 1e3),
            0, 0, 0, round(np.degrees(yaw) * 100) % 36_000,
        ))  # fmt: skip

    def _send_fence_status(self) -> None:
        outside = self._outside()
        self._post(self._coder.fence_status_encode(int(outside), int(outside), 3 if outside else 0, 0))

    def _send_extended_sys_state(self) -> None:
        landed = 1 if self.airframe.on_ground else 3 if self._target_m else 4 if self._landing else 2
        self._post(self._coder.extended_sys_state_encode(0, landed))
