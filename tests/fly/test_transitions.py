"""Every pair of mode and event: what it leads to, written down here once more and compared with the table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Memory, Mode, Situation
from wigwag.fly.supervisor import RULES, Rules, decide
from wigwag.fly.transitions import TABLE, Event, Transition, arrange
from wigwag.fly.values import Command

S = 10**9
NOW = 1000 * S

MODES = dict(zip("DARTFXHPLNESM", Mode, strict=True))
"""A letter each: Disarmed, Arming, Ready, Taking off, Following, eXecuting, Holding, lost Person, lost Link,
laNding, Emergency, failSafe, pilot (Manual)."""
ACTIONS = {"": Action.NONE, "a": Action.ARM, "t": Action.TAKE_OFF, "l": Action.LAND, "h": Action.HOLD}

EXPECTED = """
event            D   A   R   T   F   X   H   P   L   N   E   S   M
pilot            M   M   M   M   M   M   M   M   M   M   M   M   .
down             .   .   D   D   D   D   D   D   D   D   D   D   D
stop             .   Rl  Rl  Hh  Hh  Hh  Hh  Hh  Hh  Hh  Hh  Hh  .
land             .   Rl  Rl  Nl  Nl  Nl  Nl  Nl  Nl  .   .   Nl  .
land_asked       .   .   .   Hh  Hh  Hh  Hh  Hh  Hh  .   .   Hh  .
failsafe         S   .   S   S   S   S   S   S   S   S   S   .   S
link_gone        .   .   .   .   .   .   .   .   Nl  .   .   .   .
link_lost        .   .   .   Lh  Lh  Lh  Lh  Lh  .   .   .   .   .
clock_jumped     .   Rl  .   Hh  Hh  Hh  .   Hh  .   .   .   .   .
state_gone       .   .   .   El  El  El  El  El  .   .   .   .   .
battery_critical .   .   .   El  El  El  El  El  El  El  .   .   .
fence_broken     .   .   .   El  El  El  El  El  .   .   .   .   .
ill              .   .   .   Nl  Nl  Nl  Nl  Nl  .   .   .   .   .
battery_low      .   .   .   Nl  Nl  Nl  Nl  Nl  .   .   .   .   .
deaf_long        .   .   .   .   .   .   Nl  Nl  .   .   .   .   .
blind_long       .   .   .   .   .   .   Nl  Nl  .   .   .   .   .
person_gone      .   .   .   .   .   .   Nl  Nl  .   .   .   .   .
state_stale      .   .   .   Hh  Hh  Hh  .   Hh  .   .   .   .   .
deaf             .   .   .   Hh  Hh  Hh  .   Hh  .   .   .   .   .
person_swapped   .   .   .   .   Hh  Hh  .   Hh  .   .   .   .   .
person_lost      .   .   .   .   P   P   .   .   .   .   .   .   .
person_far       .   .   .   .   P   P   .   .   .   .   .   .   .
timeout          .   D   .   Nl  .   Hh  .   .   .   .   .   .   .
not_landing      .   .   .   .   .   .   .   .   .   Nl  El  .   .
armed            R   Tt  .   .   R   R   R   R   .   .   .   R   R
link_back        .   .   .   .   .   .   .   .   H   .   .   .   .
airborne         H   .   H   F   .   .   .   .   .   .   .   H   H
take_off         Aa  .   Tt  .   .   .   .   .   .   .   .   .   .
move             .   .   .   .   X   X   X   .   .   .   .   .   .
moved            .   .   .   .   .   F   .   .   .   .   .   .   .
person_seen      .   .   .   .   .   .   .   F   .   .   .   .   .
"""
"""A line an event, a column a mode: the letter of the mode that follows, and what the vehicle is asked;
``.``: nothing happens."""


def expected() -> dict[tuple[Mode, Event], tuple[Mode, Action] | None]:
    lines = [line.split() for line in EXPECTED.strip().splitlines()]
    columns = [MODES[letter] for letter in lines[0][1:]]
    return {
        (mode, Event(name)): None if cell == "." else (MODES[cell[0]], ACTIONS[cell[1:]])
        for name, *cells in lines[1:]
        for mode, cell in zip(columns, cells, strict=True)
    }


CRAFT = {
    Mode.DISARMED: Craft.DOWN, Mode.ARMING: Craft.DOWN, Mode.READY: Craft.ARMED,
    Mode.TAKING_OFF: Craft.CLIMBING, Mode.LANDING: Craft.SINKING, Mode.EMERGENCY: Craft.SINKING,
    Mode.FAILSAFE: Craft.OWN, Mode.PILOT: Craft.PILOTED,
}  # fmt: skip
"""What the vehicle does in each mode as long as nothing happens; elsewhere it flies."""


def usual(mode: Mode) -> tuple[Memory, Situation]:
    """A moment of a mode in which nothing happens."""
    memory = Memory(
        mode, NOW - 2 * S, NOW - S // 30, 0, *[NOW - S // 30] * 6, asked_ns=NOW - 3 * S
    )  # fmt: skip
    situation = Situation(
        NOW, CRAFT.get(mode, Craft.AIRBORNE), NOW, NOW, (0.0, 0.0, 1.5), 0.0, 0.8, True, NOW, NOW, 4.0, 0.0,
        0, NOW - 60 * S, NOW, None, mode is Mode.EXECUTING,
    )  # fmt: skip
    if mode is Mode.LOST_PERSON:
        situation = replace(situation, pose_ns=NOW - 2 * S)
    if mode is Mode.LOST_LINK:
        situation = replace(situation, link_ns=NOW - 3 * S, state_ns=NOW - 3 * S)
        memory = replace(memory, link_ok_ns=NOW - 2 * S, state_ok_ns=NOW - 2 * S)
    if mode is Mode.FAILSAFE:
        memory = replace(memory, asked_ns=NOW)
    return memory, situation


Change = dict[str, Any]
HAPPENS: dict[Event, tuple[Change, Change]] = {
    Event.PILOT: ({}, {"craft": Craft.PILOTED}),
    Event.DOWN: ({}, {"craft": Craft.DOWN}),
    Event.STOP: ({}, {"command": Command.STOP}),
    Event.LAND: ({}, {"command": Command.LAND, "held_s": 2.0}),
    Event.LAND_ASKED: ({}, {"command": Command.LAND, "held_s": 0.1}),
    Event.FAILSAFE: ({"asked_ns": None}, {"craft": Craft.OWN}),
    Event.LINK_GONE: ({"link_ok_ns": NOW - 11 * S}, {"link_ns": NOW - 12 * S}),
    Event.LINK_LOST: ({"link_ok_ns": NOW - S // 10}, {"link_ns": NOW - 2 * S}),
    Event.CLOCK_JUMPED: ({"now_ns": NOW - 2 * S}, {}),
    Event.STATE_GONE: ({"state_ok_ns": NOW - 6 * S}, {"state_ns": NOW - 6 * S}),
    Event.BATTERY_CRITICAL: ({}, {"battery": 0.05}),
    Event.FENCE_BROKEN: ({}, {"position_m": (40.0, 0.0, 1.5)}),
    Event.ILL: ({"health_ok_ns": NOW - 3 * S}, {"healthy": False}),
    Event.BATTERY_LOW: ({}, {"battery": 0.2}),
    Event.DEAF_LONG: ({"hearing_ok_ns": NOW - 21 * S}, {"deaf_ns": NOW - 21 * S}),
    Event.BLIND_LONG: ({"camera_ok_ns": NOW - 11 * S}, {"camera_ns": NOW - 11 * S, "pose_ns": NOW - 11 * S}),
    Event.PERSON_GONE: ({"person_ok_ns": NOW - 31 * S}, {"pose_ns": NOW - 31 * S}),
    Event.STATE_STALE: ({}, {"state_ns": NOW - S}),
    Event.DEAF: ({}, {"deaf_ns": NOW}),
    Event.PERSON_SWAPPED: ({}, {"person": 1}),
    Event.PERSON_LOST: ({}, {"pose_ns": NOW - S}),
    Event.PERSON_FAR: ({}, {"distance_m": 8.5}),
    Event.TIMEOUT: ({"since_ns": NOW - 100 * S}, {}),
    Event.NOT_LANDING: ({}, {"craft": Craft.AIRBORNE}),
    Event.ARMED: ({}, {"craft": Craft.ARMED}),
    Event.LINK_BACK: ({}, {"link_ns": NOW, "state_ns": NOW}),
    Event.AIRBORNE: ({}, {"craft": Craft.AIRBORNE}),
    Event.TAKE_OFF: ({}, {"command": Command.TAKE_OFF, "held_s": 2.0}),
    Event.MOVE: ({}, {"command": Command.UP}),
    Event.MOVED: ({}, {"moving": False}),
    Event.PERSON_SEEN: ({}, {"pose_ns": NOW}),
}
"""What makes each event happen: changes of the memory and of the situation."""


def play(mode: Mode, event: Event, rules: Rules = RULES) -> tuple[str, Mode, Action]:
    memory, situation = usual(mode)
    remembered, told = HAPPENS[event]
    after, verdict = decide(
        replace(memory, **remembered), replace(situation, **told), SupervisorConfig(), rules
    )
    assert after.mode is verdict.mode
    return verdict.row, verdict.mode, verdict.action


def alone(event: Event) -> Rules:
    """The rules, as if nothing but this event could happen."""
    return Rules(
        tuple(row for row in TABLE if row.event is event),
        {e: watch for e, watch in RULES.watches.items() if e is event},
        RULES.gates,
        RULES.guards,
    )


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("event", list(Event))
def test_every_pair_leads_where_it_is_listed(mode: Mode, event: Event) -> None:
    wanted = expected()[mode, event]
    row, after, action = play(mode, event, alone(event))
    if wanted is None:
        assert (row, after, action) == ("", mode, Action.NONE)
    else:
        assert row and (after, action) == wanted


@pytest.mark.parametrize("mode", list(Mode))
def test_nothing_happens_while_all_is_as_usual(mode: Mode) -> None:
    memory, situation = usual(mode)
    _, verdict = decide(memory, situation, SupervisorConfig())
    assert (verdict.row, verdict.mode) == ("", mode)


def test_every_pair_is_listed_once() -> None:
    assert set(expected()) == {(mode, event) for mode in Mode for event in Event}
    assert len(EXPECTED.strip().splitlines()) == len(Event) + 1


@pytest.mark.parametrize("mode", [m for m in Mode if m not in (Mode.DISARMED, Mode.PILOT)])
@pytest.mark.parametrize("event", [e for e in Event if e not in (Event.PILOT, Event.DOWN, Event.STOP)])
def test_stop_wins_over_everything_but_the_pilot_and_the_ground(mode: Mode, event: Event) -> None:
    memory, situation = usual(mode)
    remembered, told = HAPPENS[event]
    _, verdict = decide(
        replace(memory, **remembered),
        replace(situation, **{**told, "command": Command.STOP}),
        SupervisorConfig(),
    )
    assert verdict.accepted is Command.STOP
    assert verdict.mode in (Mode.HOLDING, Mode.READY)


@pytest.mark.parametrize("mode", [m for m in Mode if m not in (Mode.DISARMED, Mode.PILOT)])
@pytest.mark.parametrize(
    "event", [e for e in Event if e not in (Event.PILOT, Event.DOWN, Event.STOP, Event.LAND_ASKED)]
)
def test_land_wins_over_everything_but_stop_the_pilot_and_the_ground(mode: Mode, event: Event) -> None:
    memory, situation = usual(mode)
    remembered, told = HAPPENS[event]
    _, verdict = decide(
        replace(memory, **remembered),
        replace(situation, **{**told, "command": Command.LAND, "held_s": 2.0}),
        SupervisorConfig(),
    )
    assert verdict.mode in (Mode.LANDING, Mode.READY, Mode.EMERGENCY, Mode.FAILSAFE)
    if mode not in (Mode.LANDING, Mode.EMERGENCY):
        assert verdict.accepted is Command.LAND


def test_names_are_given_once_and_every_row_says_why() -> None:
    names = [row.name for row in TABLE]
    assert len(set(names)) == len(names)
    assert all(row.why and row.sources for row in TABLE)
    limits = SupervisorConfig()
    assert all(hasattr(limits, row.after) for row in TABLE if row.after)


def test_two_rows_for_one_event_in_one_mode_are_an_error() -> None:
    double = Transition("again", Event.STOP, (Mode.HOLDING,), Mode.LANDING)
    with pytest.raises(ValueError, match="Two transitions answer one event in holding"):
        arrange((*TABLE, double))
