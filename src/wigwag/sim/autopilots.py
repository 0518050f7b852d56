"""The habits in which the fake PX4 and the fake ArduPilot differ."""

from __future__ import annotations

import math
from typing import Any

from wigwag.fly.values import HOVER, Setpoint
from wigwag.sim.autopilot import ACCEPTED, BUSY, DENIED, FAILED, FakeAutopilot

_PREARM = 0x10000000
_AUTO = 4 << 16


class FakePx4(FakeAutopilot):
    """PX4's habits: altitude above the sea, a second of set-points before Offboard, Hold when they stop."""

    POSITION, OFFBOARD = 3 << 16, 6 << 16
    HOLD, TAKE_OFF = _AUTO | 3 << 24, _AUTO | 2 << 24
    RETURN, LAND = _AUTO | 5 << 24, _AUTO | 6 << 24

    kind = 12
    first_mode = POSITION
    bytewise = True
    parameters = {  # noqa: RUF012
        "COM_OBL_RC_ACT": (5, 6), "COM_OF_LOSS_T": (1.0, 9), "COM_RCL_EXCEPT": (0, 6), "NAV_DLL_ACT": (0, 6),
        "NAV_RCL_ACT": (2, 6), "RTL_RETURN_ALT": (30.0, 9), "GF_MAX_HOR_DIST": (50.0, 9),
        "GF_MAX_VER_DIST": (30.0, 9), "GF_ACTION": (2, 6),
        "COM_DISARM_LAND": (2.0, 9),
    }  # fmt: skip
    sends_unasked = {  # noqa: RUF012
        0: 1.0, 1: 1.0, 24: 1.0, 30: 10.0, 32: 5.0, 33: 2.0, 245: 1.0,
    }  # fmt: skip

    def _boot(self) -> None:
        super()._boot()
        self._flow_s: float | None = None
        self._offboard_lost = False

    @property
    def _landing(self) -> bool:
        return self.mode == self.LAND

    def _on_set_position_target_local_ned(self, message: Any) -> None:
        if self.now_s - self._setpoint_s > 0.5:
            self._flow_s = self.now_s
        super()._on_set_position_target_local_ned(message)

    def _rules(self) -> None:
        super()._rules()
        silent_s = self.now_s - self._setpoint_s
        lost = silent_s > self.parameters["COM_OF_LOSS_T"][0]
        if self.mode == self.OFFBOARD and lost:
            self.mode, self.critical, self._offboard_lost = self.HOLD, True, True
        elif self._offboard_lost and not lost and self.mode == self.HOLD:
            # The failsafe ends with its cause: what was intended goes on.
            self.mode, self.critical, self._offboard_lost = self.OFFBOARD, False, False
        if self.armed and self._outside() and self.mode == self.OFFBOARD:
            self.mode, self.critical = self.HOLD, True
            self.say("Failsafe activated: geofence, switching to Hold")
        if self.armed and self.battery < 0.1 and self.mode not in (self.LAND, self.RETURN):
            self.mode, self.critical = self.RETURN, True
        if self.mode == self.TAKE_OFF and self._target_m is not None and self.height_m > self._target_m - 0.8:
            self.mode = self.HOLD  # and climbs on to the height
        if self._target_m is not None and abs(self.height_m - self._target_m) < 0.03:
            self._target_m = None

    def pilot(self, mode: int) -> None:
        """Let a pilot choose a mode by radio."""
        super().pilot(mode)
        self._offboard_lost = False

    def _wanted(self) -> Setpoint:
        if self._target_m is not None and self.mode in (self.TAKE_OFF, self.HOLD):
            return self._climb()
        if self.mode == self.OFFBOARD:
            return self._setpoint
        if self.mode == self.LAND:
            return self._descend()
        if self.mode == self.RETURN:
            height = self.parameters["RTL_RETURN_ALT"][0]
            return Setpoint((0.0, 0.0, min(self.config.climb_m_s, height - self.height_m)))
        return HOVER

    def _set_mode(self, message: Any) -> int:
        mode = int(message.param2) << 16 | int(message.param3) << 24
        if mode == self.OFFBOARD:
            flowing = self._flow_s is not None and self.now_s - self._flow_s > 1.0
            if not flowing or self.now_s - self._setpoint_s > 0.5:
                self.say("Switching to mode 'Offboard' is currently not possible")
                return BUSY
        if mode not in (self.OFFBOARD, self.HOLD, self.LAND, self.POSITION, self.RETURN):
            return DENIED
        self.mode, self.critical, self._offboard_lost = mode, False, False
        self._target_m = None
        return ACCEPTED

    def _arm_request(self, message: Any) -> int:
        if message.param1 < 0.5:
            return DENIED
        why = self._unready()
        if self.mode == self.POSITION:
            why = "No manual control input"
        if self.mode == self.LAND:
            why = "Arming denied: switch out of Land first"
        if why:
            self.say(f"Preflight Fail: {why}")
            return BUSY
        if not self.armed:
            self._arm()
        return ACCEPTED

    def _unready(self) -> str:
        if self.parameters["NAV_DLL_ACT"][0] and not any(
            self.now_s - at < 5.0 and kind == 6 for at, _, kind in self.heartbeats[-5:]
        ):
            return "No connection to the GCS"
        return super()._unready()

    def _take_off(self, message: Any) -> int:
        if not self.armed:
            return BUSY
        amsl = message.param7 if math.isfinite(message.param7) else self.config.amsl_m + 2.5
        self._target_m, self.mode = max(amsl - self.config.amsl_m, self.height_m), self.TAKE_OFF
        return ACCEPTED

    def _prearm_bits(self) -> tuple[int, int]:
        return 0x1, 0x1 | (0 if self._unready() else _PREARM)  # 'health' alone


