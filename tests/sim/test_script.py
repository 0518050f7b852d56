from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.sim.gestures import BACKGROUND, COMMANDS, DISTRACTORS, perform
from wigwag.sim.person import Person
from wigwag.sim.script import Act, Script, ScriptConfig, Walk, plan_session, shuffled_order


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_a_session_shows_what_it_promises(person_seed, seed):
    script = plan_session(Person.random(person_seed), seed)
    commands = Counter(s.label for s in script.shown if s.is_command)
    assert commands == dict.fromkeys(COMMANDS, 2)
    others = Counter(s.label for s in script.shown if not s.is_command)
    assert sum(others.values()) == 6
    assert set(others) <= set(DISTRACTORS)
    assert len(others) == 6, "no other movement twice while there are enough"
    for before, after in pairwise(script.shown):
        landed = before.label == "land"  # the drone comes down and the operator steps back from it
        assert 1.5 <= after.start_s - before.end_s <= (8.0 if landed else 6.0)
    assert script.shown[0].start_s >= 1.0
    assert script.duration_s >= script.shown[-1].end_s + 1.0
    assert 80 < script.duration_s < 140


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10_000))
def test_taking_off_comes_first_and_landing_last_and_nobody_walks_from_a_drone_on_the_ground(seed):
    script = plan_session(Person.random(seed), seed)
    labels = [s.label for s in script.shown]
    edges = [i for i, label in enumerate(labels) if label in ("take_off", "land")]
    assert [labels[i] for i in edges] == ["take_off", "land"] * 2
    assert edges[0] == 0 and edges[-1] == len(labels) - 1 and edges[2] == edges[1] + 1
    grounded = [(0.0, script.shown[0].end_s)]
    grounded += [(script.shown[edges[1]].start_s, script.shown[edges[2]].end_s + 2.0)]
    for walk in script.walks:
        for start, end in grounded:
            assert walk.from_drone or walk.start_s >= end or walk.start_s + walk.duration_s <= start


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10_000))
def test_walks_are_slow_enough_and_stay_near(seed):
    config = ScriptConfig()
    script = plan_session(Person.random(seed), seed, config)
    place, clock = np.zeros(2), np.arange(0, script.duration_s, 0.02)
    assert any(walk.speed_m_s > 0.3 for walk in script.walks)
    for walk in script.walks:
        velocity = np.array(
            [walk.velocity(t) for t in clock if -0.1 < t - walk.start_s < walk.duration_s + 0.1]
        )
        speed = np.hypot(*velocity.T)
        assert speed.max() <= 0.75
        assert np.abs(np.diff(velocity, axis=0) / 0.02).max() < 3.0
        if walk.from_drone:
            continue  # where to is only known once the drone has landed
        place = place + velocity.sum(axis=0) * 0.02
        assert np.hypot(*place) < config.radius_m + 0.5
    for before, after in pairwise(script.walks):
        assert after.start_s >= before.start_s + before.duration_s


@pytest.mark.parametrize("seed", range(3))
def test_between_landing_and_taking_off_the_operator_steps_back_once_and_then_stands(seed):
    config = ScriptConfig()
    script = plan_session(Person.random(seed), seed, config)
    landed = next(i for i, shown in enumerate(script.shown) if shown.label == "land")
    (walk,) = [walk for walk in script.walks if walk.from_drone]
    assert walk.start_s >= script.shown[landed].end_s + config.descend_s
    assert walk.start_s + walk.duration_s + 0.5 <= script.shown[landed + 1].start_s
    clock = np.arange(walk.start_s, walk.start_s + walk.duration_s, 0.001)
    way = sum(walk.velocity(t) for t in clock) * 0.001
    np.testing.assert_allclose(way, [config.step_back_m, 0.0], atol=2e-3)
    stays = plan_session(Person.random(seed), seed, ScriptConfig(step_back_m=0.0))
    assert not any(walk.from_drone for walk in stays.walks)


def test_the_same_seed_plans_the_same_and_another_does_not():
    person = Person.random(3)
    one, again, other = (plan_session(person, seed) for seed in (5, 5, 6))
    assert one.shown == again.shown and one.walks == again.walks
    for a, b in zip(one.acts, again.acts, strict=True):
        np.testing.assert_array_equal(a.motion.table, b.motion.table)
    assert [s.label for s in one.shown] != [s.label for s in other.shown]


def test_any_choice_of_gestures_can_be_planned():
    rng = np.random.default_rng(0)
    config = ScriptConfig(commands=("up", "down"), repetitions=3, others=BACKGROUND[:2], n_others=5)
    order = shuffled_order(config, rng)
    assert Counter(order) == Counter({("up", True): 3, ("down", True): 3} | Counter(
        {(BACKGROUND[0], False): sum(n == BACKGROUND[0] for n, _ in order),
         (BACKGROUND[1], False): sum(n == BACKGROUND[1] for n, _ in order)}))  # fmt: skip
    assert sum(not is_command for _, is_command in order) == 5
    only_others = ScriptConfig(commands=(), others=BACKGROUND, n_others=4)
    assert len(plan_session(Person(), 0, only_others).shown) == 4


def test_unknown_names_are_refused():
    with pytest.raises(InputError, match=r"commands holds \['wave'\]"):
        ScriptConfig(commands=("wave",))
    with pytest.raises(InputError, match=r"others holds \['up'\]"):
        ScriptConfig(others=("up",))


def test_overlapping_acts_are_refused():
    motion = perform("up", Person())
    with pytest.raises(InputError, match="must not overlap"):
        Script((Act(1.0, motion), Act(1.5, motion)), (), (), 5.0)


def test_a_walk_covers_its_way():
    walk = Walk(2.0, 3.0, np.pi / 2, 0.6)
    clock = np.arange(1.0, 6.0, 0.001)
    way = sum(walk.velocity(t) for t in clock) * 0.001
    np.testing.assert_allclose(way, [0, 0.6 * 2.5], atol=2e-3)  # ramps of 0.5 s count half


@pytest.mark.parametrize("seed", range(3))
def test_engaging_comes_first_and_shifts_the_rest(seed):
    person = Person.random(seed)
    plain, engaged = plan_session(person, seed), plan_session(person, seed, ScriptConfig(engage=True))
    assert plain.engaged_s is None
    first = engaged.acts[0]
    assert first.motion.name == "engage" and engaged.engaged_s == first.end_s
    assert len(engaged.acts) == len(engaged.shown) + 1
    late = engaged.shown[0].start_s - plain.shown[0].start_s
    assert engaged.shown[0].start_s - engaged.engaged_s > 1.0
    for before, after in zip(plain.shown, engaged.shown, strict=True):
        assert (before.label, before.is_command) == (after.label, after.is_command)
        assert after.start_s - before.start_s == pytest.approx(late)
