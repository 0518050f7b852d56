"""Limits set anew in flight: only ever tighter, never looser than they began, never behind the drone."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fly.scene import flying
from wigwag.errors import InputError
from wigwag.fly.fence import Cylinder, Polygon
from wigwag.fly.helm import Helm
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Situation
from wigwag.fly.supervisor import Supervisor
from wigwag.fly.tighten import DIALS, FENCE_RADIUS, changed, setting, tightened, with_settings
from wigwag.fly.values import Setpoint

START = SupervisorConfig()
UP = Situation(0, Craft.AIRBORNE, 0, 0, (3.0, 4.0, 1.5), distance_m=4.5)
NAMES = [dial.name for dial in DIALS]
TIGHTER = {
    "max_speed_m_s": 0.5, "max_climb_m_s": 0.3, "max_yaw_rate_rad_s": 0.6, "min_distance_m": 3.0,
    "max_distance_m": 6.0, "ceiling_m": 2.0, FENCE_RADIUS: 8.0,
}  # fmt: skip


@pytest.mark.parametrize("dial", DIALS, ids=lambda dial: dial.name)
def test_a_limit_gets_tighter_in_flight_and_looser_only_on_the_ground(dial) -> None:
    first, tight = setting(START, dial.name), TIGHTER[dial.name]
    limits, why = tightened(START, START, UP, dial.name, tight)
    assert (why, setting(limits, dial.name)) == ("", tight)
    same, why = tightened(limits, START, UP, dial.name, first)
    assert same is limits and "in flight a limit only gets tighter" in why
    for craft in set(Craft) - {Craft.DOWN}:
        assert tightened(limits, START, replace(UP, craft=craft), dial.name, first)[0] is limits
    down = replace(UP, craft=Craft.DOWN)
    assert setting(tightened(limits, START, down, dial.name, first)[0], dial.name) == first
    beyond = first + (1.0 if dial.lowers else -1.0)
    assert "where the flight began" in tightened(limits, START, down, dial.name, beyond)[1]
    silly = dial.tightest + (-0.05 if dial.lowers else 0.05)
    assert tightened(START, START, replace(down, distance_m=None), dial.name, silly)[0] is START


@given(
    st.lists(st.tuples(st.sampled_from(NAMES), st.floats(allow_nan=True, allow_infinity=True)), max_size=8),
    st.sampled_from(list(Craft)),
)
def test_whatever_is_asked_for_the_limits_stay_whole_and_never_get_looser(
    asked: list[tuple[str, float]], craft: Craft
) -> None:
    limits, now = START, replace(UP, craft=craft)
    for name, value in asked:
        before, (limits, why) = limits, tightened(limits, START, now, name, value)
        assert (limits is before) == bool(why)
        for dial in DIALS:
            is_now, first = setting(limits, dial.name), setting(START, dial.name)
            assert is_now is not None and first is not None and math.isfinite(is_now)
            assert is_now <= first + 1e-6 if dial.lowers else is_now >= first - 1e-6
        assert limits.max_distance_m - limits.min_distance_m > 0.99


@pytest.mark.parametrize(
    ("name", "value"), [("ceiling_m", 1.2), ("max_distance_m", 4.0), (FENCE_RADIUS, 4.5)]
)
def test_a_limit_is_not_drawn_behind_the_drone(name: str, value: float) -> None:
    limits, why = tightened(START, START, UP, name, value)
    assert limits is START and "bring it back first" in why


def test_nearest_and_farthest_stay_apart() -> None:
    near = with_settings(START, {"min_distance_m": 4.0})
    assert "1 m apart" in tightened(near, START, UP, "max_distance_m", 4.6)[1]


@pytest.mark.parametrize("name", ["battery_low", "colour", "fence", ""])
def test_what_is_no_dial_cannot_be_set(name: str) -> None:
    assert tightened(START, START, UP, name, 0.1) == (START, f"{name}: 0.1 cannot be set")
    with pytest.raises(InputError, match="There are: max_speed_m_s"):
        with_settings(START, {name: 0.1})


def test_what_changed_can_be_set_again() -> None:
    tight = replace(START, max_speed_m_s=0.5, ceiling_m=2.0, fence=Cylinder(9.0))
    values = changed(START, tight)
    assert values == {"max_speed_m_s": 0.5, "ceiling_m": 2.0, FENCE_RADIUS: 9.0}
    assert with_settings(START, values) == tight and changed(tight, tight) == {}


def test_a_polygon_has_no_radius() -> None:
    yard = SupervisorConfig(fence=Polygon(((-9, -9), (9, -9), (9, 9), (-9, 9))))
    assert setting(yard, FENCE_RADIUS) is None
    assert "cannot be set" in tightened(yard, yard, UP, FENCE_RADIUS, 5.0)[1]


def test_the_fence_keeps_its_centre() -> None:
    limits = with_settings(SupervisorConfig(fence=Cylinder(20.0, (1.0, 2.0))), {FENCE_RADIUS: 9.0})
    assert limits.fence == Cylinder(9.0, (1.0, 2.0))


def test_what_was_tightened_holds_for_set_points_at_once() -> None:
    scene = flying()
    scene.wish = Setpoint((1.4, 0.0, 0.0))
    scene.turn()
    assert scene.sent[-1] == Setpoint((1.4, 0.0, 0.0))
    assert scene.supervisor.tighten(scene.situation(), "max_speed_m_s", 0.4) == ""
    scene.turn()
    assert scene.sent[-1] == Setpoint((0.4, 0.0, 0.0))
    assert "only gets tighter" in scene.supervisor.tighten(scene.situation(), "max_speed_m_s", 1.4)
    assert Supervisor().start == Supervisor().config


def test_goal_and_movements_are_brought_within() -> None:
    helm = Helm()
    limits = replace(START, max_distance_m=4.0, min_distance_m=3.0, ceiling_m=1.0)
    helm.keep_within(limits)
    bounds, goal = helm.movement.config, helm.movement.goal
    assert (bounds.min_distance_m, bounds.max_distance_m, bounds.max_altitude_m) == (3.0, 4.0, 1.0)
    assert (goal.distance_m, goal.altitude_m) == (4.0, 1.0)
    helm.keep_within(START)
    assert helm.movement.config == helm.bounds, "looser again on the ground, the movements are as before"
