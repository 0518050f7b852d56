"""Each guard on the way to the wire, taken away: a test that stands elsewhere fails without it.

The supervisor's rules are data, and are taken away as such (``tests/fly/test_supervisor.py``). What guards
the wire is code: one method is compiled anew without the guard, in the module where it stands.
"""

from __future__ import annotations

import inspect
import math
import sys
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from tests.vehicles.mavlink import test_faults as faults
from tests.vehicles.mavlink import test_missions as missions
from tests.vehicles.mavlink import test_session as session
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.vehicles.mavlink.control import Control
from wigwag.vehicles.mavlink.conversation import Conversation
from wigwag.vehicles.mavlink.session import Session
from wigwag.vehicles.mavlink.telemetry import Telemetry

Probe = Callable[[], object]


@dataclass(frozen=True)
class Guard:
    """A guard, and a test that needs it."""

    name: str
    probe: Probe
    owner: type
    method: str
    code: str
    """What is taken away; stands once in the method."""
    without: str = ""
    """What stands there instead."""


def flown(test: Callable[[Any], object], make: type = FakePx4) -> Probe:
    return lambda: test(make())


def nothing_travels_on() -> None:
    test: Any = session.test_numbers_that_are_none_do_not_travel_on
    test.hypothesis.inner_test([(math.nan, 0.0, 0.0, 0.0, 0.0, 0.0)])


def warned() -> None:
    faults.test_a_pilot_who_takes_over_because_of_a_warning_is_a_pilot(FakePx4(), "RETURN")


def slow() -> None:
    faults.test_the_clock_of_a_simulator_that_does_not_keep_up_is_followed(FakePx4, 0.003, 0.95)


