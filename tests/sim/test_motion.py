import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.sim.gestures import perform
from wigwag.sim.motion import Operator, play
from wigwag.sim.person import JOINT, TREE, Person
from wigwag.sim.script import Act, Script, Walk, plan_session

RATE = 30.0
DRONE = np.array([0.0, 0.0, 1.5])


def heading_of(joints: np.ndarray) -> np.ndarray:
    """Where the hips face, radians anticlockwise from east."""
    across = joints[..., JOINT["left_hip"], :2] - joints[..., JOINT["right_hip"], :2]
    return np.arctan2(-across[..., 0], across[..., 1])


@pytest.mark.parametrize("seed", range(4))
def test_a_whole_session_is_smooth_and_human(seed):
    person = Person.random(seed)
    times, joints = play(Operator(person, plan_session(person, seed), seed=seed), RATE)
    assert len(times) == len(joints) and np.isfinite(joints).all()
    speed = np.linalg.norm(np.diff(joints, axis=0) * RATE, axis=2)
    tips = [JOINT["left_hand"], JOINT["right_hand"]]
    assert np.delete(speed, tips, axis=1).max() < 8.0
    assert speed.max() < 11.0
    acceleration = np.linalg.norm(np.diff(joints, 2, axis=0) * RATE**2, axis=2)
    assert acceleration.max() < 220
    trunk = [JOINT[name] for name in ("hip_center", "spine", "shoulder_center")]
    assert acceleration[:, trunk].max() < 20
    for child, parent in TREE:
        length = np.linalg.norm(joints[:, child] - joints[:, parent], axis=1)
        np.testing.assert_allclose(length, length[0], rtol=0.02)
    ankles = joints[:, [JOINT["left_ankle"], JOINT["right_ankle"]], 2]
    assert ankles.min() > 0.6 * person.ankle_height_m
    assert (ankles.min(axis=1) < person.ankle_height_m + 0.04).all()
    assert joints[..., 2].min() > 0


@pytest.mark.parametrize("seed", range(3))
def test_the_trunk_goes_no_faster_than_walking(seed):
    person = Person.random(seed)
    script = plan_session(person, seed)
    times, joints = play(Operator(person, script), RATE)
    speed = np.linalg.norm(np.diff(joints[:, JOINT["hip_center"], :2], axis=0) * RATE, axis=1)
    busy = np.zeros(len(times), bool)
    for act in script.acts:
        busy |= (times > act.start_s) & (times < act.end_s)
    assert speed[~busy[1:]].max() <= 0.75 + 0.05, "walking and a little sway"


def test_the_same_seed_lives_the_same_and_another_does_not():
    person = Person.random(8)
    script = plan_session(person, 1)
    one, again, other = (play(Operator(person, script, seed=s))[1] for s in (2, 2, 3))
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 0.005


def test_stepping_gives_what_playing_gives():
    person = Person.random(8)
    script = plan_session(person, 1)
    times, played = play(Operator(person, script), RATE, lambda t: np.array([0.1 * t, 0.0, 1.5]))
    operator = Operator(person, script)
    for i, t in enumerate(times[:200]):
        np.testing.assert_allclose(
            operator.step(t, 1 / RATE, np.array([0.1 * t, 0, 1.5])), played[i], atol=1e-9
        )


def test_the_rate_does_not_change_the_way():
    person = Person.random(8)
    script = plan_session(person, 1)
    ends = [play(Operator(person, script), rate)[1][-1, JOINT["hip_center"]] for rate in (30.0, 50.0)]
    np.testing.assert_allclose(*ends, atol=0.05)


def test_the_operator_turns_to_face_the_drone_smoothly():
    operator = Operator(Person(), Script((), (), (), 20.0), position_m=(4.0, 0.0), heading_rad=np.pi)
    joints = []
    for i in range(1, 400):
        drone = DRONE if i < 60 else np.array([4.0, 4.0, 1.5])  # a quarter turn to the operator's right
        joints.append(operator.step(i / RATE, 1 / RATE, drone))
    heading = np.unwrap(heading_of(np.array(joints)))
    assert np.abs(heading[:60] - np.pi).max() < 0.06
    assert heading[-1] == pytest.approx(np.pi / 2, abs=0.06)
    assert np.abs(np.diff(heading) * RATE).max() < 2.5


