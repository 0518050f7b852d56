"""The supervisor, stepped by hand through short flights, with all of its rules and without any one."""

from __future__ import annotations

import math

import pytest

from tests.fly.scenarios import SCENARIOS, Scenario
from tests.fly.scene import S, Scene, flying
from wigwag.errors import InputError
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Memory, Mode, Situation, age_s
from wigwag.fly.supervisor import RULES, Supervisor, decide
from wigwag.fly.values import HOVER, Command, Setpoint


@pytest.mark.parametrize("play", SCENARIOS, ids=lambda play: play.__name__)
def test_scenario(play: Scenario) -> None:
    play(RULES)


LIMITS = SupervisorConfig()
RULE_NAMES = [
    *(row.name for row in RULES.table),
    *(watch.__name__ for watch in RULES.watches.values()),
    *(gate.name for gate in RULES.gates),
    *(guard.__name__ for guard in RULES.guards),
]


@pytest.mark.parametrize("name", RULE_NAMES)
def test_without_any_single_rule_a_scenario_fails(name: str) -> None:
    rules = RULES.without(name)
    count = sum(map(len, (rules.table, rules.watches, rules.gates, rules.guards)))
    assert count < sum(map(len, (RULES.table, RULES.watches, RULES.gates, RULES.guards)))

    def fails(play: Scenario) -> bool:
        try:
            play(rules)
        except AssertionError:
            return True
        return False

    assert any(fails(play) for play in SCENARIOS), f"nothing notices that {name!r} is missing"


@pytest.mark.parametrize(
    ("row", "mode"), [(row.name, mode) for row in RULES.table for mode in row.sources], ids=str
)
def test_each_rule_is_named_once(row: str, mode: Mode) -> None:
    assert RULE_NAMES.count(row) == 1
    assert [r.name for r in RULES.rows[mode]].count(row) == 1


def test_deciding_is_a_function_of_its_arguments() -> None:
    memory = Memory(Mode.FOLLOWING)
    situation = Situation(5 * S, Craft.AIRBORNE, 5 * S, 5 * S, pose_ns=5 * S, distance_m=4.0)
    first = decide(memory, situation, SupervisorConfig())
    assert first == decide(memory, situation, SupervisorConfig())
    assert memory == Memory(Mode.FOLLOWING), "what was handed in stays as it was"


def test_a_taken_over_vehicle_with_nobody_in_view_hovers() -> None:
    scene = Scene(mode=Mode.FOLLOWING)
    scene.known["distance_m"] = None
    scene.ages["pose_ns"] = None
    assert scene.turn().mode is Mode.LOST_PERSON


@pytest.mark.parametrize("nothing", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("mode", [Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON, Mode.HOLDING])
def test_what_is_no_number_is_not_known(mode: Mode, nothing: float) -> None:
    """A guard that compares with NaN lets everything pass: the fence, the floor, the minimum distance."""
    for name, value in (
        ("position_m", (nothing, 0.0, 1.5)),
        ("position_m", (0.0, 0.0, nothing)),
        ("heading_rad", nothing),
    ):
        scene = flying(mode=mode)
        scene.free("pose_ns")
        scene.known[name] = value
        scene.turns(0.1)
        assert scene.mode is Mode.HOLDING and not any(move(sent) for sent in scene.sent[-3:])
        scene.turns(LIMITS.land_without_state_s + 0.2)
        assert scene.mode is Mode.EMERGENCY
    for name in ("distance_m", "bearing_rad"):
        scene = flying(mode=mode)
        scene.free("pose_ns")
        scene.known[name] = nothing
        scene.turns(0.1)
        assert scene.mode is (Mode.HOLDING if mode is Mode.HOLDING else Mode.LOST_PERSON)
        assert not any(move(sent) for sent in scene.sent[-3:])
    scene = flying(mode=mode)
    scene.known["battery"] = nothing
    scene.turns(0.1)
    assert scene.mode in (mode, Mode.FOLLOWING)


def move(sent: Setpoint | None) -> bool:
    return sent is not None and sent != HOVER


def test_a_landing_shown_briefly_is_not_half_of_a_take_off() -> None:
    scene = Scene()
    scene.turns(2.0)
    scene.turn(Command.LAND, held_s=0.4)
    scene.turns(2.0)
    assert scene.turn(Command.TAKE_OFF, held_s=0.5).reason == "take_off: show it again to confirm"


def test_a_confirmation_counts_once() -> None:
    scene = Scene()
    scene.turns(2.0)
    scene.turn(Command.TAKE_OFF, held_s=0.5)
    scene.turns(2.0)
    assert scene.turn(Command.TAKE_OFF, held_s=0.5).mode is Mode.ARMING
    assert scene.turn(Command.STOP).mode is Mode.READY
    scene.turns(3.0)
    assert scene.turn(Command.TAKE_OFF, held_s=0.5).reason == "take_off: show it again to confirm"


def test_a_clock_that_is_set_back_makes_nothing_younger() -> None:
    scene = flying(mode=Mode.HOLDING)
    scene.stick("pose_ns")
    scene.turns(20.0)
    scene.turn(passed_s=-60.0)
    scene.until(Mode.LANDING, LIMITS.land_when_lost_s - 20.0 + 1.0)


def test_reasons_are_said() -> None:
    scene = flying()
    assert scene.turn(Command.TAKE_OFF).reason == "take_off: not while following"
    scene.known["battery"] = 0.2
    assert scene.turn(Command.UP).reason == "up: not while following; battery low"


def test_a_stamp_just_ahead_of_the_clock_is_fresh_and_one_from_the_future_is_not() -> None:
    assert age_s(10 * S, 10 * S + S // 20) == pytest.approx(-0.05)
    assert age_s(10 * S, 11 * S) == float("inf")


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"max_speed_m_s": -1.0}, "max_speed_m_s must be 0 or more, but got -1.0"),
        ({"min_distance_m": 9.0}, "min_distance_m must be below max_distance_m"),
        ({"battery_critical": 0.5}, "battery_critical must be below battery_low"),
        ({"retreat_m_s": float("nan")}, "retreat_m_s must be 0 or more"),
    ],
)
def test_limits_that_make_no_sense_are_an_error(changes: dict[str, float], says: str) -> None:
    with pytest.raises(InputError, match=says):
        SupervisorConfig(**changes)  # type: ignore[arg-type]


def test_a_supervisor_begins_on_the_ground() -> None:
    assert Supervisor().mode is Mode.DISARMED
