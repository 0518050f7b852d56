"""The supervisor, stepped by hand through short flights, with all of its rules and without any one."""

from __future__ import annotations

import pytest

from tests.fly.scenarios import SCENARIOS, Scenario
from tests.fly.scene import S, Scene, flying
from wigwag.errors import InputError
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Memory, Mode, Situation, age_s
from wigwag.fly.supervisor import RULES, Supervisor, decide
from wigwag.fly.values import Command


@pytest.mark.parametrize("play", SCENARIOS, ids=lambda play: play.__name__)
def test_scenario(play: Scenario) -> None:
    play(RULES)


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