class FakeArduPilot(FakeAutopilot):
    """ArduPilot's habits: nothing unasked, GUIDED, altitude above home, no position before an origin."""

    STABILIZE, GUIDED, LOITER, RTL, LAND, BRAKE = 0, 4, 5, 6, 9, 17

    kind = 3
    first_mode = STABILIZE
    parameters = {  # noqa: RUF012
        "GUID_TIMEOUT": (1.0, 9), "FS_GCS_ENABLE": (5, 2), "FENCE_ENABLE": (1, 2), "FENCE_ACTION": (4, 2),
        "RTL_ALT": (1500, 4),
    }  # fmt: skip

    def _boot(self) -> None:
        super()._boot()
        self._steered = self._breached = False

    @property
    def _landing(self) -> bool:
        return self.mode == self.LAND

    def _on_set_position_target_local_ned(self, message: Any) -> None:
        super()._on_set_position_target_local_ned(message)
        if self.mode == self.GUIDED and self._setpoint_s == self.now_s:
            self._steered, self._target_m = True, None  # a velocity ends a take-off

    def _rules(self) -> None:
        super()._rules()
        if self._target_m is not None and abs(self.height_m - self._target_m) < 0.05:
            self._target_m = None
        if not self.armed:
            return
        outside = self._outside() and bool(self.parameters["FENCE_ENABLE"][0])
        if outside and not self._breached:
            self.mode = self.RTL  # and does not call that critical (Copter::any_failsafe_triggered)
            self.say("Fence Breached")
        self._breached = outside
        stations = [at for at, system, _ in self.heartbeats if system == 255]
        if stations and self.now_s - stations[-1] > 5.0 and self.parameters["FS_GCS_ENABLE"][0] == 1:
            self.mode, self.critical = self.RTL, True
        if self.battery < 0.1 and self.mode not in (self.LAND, self.RTL):
            self.mode, self.critical = self.LAND, True

    def _wanted(self) -> Setpoint:
        if self.mode == self.GUIDED:
            if self._target_m is not None:
                return self._climb()
            timed_out = self.now_s - self._setpoint_s > self.parameters["GUID_TIMEOUT"][0]
            return HOVER if timed_out or not self._steered else self._setpoint
        if self.mode == self.LAND:
            return self._descend()
        if self.mode == self.RTL:
            height = self.parameters["RTL_ALT"][0] / 100
            return Setpoint((0.0, 0.0, min(self.config.climb_m_s, height - self.height_m)))
        return HOVER

    def pilot(self, mode: int) -> None:
        """Let a pilot choose a mode by radio."""
        super().pilot(mode)
        self._steered = False

    def _set_mode(self, message: Any) -> int:
        mode = int(message.param2)
        if mode not in (self.STABILIZE, self.GUIDED, self.LOITER, self.RTL, self.LAND, self.BRAKE):
            return FAILED
        if mode in (self.GUIDED, self.LOITER, self.BRAKE) and not self.settled:
            self.say("Mode change failed: requires position")
            return FAILED
        if mode != self.mode:
            self._steered, self._target_m = False, None
        self.mode, self.critical = mode, False
        return ACCEPTED

    def _arm_request(self, message: Any) -> int:
        if message.param1 < 0.5:
            return FAILED
        why = self._unready()
        if why:
            self.say(f"PreArm: {why}")
            return FAILED
        if not self.armed:
            self._arm()
        return ACCEPTED

    def _take_off(self, message: Any) -> int:
        above_ground = message.param7 + self._home_m - self.config.amsl_m
        if not self.armed or self.mode != self.GUIDED or above_ground <= self.height_m:
            return FAILED
        self._target_m = above_ground
        return ACCEPTED

    def _prearm_bits(self) -> tuple[int, int]:
        return 0x1 | _PREARM, 0x1 | (0 if self._unready() else _PREARM)
