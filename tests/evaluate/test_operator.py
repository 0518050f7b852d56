"""People crossing a rendered operator: real pixels, real networks, and the world's truth to judge by."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.errors import ModelError
from wigwag.evaluate.operator import Moment, following, play, summarise
from wigwag.evaluate.passers import CONDITIONS, DISTANCES_M, Condition, Staged, stage
from wigwag.pose.estimator import PoseEstimator
from wigwag.sim.gestures import perform
from wigwag.sim.motion import Operator
from wigwag.sim.paint import Look
from wigwag.sim.person import Person
from wigwag.sim.quadrotor import QuadrotorConfig
from wigwag.sim.script import Act, Script
from wigwag.sim.world import World, WorldConfig


@pytest.fixture(scope="module")
def estimator() -> PoseEstimator:
    try:
        return PoseEstimator()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


def condition(name: str) -> Condition:
    return next(c for c in CONDITIONS if c.name == name)


def test_a_passer_by_is_never_handed_on_and_the_operator_is_kept(estimator: PoseEstimator) -> None:
    staged = stage(condition("same clothes"), 4.0, 1, seed=301)
    record = summarise(staged, [moment for _, moment in play(staged, estimator)])
    assert record["engaged"]
    assert record["frames_of_passerby"] == 0
    assert record["kept"] == record["crossings"] == 1


def test_whoever_bends_towards_a_drone_is_not_before_themselves(estimator: PoseEstimator) -> None:
    person = Person.random(1)
    acts = [Act(1.0, perform("engage", person, 1))]
    acts.append(Act(acts[0].end_s + 0.5, perform("pick_up", person, [1, 1])))
    script = Script(tuple(acts), (), (), acts[1].end_s + 0.5, acts[0].end_s)
    operator = Operator(person, script, (5.4, 0.0), seed=1)
    config = WorldConfig(quadrotor=QuadrotorConfig(position_m=(0.0, 0.0, 1.3)))
    world = World(config, 1, operator, Look.from_seed(1, person.height_m))
    staged = Staged(world, condition("clutter"), 5.4, acts[0].end_s, (), script.duration_s)
    after = [m for _, m in play(staged, estimator) if m.time_s > acts[0].end_s]
    assert np.mean([m.right for m in after]) > 0.95


def moments(*rows: tuple[float, float, float, bool]) -> list[Moment]:
    return [
        Moment(time_s, np.isfinite(off), off, others, visible, 10.0) for time_s, off, others, visible in rows
    ]


def test_one_frame_of_somebody_else_spoils_a_crossing() -> None:
    staged = stage(condition("clutter"), 4.0, 1, seed=3)
    begin, end = staged.windows[0]
    good = [
        (begin + 0.1, 0.02, 1.0, True),
        (begin + 0.5, np.inf, np.inf, False),
        (end + 0.1, 0.02, 2.0, True),
    ]
    record = summarise(staged, moments(*good))
    assert (record["kept"], record["frames_of_passerby"]) == (1, 0)
    assert record["reacquired_s_median"] == pytest.approx(0.0, abs=1e-3)
    bad = [good[0], (begin + 0.5, 1.0, 0.1, False), good[2]]
    record = summarise(staged, moments(*bad))
    assert (record["kept"], record["frames_of_passerby"]) == (0, 1)


@pytest.mark.parametrize("distance_m", DISTANCES_M)
def test_a_drone_can_follow_at_every_distance_that_is_measured(distance_m: float) -> None:
    config = following(distance_m)
    assert config.goal.distance_m == distance_m < config.supervisor.max_distance_m
