import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.sim.gestures import (
    BACKGROUND,
    COMMANDS,
    DISTRACTORS,
    FURTHER,
    PERFORMABLE,
    TABLE_HZ,
    minimum_jerk,
    perform,
)
from wigwag.sim.kinematics import pose_body, rest
from wigwag.sim.person import JOINT, TREE, Person

HANDS = [JOINT[name] for name in ("left_wrist", "right_wrist")]


def show(name: str, person: Person, seed: int = 0) -> np.ndarray:
    """Show a gesture on the spot, facing east; joints at 30 Hz."""
    channels = (rest(person) + perform(name, person, seed).table)[:: int(TABLE_HZ / 30)]
    n = len(channels)
    feet = np.zeros((n, 2, 4))
    feet[:, 0, 1], feet[:, 1, 1] = person.stance_half_m, -person.stance_half_m
    return pose_body(person, channels, np.zeros((n, 2)), np.zeros(n), feet)


def test_every_command_has_a_gesture_and_the_others_are_disjoint():
    assert set(COMMANDS) == {command.value for command in Command}
    assert len(BACKGROUND) >= 8 <= len(DISTRACTORS)
    assert not set(BACKGROUND) & set(DISTRACTORS)
    assert not set(COMMANDS) & {*BACKGROUND, *DISTRACTORS}
    assert not set(FURTHER) & {*COMMANDS, *BACKGROUND, *DISTRACTORS}


@pytest.mark.parametrize("name", PERFORMABLE)
def test_a_gesture_is_humanly_possible(name):
    for seed in range(6):
        person = Person.random(seed)
        joints = show(name, person, seed)
        seconds = len(joints) / 30
        assert 0.8 < seconds < 3.4
        for child, parent in TREE:
            length = np.linalg.norm(joints[:, child] - joints[:, parent], axis=1)
            np.testing.assert_allclose(length, length[0], rtol=0.02)
        speed = np.linalg.norm(np.diff(joints, axis=0) * 30, axis=2)[
            :, [i for i in range(20) if i not in (7, 11)]
        ]
        assert speed.max() < 8.0, "joints; the middle of the hand is left out, it is the tip of the whip"
        acceleration = np.linalg.norm(np.diff(joints, 2, axis=0) * 900, axis=2)
        assert acceleration.max() < 200
        ankles = joints[:, [JOINT["left_ankle"], JOINT["right_ankle"]], 2]
        assert (ankles.min(axis=1) < person.ankle_height_m + 0.02).all(), "one foot at least stands"
        assert joints[..., 2].min() > 0


@pytest.mark.parametrize("name", PERFORMABLE)
def test_a_gesture_begins_and_ends_hanging(name):
    table = perform(name, Person.random(2), 3).table
    np.testing.assert_allclose(table[[0, -1]], 0, atol=1e-9)
    rates = np.diff(table, axis=0) * TABLE_HZ
    assert np.abs(rates[[0, -1]]).max() < 0.05


def test_repetitions_differ_a_little_and_the_same_seed_repeats_exactly():
    person = Person.random(4)
    one, again, other = (perform("up", person, seed).table for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, again)
    n = min(len(one), len(other))
    assert 0 < np.abs(one[:n] - other[:n]).max() < 1.5
    assert perform("up", Person.random(5), 1).table.shape != one.shape


def test_quick_people_are_quicker():
    slow, quick = Person(tempo=0.75), Person(tempo=1.3)
    mean = [np.mean([perform(n, p, 1).duration_s for n in COMMANDS]) for p in (slow, quick)]
    assert mean[0] / mean[1] == pytest.approx(1.3 / 0.75, rel=0.05)


def test_left_and_right_are_the_operators_own():
    for seed in range(8):
        person = Person.random(seed)
        for name, moving, still in (("left", 0, 1), ("right", 1, 0)):
            hands = show(name, person)[:, HANDS]
            reach = np.ptp(hands, axis=0).max(axis=1)
            assert reach[moving] > 3 * reach[still]
            outward = hands[:, moving, 1] * (1 if name == "left" else -1)
            assert outward.max() > 0.35 * person.height_m


def test_up_stays_above_and_down_below_the_other():
    person = Person()
    shoulder = show("up", person)[0, JOINT["left_shoulder"], 2]
    assert show("up", person)[:, HANDS, 2].max() > shoulder + 0.3
    assert show("down", person)[:, HANDS, 2].max() < shoulder + 0.25


def test_commands_keep_the_hands_off_the_hips():
    # What passes before the hips shifts their depth, and with it the drone (it is tracked by the hips).
    for name in COMMANDS:
        for seed in range(4):
            person = Person.random(seed)
            joints = show(name, person, seed)
            hips = joints[:, [JOINT["left_hip"], JOINT["right_hip"]]].mean(axis=1, keepdims=True)
            gap = (joints[:, HANDS] - hips)[..., 1:]  # as seen from the front
            assert np.linalg.norm(gap, axis=-1).min() > 0.17, name


def test_minimum_jerk_is_smooth_at_both_ends():
    phase = np.linspace(-0.5, 1.5, 2001)
    value = minimum_jerk(phase)
    assert value[0] == 0 and value[-1] == 1 and (np.diff(value) >= 0).all()
    assert minimum_jerk(0.5) == pytest.approx(0.5)
    assert np.abs(np.diff(value, 2) / 0.001**2).max() < 6


def test_between_rows_a_performance_is_interpolated_and_zero_outside():
    shown = perform("stop", Person(), 0)
    middle = (shown.table[50] + shown.table[51]) / 2
    np.testing.assert_allclose(shown.at(50.5 / TABLE_HZ), middle)
    assert not shown.at(-0.1).any() and not shown.at(shown.duration_s + 0.1).any()


def test_an_unknown_gesture_is_named():
    with pytest.raises(InputError, match=r"no simulated gesture 'salute'.*Available"):
        perform("salute", Person())


@pytest.mark.parametrize(("name", "up"), [("engage", 1), ("disengage", 2)])
def test_who_engages_holds_one_hand_high_and_who_disengages_both(name, up):
    for seed in range(8):
        person = Person.random(seed)
        joints = show(name, person, seed)
        high = joints[:, HANDS, 2] > joints[:, [JOINT["head"]], 2] + 0.12
        assert high.sum(axis=1).max() == up
        assert (high.sum(axis=1) == up).sum() / 30 > (1.1 if up == 1 else 1.6), "held long enough"
        assert not high[0].any() and not high[-1].any()


def test_engaging_leaves_every_other_gesture_as_it_was():
    """A gesture's place among the names chooses its chance: new names must not shift the others'."""
    assert perform("up", Person.random(3), 1).duration_s == pytest.approx(2.3333, abs=0.001)
