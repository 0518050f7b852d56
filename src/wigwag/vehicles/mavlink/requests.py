"""Arming, taking off, landing, holding and steering, step by step."""

from __future__ import annotations

from wigwag.errors import VehicleError
from wigwag.vehicles.mavlink.autopilots import Autopilot, CommandRequest, Doing
from wigwag.vehicles.mavlink.control import Control, Decides
from wigwag.vehicles.mavlink.conversation import Conversation, Procedure

_S = 1_000_000_000
_ARM, _TAKE_OFF = 400, 22
_FRESH_POSITION_S = 1.0
_NEAR_M, _CALM_M_S = 0.3, 0.3
_CLIMB_S, _SETTLE_S, _SPOOL_UP_S = 40.0, 8.0, 9.0
"""Large motors take seconds until they lift; ArduPilot says that it stands until then."""


class Requests:
    """The procedures behind a vehicle's requests. Each returns why it failed, or nothing.

    Args:
        talk: With the autopilot, once it was found.
        control: Told of every mode that is asked for.
    """

    def __init__(self, talk: Conversation, control: Control) -> None:
        assert talk.autopilot is not None
        self._talk, self._control = talk, control
        self._autopilot: Autopilot = talk.autopilot

    def change(self, custom_mode: int) -> Procedure:
        """Change the mode, and say that it was us."""
        if self._talk.telemetry.custom_mode == custom_mode and not self._control.timed_out:
            return ""
        self._control.expect(custom_mode, self._talk.now_ns)
        reason = yield from self._talk.set_mode(custom_mode)
        return reason

    def confirm_hold(self) -> Procedure:
        """Tell an autopilot that holds because set-points stopped that it shall go on holding."""
        params = self._autopilot.mode_params(self._autopilot.hold_mode)
        self._control.expect(self._autopilot.hold_mode, self._talk.now_ns)
        reason = yield from self._talk.command(CommandRequest(176, "go on holding", params))
        if not reason:
            self._control.timed_out = False
        return reason

    def arm(self) -> Procedure:
        """Unlock the propellers. PX4 does not arm in the mode it landed in; ArduPilot takes off in GUIDED."""
        telemetry = self._talk.telemetry
        reason = yield from self.change(self._autopilot.arm_mode)
        if reason:
            return reason
        request = CommandRequest(_ARM, "arm", (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        return (yield from self._talk.command(request, lambda: telemetry.armed))

    def take_off(self, height_m: float) -> Procedure:
        """Climb to a height above where it stands."""
        talk, telemetry, autopilot = self._talk, self._talk.telemetry, self._autopilot
        reason = yield from self.change(autopilot.arm_mode)
        if reason:
            return reason
        # Arming may move home and the altitude with it: what counts is what is told from now on.
        until = talk.now_ns + int(0.5 * _S)
        while talk.now_ns < until:
            yield
        try:
            params = autopilot.take_off_params(height_m, telemetry)
        except VehicleError as error:
            return str(error)

        def climbing() -> bool:
            return autopilot.doing(telemetry.custom_mode) is Doing.TAKE_OFF or not telemetry.on_ground

        request = CommandRequest(_TAKE_OFF, "take off", params)
        for mode in (getattr(autopilot, "take_off_mode", autopilot.arm_mode), autopilot.arm_mode):
            self._control.expect(mode, talk.now_ns)
        reason = yield from talk.command(request, climbing, _SPOOL_UP_S)
        if reason:
            return reason
        return (yield from self._climb(height_m))

    def _climb(self, height_m: float) -> Procedure:
        """Wait until it is up and calm. PX4 holds within 0.8 m of the height and climbs on while holding."""
        talk, telemetry = self._talk, self._talk.telemetry
        end = talk.now_ns + int(_CLIMB_S * _S)
        settled: int | None = None
        while talk.now_ns < end and telemetry.armed:
            if self._control.decides is not Decides.WIGWAG:
                return f"{self._autopilot.name}: the take-off was taken over"
            close = telemetry.height_m > height_m - _NEAR_M and abs(telemetry.climb_m_s) < _CALM_M_S
            if close and self._autopilot.doing(telemetry.custom_mode) is not Doing.TAKE_OFF:
                return ""
            if self._autopilot.doing(telemetry.custom_mode) is Doing.HOLD:
                settled = settled or talk.now_ns
                if talk.now_ns - settled > _SETTLE_S * _S:
                    return ""
            yield
        return f"{self._autopilot.name} did not reach {height_m:g} m in {_CLIMB_S:g} s"
