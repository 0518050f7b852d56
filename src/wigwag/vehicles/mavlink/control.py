"""Who decides over the vehicle: wigwag, a pilot, or the autopilot's own failsafe."""

from __future__ import annotations

from enum import Enum

from wigwag.vehicles.mavlink.autopilots import Autopilot, Doing
from wigwag.vehicles.mavlink.telemetry import Telemetry

_S = 1_000_000_000
_EXPECTED_NS = 5 * _S
_LAPSE_NS = 4 * _S
"""PX4 leaves Offboard COM_OF_LOSS_T (1 s) after the last set-point and tells of it within a second more."""
_WITH_NS = _S // 2
"""A complaint that came up so shortly before a change of mode came with it: faster than a pilot reacts."""
_FENCE_NS = 2 * _S
"""ArduPilot looks for its fence once a second, and tells of it apart from the mode."""


class Decides(Enum):
    """Whose word counts."""

    WIGWAG = "wigwag"
    PILOT = "pilot"
    FAILSAFE = "failsafe"


class Control:
    """Watches the flight mode: what was not asked for here was asked for by somebody else.

    It is given back by choosing the mode in which set-points count (Offboard, GUIDED), or by disarming. In
    doubt whether a pilot or the autopilot changed it, it was the pilot, who is not even asked to hold: both
    autopilots say critical as long as anything is amiss, also after a pilot took over because of it.
    """

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Begin anew, as after the autopilot's own restart."""
        self.decides = Decides.WIGWAG
        self.timed_out = False
        """The autopilot holds because set-points stopped; it is to be told that it shall."""
        self._mode: int | None = None
        self._armed = False
        self._unsure = False
        """Met armed, and not yet known whether it stands or flies."""
        self._critical_ns: int | None = None
        """Since when the autopilot has said that something is amiss; ``None``: it does not."""
        self._changed_ns = 0
        """When the mode was last changed by somebody else."""
        self._expected: dict[int, int] = {}
        self._lapsed_ns: int | None = None

    def expect(self, custom_mode: int, now_ns: int) -> None:
        """Note that a mode was asked for here."""
        self._expected[custom_mode] = now_ns

    def lapsed(self, now_ns: int) -> None:
        """Note that set-points may not have reached the vehicle: none were sent, or the link was mute."""
        self._lapsed_ns = now_ns

    def seen(self, telemetry: Telemetry, autopilot: Autopilot, now_ns: int) -> None:
        """Look at the newest heartbeat."""
        mode, before = telemetry.custom_mode, self._mode
        was_armed, self._armed, self._mode = self._armed, telemetry.armed, mode
        if not telemetry.critical:
            self._critical_ns = None
        elif self._critical_ns is None:
            self._critical_ns = now_ns
        if not telemetry.armed:
            self.decides, self.timed_out, self._unsure = Decides.WIGWAG, False, False
        elif (not was_armed and before is None) or (self._unsure and mode == before):
            self._take_over(autopilot.doing(mode), telemetry)
        elif mode != before:
            self._changed(autopilot, before, telemetry, now_ns)
        elif self.decides is Decides.PILOT and self._at_fence(autopilot, telemetry):
            self.decides = Decides.FAILSAFE  # told of after the change

    def _take_over(self, doing: Doing, telemetry: Telemetry) -> None:
        """Met in the air: what hovers by itself is taken over, what is flown by sticks is not."""
        stands = telemetry.stands  # not told yet with the first heartbeat
        given = doing in (Doing.STEER, Doing.HOLD) or stands is True
        self._unsure = not given and stands is None
        self.decides = Decides.WIGWAG if given and not telemetry.critical else Decides.PILOT

    def _changed(self, autopilot: Autopilot, before: int | None, telemetry: Telemetry, now_ns: int) -> None:
        mode, self._unsure = telemetry.custom_mode, False
        doing = autopilot.doing(mode)
        asked_ns = self._expected.get(mode)
        after = before is not None and autopilot.doing(before) is Doing.TAKE_OFF and doing is Doing.HOLD
        lapsed = self._lapsed_ns is not None and now_ns - self._lapsed_ns < _LAPSE_NS
        own = self.timed_out or self.decides is Decides.FAILSAFE
        self.timed_out = False
        if asked_ns is not None and now_ns - asked_ns < _EXPECTED_NS:
            self.decides = Decides.WIGWAG
        elif after and self.decides is Decides.WIGWAG:
            pass  # a take-off that ends in holding
        elif doing is Doing.STEER:
            self.decides = Decides.WIGWAG  # given back
        elif doing is Doing.HOLD and telemetry.critical and lapsed and self.decides is Decides.WIGWAG:
            self.timed_out = True
        else:
            self._changed_ns = now_ns
            # One failsafe leads to the next (PX4 holds for COM_FAIL_ACT_T before it returns).
            fresh = self._critical_ns is not None and now_ns - self._critical_ns <= _WITH_NS
            itself = telemetry.critical and (own or fresh) and not autopilot.by_sticks(mode)
            failsafe = itself or self._at_fence(autopilot, telemetry)
            self.decides = Decides.FAILSAFE if failsafe else Decides.PILOT

    def _at_fence(self, autopilot: Autopilot, telemetry: Telemetry) -> bool:
        """Say whether ArduPilot changed the mode at its fence, which it does not call critical."""
        met_ns = telemetry.fence_ns
        near = met_ns is not None and abs(met_ns - self._changed_ns) <= _FENCE_NS
        return near and not autopilot.by_sticks(telemetry.custom_mode)
