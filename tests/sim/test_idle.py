"""An operator who commands nothing: no command in the plan, and it is as long as asked."""

from __future__ import annotations

import pytest

from wigwag.errors import InputError
from wigwag.sim.idle import plan_idle
from wigwag.sim.person import Person


def test_nothing_in_the_plan_is_a_command_and_much_is_going_on() -> None:
    script = plan_idle(Person.random(3), seed=3, duration_s=120)
    assert 120 <= script.duration_s < 135
    assert not any(shown.is_command for shown in script.shown)
    assert len({shown.label for shown in script.shown}) >= 8
    assert any(walk.turn > 0 for walk in script.walks)


def test_the_same_seed_gives_the_same_plan() -> None:
    plans = [plan_idle(Person.random(3), seed, 30) for seed in (1, 1, 2)]
    assert plans[0].shown == plans[1].shown != plans[2].shown


def test_a_duration_of_nothing() -> None:
    with pytest.raises(InputError, match="needs a duration above 0"):
        plan_idle(Person.random(3), 0, 0)