REFUSED = flown(faults.test_what_is_old_disordered_or_no_number_is_refused_at_once)
HANGS = flown(faults.test_a_loop_that_hangs_stands_still_then_holds)
PILOT = flown(faults.test_a_pilot_wins_and_is_never_fought)
GUARDS = (
    # What may be handed over.
    Guard("numbers only", REFUSED, Session, "send", "or not np.isfinite(values).all()"),
    Guard(
        "nothing old", flown(faults.test_a_set_point_that_is_the_newest_and_old_is_refused), Session, "send",
        "now_ns - stamp_ns > self.config.fresh_s * _S", "False",
    ),
    Guard("nothing out of order", REFUSED, Session, "send", "or stamp_ns < self._stamp_ns"),
    Guard(
        "no stamp from the future", flown(faults.test_a_stamp_from_the_future_does_not_stay_fresh), Session,
        "send", "min(stamp_ns, now_ns)", "stamp_ns",
    ),
    # The dead man's switch.
    Guard("nothing grows old", HANGS, Session, "_stream", "if age_s <= self.config.fresh_s:", "if True:"),
    Guard(
        "standing still before the hold", HANGS, Session, "_stream",
        "self.control.lapsed(now_ns)\n    self._post(HOVER, now_ns)", "self.control.lapsed(now_ns)",
    ),
    Guard(
        "a hold after that", HANGS, Session, "_stream",
        "if age_s > self.config.fresh_s + self.config.still_s and not self._asked_for:", "if False:",
    ),
    Guard("heartbeats end with the loop", HANGS, Session, "_periodic", "if alive and", "if"),
    Guard(
        "heartbeats while the loop lives",
        flown(faults.test_a_loop_that_lives_without_setpoints_keeps_its_heartbeat_and_holds), Session,
        "_periodic", "if alive and", "if not alive and",
    ),
    Guard(
        "what was sent before a hold is void",
        flown(faults.test_a_set_point_from_just_before_a_hold_does_not_steer_after_it, FakeArduPilot),
        Session,
        "_leave", "self._setpoint, self._stamp_ns, self._flow_ns = HOVER, _LONG_AGO_NS, None", "pass",
    ),
    Guard(
        "a hold by time-out is asked for",
        flown(faults.test_a_hold_that_the_autopilot_began_by_itself_is_asked_for), Session, "_watch",
        "if self.control.timed_out and", "if False and",
    ),
    # What each autopilot wants.
    Guard(
        "a second of set-points before Offboard",
        missions.test_px4_gets_a_second_of_setpoints_before_offboard,
        Session, "_stream", ">= autopilot.stream_first_s * _S", ">= 0",
    ),
    Guard(
        "no steering without attitude", faults.test_position_without_attitude_steers_nowhere, Session,
        "_post", "(now_ns - t.attitude.stamp_ns) > 0.5 * _S", "False",
    ),
    Guard(
        "a restart is noticed", flown(faults.test_a_reboot_in_flight_is_noticed_and_nothing_is_sent_on),
        Session, "_watch", "if t.restarts != self._restarts:", "if False:",
    ),
    Guard(
        "streams are asked for again", flown(faults.test_streams_that_stop_are_asked_for_again), Session,
        "_watch", "or now_ns - came_ns > 2 * _S",
    ),
    Guard(
        "an acknowledgement is no doing",
        lambda: faults.test_an_acknowledgement_of_what_does_not_happen_is_told(FakePx4), Conversation,
        "command", "result == _ACCEPTED and done is None", "result == _ACCEPTED",
    ),
    Guard(
        "pre-arm where each puts it", session.test_prearm_is_read_where_each_autopilot_puts_it, Telemetry,
        "_on_sys_status", "if self.prearm_present and", "if False and",
    ),
    # Who decides.
    Guard(
        "only in modes that are ours", PILOT, Session, "_stream",
        "if mode not in AIRBORNE:\n        self._flow_ns = None", "if False:\n        self._flow_ns = None",
    ),
    Guard("a pilot is asked for nothing", PILOT, Session, "_leave", ", FlightMode.MANUAL)", ")"),
    Guard(
        "a mode that somebody else changes is let go",
        flown(faults.test_a_pilot_who_takes_over_what_was_asked_for_in_vain_wins), Conversation, "set_mode",
        "if telemetry.custom_mode not in (before, custom_mode):", "if False:",
    ),
    Guard(
        "sticks are a pilot's",
        flown(faults.test_sticks_are_a_pilots_even_if_the_warning_comes_up_with_them), Control, "_changed",
        "and not autopilot.by_sticks(mode)",
    ),
    Guard("an old warning makes no failsafe", warned, Control, "_changed", "and (own or fresh)"),
    Guard(
        "a failsafe leads to the next", flown(faults.test_a_failsafe_that_leads_to_the_next_is_one), Control,
        "_changed", "(own or fresh)", "fresh",
    ),
    Guard(
        "given back by its mode", faults.test_a_pilot_gives_it_back_by_choosing_the_mode_that_listens,
        Control,
        "_changed", "elif doing is Doing.STEER:", "elif False:",
    ),
    Guard(
        "the fence of now", faults.test_a_fence_that_was_met_long_ago_does_not_make_a_pilot_a_failsafe,
        Control, "_at_fence", "<= _FENCE_NS", "<= 10**15",
    ),
    Guard(
        "sticks at the fence", faults.test_a_pilot_who_takes_the_sticks_at_the_fence_is_a_pilot, Control,
        "_at_fence", "and not autopilot.by_sticks(telemetry.custom_mode)",
    ),
    Guard(
        "met while it lands it is not taken over",
        flown(missions.test_met_while_somebody_lands_it_it_is_not_taken_over), Control, "_take_over",
        "given and not telemetry.critical", "True",
    ),
    Guard(
        "met in a failsafe neither", flown(missions.test_met_in_the_air_in_a_failsafe_it_is_not_taken_over),
        Control, "_take_over", "given and not telemetry.critical", "given",
    ),
    # What is believed.
    Guard(
        "a frozen position grows old",
        flown(faults.test_a_position_that_freezes_grows_old_though_messages_go_on), Telemetry,
        "_on_local_position_ned", "if not repeated:", "if True:",
    ),
    Guard(
        "no position that is none", nothing_travels_on, Telemetry, "_on_local_position_ned",
        "not np.isfinite(values).all() or",
    ),
    Guard(
        "no attitude that is none", nothing_travels_on, Telemetry, "_on_attitude",
        "not np.isfinite(values).all() or",
    ),
    Guard(
        "late messages", faults.test_late_messages_do_not_turn_back_time, Telemetry, "_newer",
        "if boot_ms <= heard.boot_ms:", "if False:",
    ),
    Guard(
        "one late message is no restart", session.test_one_late_message_is_no_restart_three_in_order_are,
        Telemetry, "_newer", "len(on_end) < 3 or",
    ),
    Guard(
        "a clock that does not keep up", slow, Telemetry, "echoed",
        "self._clock.answered(asked_ns, boot_ns)",
    ),
    Guard(
        "other systems", flown(faults.test_other_systems_on_the_link_are_not_heard), Conversation, "receive",
        "or source != self.target",
    ),
    Guard(
        "answers to others", session.test_an_acknowledgement_for_somebody_else_is_not_ours, Conversation,
        "_take", "and self._is_ours(message)",
    ),
)  # fmt: skip


@pytest.mark.parametrize("guard", GUARDS, ids=lambda guard: guard.name)
def test_without_any_single_guard_a_test_fails(guard: Guard, monkeypatch: pytest.MonkeyPatch) -> None:
    source = textwrap.dedent(inspect.getsource(getattr(guard.owner, guard.method)))
    assert source.count(guard.code) == 1, f"{guard.owner.__name__}.{guard.method} has not once {guard.code!r}"
    made: dict[str, Any] = {}
    exec(source.replace(guard.code, guard.without), vars(sys.modules[guard.owner.__module__]), made)
    monkeypatch.setattr(guard.owner, guard.method, made[guard.method])
    try:
        guard.probe()
    except AssertionError:
        return
    raise AssertionError(f"nothing notices that {guard.name!r} is missing")
