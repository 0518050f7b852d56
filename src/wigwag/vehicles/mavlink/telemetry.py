"""What an autopilot says, message by message, becomes what is known of it."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from wigwag.camera.clock import DeviceClock
from wigwag.fly.values import VehicleState
from wigwag.vehicles.mavlink.frames import attitude_of, ned_to_enu

_ARMED, _CRITICAL, _ON_GROUND = 128, 5, 1
"""MAV_MODE_FLAG_SAFETY_ARMED, MAV_STATE_CRITICAL, MAV_LANDED_STATE_ON_GROUND."""
_PREARM = 0x10000000
"""MAV_SYS_STATUS_PREARM_CHECK."""
_COMPLAINTS = ("prearm", "preflight", "arm:", "arming denied", "failsafe", "ekf", "battery", "fence")
_COMPLAINT_S = 15.0
_BACK_MS = 1000
"""Time since boot that runs back by more, again and again, says that the autopilot was restarted."""


@dataclass(slots=True)
class Heard:
    """One kind of message: its newest stamp on the autopilot's clock, and on ours."""

    boot_ms: int = -1
    stamp_ns: int = 0
    arrived_ns: int = 0
    """When it came, whatever was in it."""


class Telemetry:
    """State of one autopilot, from its messages alone.

    Late, repeated and disordered messages are told by the autopilot's own time since boot and left out;
    time that runs back for good is a restart. A position that is repeated to the last bit while the
    propellers turn is no measurement: its stamp stays where it was.

    Args:
        prearm_present: Whether the pre-arm bit of SYS_STATUS must be marked as present to be believed.
            PX4 sets it in ``health`` only.
    """

    def __init__(self, prearm_present: bool = True) -> None:
        self.prearm_present = prearm_present
        self.armed = False
        self.critical = False
        self.custom_mode = -1
        self.heard_ns = 0
        """When anything was last heard."""
        self.heartbeat_ns = 0
        self.echo_ns: int | None = None
        """When an answer to our own clock message last came: the link works both ways."""
        self.restarts = 0
        self.position, self.attitude = Heard(), Heard()
        self.amsl_m = self.relative_m = math.nan
        """Altitude above the sea and above home, where it is now."""
        self.origin = False
        """Whether its estimator has an origin."""
        self.gps_fix = 0
        self.fence_ns: int | None = None
        """Since when it has been outside its own fence; ``None``: it is not, or does not say."""
        self.version = ""
        self.landed: bool | None = None
        self.healthy = True
        self.battery: float | None = None
        self.battery_v: float | None = None
        self._clock = DeviceClock()
        self._boot_ms = -1
        self._strange: deque[int] = deque(maxlen=3)
        self._ned = (0.0, 0.0, 0.0)
        self._velocity = (0.0, 0.0, 0.0)
        self._angles = (0.0, 0.0, 0.0)
        self.yaw_rate_rad_s = 0.0
        self._ground_m = 0.0
        self._texts: deque[tuple[int, str]] = deque(maxlen=4)

    def update(self, message: Any, now_ns: int) -> None:
        """Take in a message of this autopilot, heard at ``now_ns`` (monotonic nanoseconds)."""
        self.heard_ns = now_ns
        take = getattr(self, f"_on_{message.get_type().lower()}", None)
        if take is not None:
            take(message, now_ns)

    @property
    def height_m(self) -> float:
        """Height above where it was armed."""
        return -self._ned[2] - self._ground_m

    @property
    def climb_m_s(self) -> float:
        """Rate of climb."""
        return -self._velocity[2]

    @property
    def stands(self) -> bool | None:
        """Whether it stands; ``None``: it has said neither that nor where it is."""
        return self.on_ground if self.landed is not None or self.position.arrived_ns else None

    @property
    def on_ground(self) -> bool:
        """Whether it stands; by its height as long as it does not say."""
        return self.height_m < 0.3 if self.landed is None else self.landed

    def echoed(self, asked_ns: int, boot_ns: int, now_ns: int) -> None:
        """Take in the answer to a clock message of our own.

        Args:
            asked_ns: When we asked.
            boot_ns: What its clock said; both autopilots count from their start, as in their states.
            now_ns: When the answer came.
        """
        self.echo_ns = now_ns
        self._clock.answered(asked_ns, boot_ns)

    def heading_rad(self, now_ns: int) -> float:
        """Return the heading now: the last one, turned on at its own rate for at most a fifth of a second."""
        age_s = min(max((now_ns - self.attitude.stamp_ns) * 1e-9, 0.0), 0.2)
        return attitude_of(*self._angles)[2] - self.yaw_rate_rad_s * age_s

    def complaint(self, now_ns: int) -> str:
        """Return what its checks complained about in the last seconds."""
        return "; ".join(text for at, text in self._texts if (now_ns - at) * 1e-9 < _COMPLAINT_S)

    def link_ns(self) -> int:
        """Return when the link was last known to work, both ways where it tells."""
        return self.heard_ns if self.echo_ns is None else min(self.heard_ns, self.echo_ns)

    def state(self, now_ns: int, denied: str, trouble: str) -> VehicleState:
        """Return everything as one value; what is older than the parts' ages says so by its stamps."""
        roll, pitch, _ = attitude_of(*self._angles)
        position = ned_to_enu(*self._ned)
        position[2] -= self._ground_m
        healthy = not self.critical if self.armed else self.healthy
        complaint = "" if healthy else self.complaint(now_ns)
        return VehicleState(
            position_m=position,
            velocity_m_s=ned_to_enu(*self._velocity),
            heading_rad=attitude_of(*self._angles)[2],
            stamp_ns=min(self.position.stamp_ns, self.attitude.stamp_ns),
            roll_rad=roll,
            pitch_rad=pitch,
            armed=self.armed,
            position_ns=self.position.stamp_ns,
            attitude_ns=self.attitude.stamp_ns,
            link_ns=self.link_ns(),
            battery=self.battery,
            battery_v=self.battery_v,
            healthy=healthy,
            trouble="; ".join(filter(None, (trouble, complaint))),
            denied=denied,
        )

    def _on_heartbeat(self, message: Any, now_ns: int) -> None:
        self.heartbeat_ns = now_ns
        self.armed = bool(message.base_mode & _ARMED)
        self.critical = message.system_status >= _CRITICAL
        self.custom_mode = int(message.custom_mode)

    def _on_local_position_ned(self, message: Any, now_ns: int) -> None:
        values = (message.x, message.y, message.z, message.vx, message.vy, message.vz)
        if not np.isfinite(values).all() or not self._newer(self.position, message.time_boot_ms):
            return
        ned = values[:3]
        repeated = ned == self._ned and self.armed
        self._ned, self._velocity, self.origin = ned, values[3:], True
        if not self.armed:
            self._ground_m = -message.z
        self.position.arrived_ns = now_ns
        if not repeated:
            self.position.stamp_ns = self._clock.to_host(message.time_boot_ms * 1_000_000, now_ns)

    def _on_attitude(self, message: Any, now_ns: int) -> None:
        values = (message.roll, message.pitch, message.yaw, message.yawspeed)
        if not np.isfinite(values).all() or not self._newer(self.attitude, message.time_boot_ms):
            return
        self._angles, self.yaw_rate_rad_s = values[:3], message.yawspeed
        self.attitude.arrived_ns = now_ns
        self.attitude.stamp_ns = self._clock.to_host(message.time_boot_ms * 1_000_000, now_ns)

    def _on_global_position_int(self, message: Any, now_ns: int) -> None:
        self.amsl_m, self.relative_m = message.alt * 1e-3, message.relative_alt * 1e-3

    def _on_gps_global_origin(self, message: Any, now_ns: int) -> None:
        self.origin = True

    def _on_gps_raw_int(self, message: Any, now_ns: int) -> None:
        self.gps_fix = int(message.fix_type)

    def _on_fence_status(self, message: Any, now_ns: int) -> None:
        if not message.breach_status:
            self.fence_ns = None
        elif self.fence_ns is None:
            self.fence_ns = now_ns

    def _on_extended_sys_state(self, message: Any, now_ns: int) -> None:
        if message.landed_state:
            self.landed = message.landed_state == _ON_GROUND

    def _on_sys_status(self, message: Any, now_ns: int) -> None:
        self.battery = message.battery_remaining / 100 if message.battery_remaining >= 0 else None
        self.battery_v = message.voltage_battery * 1e-3 if message.voltage_battery not in (0, 65535) else None
        if self.prearm_present and not message.onboard_control_sensors_present & _PREARM:
            return
        self.healthy = bool(message.onboard_control_sensors_health & _PREARM)

    def _on_statustext(self, message: Any, now_ns: int) -> None:
        text = message.text if isinstance(message.text, str) else message.text.decode("utf-8", "replace")
        text = text.strip("\0\t\r\n ")
        if any(word in text.lower() for word in _COMPLAINTS) and text not in {t for _, t in self._texts}:
            self._texts.append((now_ns, text))

    def _on_autopilot_version(self, message: Any, now_ns: int) -> None:
        number = int(message.flight_sw_version)
        self.version = f"{number >> 24 & 255}.{number >> 16 & 255}.{number >> 8 & 255}"

    def _newer(self, heard: Heard, boot_ms: int) -> bool:
        """Say whether a message is later than the last of its kind; notice a restart."""
        if boot_ms < self._boot_ms - _BACK_MS:
            # One packet from long ago is a late one; three on end, in order, are another life.
            self._strange.append(boot_ms)
            on_end = list(self._strange)
            if len(on_end) < 3 or sorted(on_end) != on_end or on_end[-1] - on_end[0] > _BACK_MS:
                return False
            self._restarted(boot_ms)
        else:
            self._strange.clear()
        if boot_ms <= heard.boot_ms:
            return False
        heard.boot_ms = boot_ms
        self._boot_ms = max(self._boot_ms, boot_ms)
        return True

    def _restarted(self, boot_ms: int) -> None:
        self.restarts += 1
        self._clock, self._boot_ms = DeviceClock(), boot_ms
        self._strange.clear()
        self.position.boot_ms = self.attitude.boot_ms = -1
        self.origin, self.landed, self.echo_ns = False, None, None
