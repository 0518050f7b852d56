import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.sim.gestures import perform
from wigwag.sim.passerby import Leg, Passerby, plan_way
from wigwag.sim.person import JOINT, Person
from wigwag.sim.script import Act

RATE = 30.0
DRONE = np.array([0.0, 0.0, 1.5])


def walked(walker: Passerby, seconds: float) -> np.ndarray:
    times = np.arange(1, int(seconds * RATE) + 1) / RATE
    return np.stack([walker.step(float(t), 1 / RATE, DRONE) for t in times])


def hips(joints: np.ndarray) -> np.ndarray:
    return (joints[:, JOINT["left_hip"]] + joints[:, JOINT["right_hip"]]) / 2


def facing(joints: np.ndarray) -> np.ndarray:
    across = joints[:, JOINT["left_hip"], :2] - joints[:, JOINT["right_hip"], :2]
    return np.arctan2(-across[:, 0], across[:, 1])


def test_a_way_ends_where_and_when_it_says():
    legs = [Leg((3.0, 2.0), 1.3, pause_s=1.0), Leg((4.5, 2.0), 0.9), Leg((4.5, -2.0), 1.6)]
    walker = Passerby(Person.random(3), (3.0, -2.0), legs, begin_s=0.5)
    joints = walked(walker, walker.ends_s[-1] + 0.5)
    for leg, end_s in zip(legs, walker.ends_s, strict=True):
        assert hips(joints)[round(end_s * RATE) - 1, :2] == pytest.approx(leg.to_m, abs=0.12)
    assert hips(joints)[:10, :2] == pytest.approx(np.tile((3.0, -2.0), (10, 1)), abs=0.1), (
        "not before its time"
    )


def test_a_passer_by_walks_upright_and_faces_where_they_go():
    walker = Passerby(Person.random(4), (3.0, -2.2), [Leg((3.0, 2.2), 1.4)])
    joints = walked(walker, walker.ends_s[0])
    speed = np.linalg.norm(np.diff(hips(joints)[:, :2], axis=0), axis=1) * RATE
    assert 1.25 < np.median(speed) < 1.55
    assert abs(np.angle(np.exp(1j * (facing(joints)[20:] - np.pi / 2)))).max() < 0.5
    assert np.linalg.norm(np.diff(joints, axis=0) * RATE, axis=2).max() < 8.0
    assert joints[..., 2].min() > 0


def test_who_comes_back_turns_round():
    walker = Passerby(Person.random(5), (3.0, -1.5), [Leg((3.0, 1.5), pause_s=1.5), Leg((3.0, -1.5))])
    joints = walked(walker, walker.ends_s[-1])
    assert facing(joints)[round(walker.ends_s[0] * RATE) - 5] == pytest.approx(np.pi / 2, abs=0.4)
    assert facing(joints)[-20] == pytest.approx(-np.pi / 2, abs=0.4)


def test_standing_still_they_may_look_at_the_drone_and_show_gestures():
    person = Person.random(6)
    act = Act(4.0, perform("stop", person, 1))
    walker = Passerby(person, (4.0, -2.0), [Leg((4.0, -0.8))], acts=[act], looks_at_drone=True)
    joints = walked(walker, 7.0)
    span = np.pi - np.arctan2(0.8, 4.0)
    assert abs(np.angle(np.exp(1j * (facing(joints)[-1] - span)))) < 0.3
    wrists = joints[:, [JOINT["left_wrist"], JOINT["right_wrist"]], 2].min(axis=1)
    assert wrists[: round(4.0 * RATE)].max() < 1.3
    assert wrists.max() > 1.6


def test_the_plan_takes_short_legs_slowly():
    walks, ends = plan_way((0.0, 0.0), [Leg((0.1, 0.0), 1.3)])
    assert ends == (1.0,)
    assert walks[0].speed_m_s == pytest.approx(0.2)


@pytest.mark.parametrize("changes", [{"speed_m_s": 0.0}, {"pause_s": -1.0}, {"speed_m_s": float("nan")}])
def test_a_leg_that_never_ends_is_an_error(changes):
    with pytest.raises(InputError, match="speed_m_s above 0 and pause_s of 0 or more"):
        Leg((1.0, 1.0), **changes)