def test_a_drone_overhead_turns_nobody():
    operator = Operator(Person(), Script((), (), (), 20.0), position_m=(4.0, 0.0), heading_rad=1.0)
    for i in range(1, 60):
        joints = operator.step(i / RATE, 1 / RATE, np.array([4.0 + 0.1 * (-1) ** i, 0.0, 5.0]))
    assert heading_of(joints) == pytest.approx(1.0, abs=0.06)


def test_walking_swings_arms_against_legs():
    walk = Walk(0.5, 6.0, np.pi, 0.7)  # straight towards the drone
    _, joints = play(Operator(Person(), Script((), (walk,), (), 7.0), position_m=(9.0, 0.0)), RATE)
    ahead = -joints[60:180, :, 0]
    feet = ahead[:, JOINT["left_ankle"]] - ahead[:, JOINT["right_ankle"]]
    hands = ahead[:, JOINT["left_wrist"]] - ahead[:, JOINT["right_wrist"]]
    assert np.ptp(feet) > 0.5 and np.ptp(hands) > 0.15
    assert np.corrcoef(feet, hands)[0, 1] < -0.8


def test_an_operator_at_rest_is_never_quite_still():
    _, joints = play(Operator(Person(), Script((), (), (), 10.0)), RATE)
    speed = np.linalg.norm(np.diff(joints, axis=0) * RATE, axis=2)
    assert 0.002 < speed[:, JOINT["head"]].mean() < 0.05
    assert speed.max() < 0.25, "and never moves enough to be taken for a gesture"


def test_an_act_is_seen_when_the_script_says():
    motion = perform("take_off", Person(), 1)
    script = Script((Act(2.0, motion),), (), (), 6.0)
    times, joints = play(Operator(Person(), script), RATE)
    speed = np.linalg.norm(np.diff(joints[:, JOINT["right_wrist"]], axis=0) * RATE, axis=1)
    moving = times[1:][speed > 0.4]
    assert 2.0 <= moving[0] < 2.25
    assert 2.0 + motion.duration_s - 0.25 < moving[-1] <= 2.0 + motion.duration_s + 0.05


def test_time_must_run_forward():
    operator = Operator(Person(), Script((), (), (), 5.0))
    operator.step(0.1, 0.1, DRONE)
    with pytest.raises(InputError, match=r"time to run forward.*t_s=0\.1"):
        operator.step(0.1, 0.1, DRONE)
    with pytest.raises(InputError, match="dt_s=0"):
        operator.step(0.2, 0.0, DRONE)


@pytest.mark.parametrize("drone_xy", [(0.0, 0.0), (5.0, 3.0), (-2.0, 4.0)])
def test_stepping_back_leads_straight_away_from_wherever_the_drone_is(drone_xy):
    walk = Walk(1.0, 2.5, 0.0, 0.6, from_drone=True)
    operator = Operator(Person(), Script((), (walk,), (), 5.0), position_m=(4.0, 1.0))
    drone = np.array([*drone_xy, 0.0])
    hips = [operator.step(k / RATE, 1 / RATE, drone)[JOINT["hip_center"], :2] for k in range(1, 150)]
    before, after = np.mean(hips[:25], axis=0), np.mean(hips[-25:], axis=0)
    away = (before - drone[:2]) / np.linalg.norm(before - drone[:2])
    np.testing.assert_allclose(after - before, 0.6 * 2.0 * away, atol=0.05)  # ramps of 0.5 s count half


def test_the_operator_may_face_past_the_drone_from_the_first_or_later():
    person, quiet = Person.random(2), Script((), (), (), 6.0)
    for turned, turns_s in ((np.radians(60.0), 0.0), (np.radians(-45.0), 3.0)):
        operator = Operator(person, quiet, position_m=(4.0, 0.0), turned_rad=turned, turns_s=turns_s)
        _, joints = play(operator, RATE)
        facing = np.angle(np.exp(1j * (heading_of(joints) - np.pi)))
        first = turned if turns_s == 0 else 0.0
        assert facing[10:80] == pytest.approx(first, abs=0.12)
        assert facing[-10:] == pytest.approx(turned, abs=0.12)
