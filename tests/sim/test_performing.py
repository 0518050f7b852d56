"""Somebody who shows one gesture again and again, and their camera."""

from itertools import pairwise

import pytest

from wigwag.cameras import open_camera, parse_camera, simulated
from wigwag.errors import InputError
from wigwag.sim.gestures import FURTHER
from wigwag.sim.performing import LEAD_IN_S, PerformingConfig, plan_performances
from wigwag.sim.person import Person


def test_showings_follow_each_other_with_rests_and_differ():
    script = plan_performances(Person.random(3), ["goalpost", "crane"], 5, PerformingConfig(3, 4.0))
    assert [shown.label for shown in script.shown] == ["goalpost", "crane"] * 3
    assert script.shown[0].start_s == LEAD_IN_S
    for before, after in pairwise(script.shown):
        assert after.start_s - before.end_s == pytest.approx(4.0)
    tables = [act.motion.table for act in script.acts if act.motion.name == "crane"]
    rows = min(map(len, tables))
    assert abs(tables[0][:rows] - tables[1][:rows]).max() > 0.01


def test_who_engages_first_has_time_for_it():
    script = plan_performances(Person.random(3), ["hug"], 5, PerformingConfig(1, engage=True))
    assert script.engaged_s is not None
    assert script.shown[0].start_s - script.engaged_s > 5


def test_only_some_may_be_commands():
    script = plan_performances(Person.random(3), ["hug", "clap"], commands=["hug"])
    assert [shown.is_command for shown in script.shown[:2]] == [True, False]


@pytest.mark.parametrize("gestures", [[], ["hug", "somersault"]])
def test_what_nobody_can_show_is_named_with_what_they_can(gestures):
    with pytest.raises(InputError, match=r"A simulated operator shows: take_off, .*goalpost"):
        plan_performances(Person.random(3), gestures)


@pytest.mark.parametrize("settings", [{"times": 0}, {"pause_s": 0.5}, {"pause_s": float("nan")}])
def test_no_showings_and_no_rests_are_refused(settings):
    with pytest.raises(InputError, match="PerformingConfig needs"):
        PerformingConfig(**settings)


def test_an_address_says_who_performs_what():
    config = simulated(parse_camera("sim:?perform=goalpost,hug&person=7&times=2&pause_s=3"))
    assert config.perform == ("goalpost", "hug")
    assert (config.operator, config.engage) == (Person.random(7), False)
    assert [shown.label for shown in config.script().shown] == ["goalpost", "hug"] * 2
    assert config.address == "sim:?seed=1&person=7&perform=goalpost,hug"
    assert simulated(parse_camera("sim:?perform=hug&engage=1")).engage
    assert set(FURTHER) >= {"goalpost", "hug"}


def test_a_camera_of_what_nobody_can_show_is_refused():
    with pytest.raises(InputError, match="no somersault"):
        open_camera("sim:?perform=somersault").latest()


def test_different_people_look_different():
    pictures = []
    for person in (1, 2):
        with open_camera(f"sim:?perform=hug&person={person}&noise=0") as camera:
            pictures.append(next(iter(camera)).rgb)
    assert (pictures[0] != pictures[1]).any()


@pytest.mark.parametrize(("tripod", "still"), [(1, True), (0, False)])
def test_a_camera_on_a_tripod_stands_still_and_a_drones_does_not(tripod, still):
    with open_camera(f"sim:?perform=hug&noise=0&tripod={tripod}&duration_s=1") as camera:
        depths = [frame.depth_mm[-40:] for frame in camera]
    assert all((depth == depths[0]).all() for depth in depths) == still
