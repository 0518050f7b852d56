import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.sim.kinematics import pose_body, rest
from wigwag.sim.person import JOINT, TREE, Person


def standing(person: Person) -> np.ndarray:
    feet = np.zeros((1, 2, 4))
    feet[0, :, 1] = person.stance_half_m, -person.stance_half_m
    return pose_body(person, rest(person)[None], np.zeros((1, 2)), np.zeros(1), feet)[0]


@given(st.integers(0, 2**31))
def test_a_random_person_is_of_human_size(seed):
    person = Person.random(seed)
    assert 1.55 <= person.height_m <= 1.95
    assert 0.75 <= person.tempo <= 1.3
    joints = standing(person)
    head_top = joints[JOINT["head"], 2] + 0.065 * person.height_m
    assert head_top == pytest.approx(person.height_m, rel=0.02)  # knees are never quite straight
    span = np.linalg.norm(joints[JOINT["left_shoulder"]] - joints[JOINT["left_hand"]])
    assert 0.28 < span / person.height_m < 0.42
    assert joints[JOINT["left_hand"], 2] > 0.3 * person.height_m


def test_the_same_seed_gives_the_same_person_and_others_differ():
    people = [Person.random(seed) for seed in range(50)]
    assert people == [Person.random(seed) for seed in range(50)]
    assert len({person.height_m for person in people}) == 50
    assert {person.handedness for person in people} == {"left", "right"}


def test_the_tree_holds_every_joint_once_and_parents_first():
    children = [child for child, _ in TREE]
    assert sorted([*children, JOINT["hip_center"]]) == list(range(20))
    placed = {JOINT["hip_center"]}
    for child, parent in TREE:
        assert parent in placed
        placed.add(child)


def test_limbs_are_measured_back_from_a_skeleton():
    person = Person.random(11)
    joints = standing(person)
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    measured = Person.like(np.stack([joints @ turn + 1.0] * 4), seed=3)
    for name in ("spine_m", "chest_m", "upper_arm_m", "forearm_m", "hand_m", "thigh_m", "shin_m", "foot_m"):
        assert getattr(measured, name) == pytest.approx(getattr(person, name), abs=1e-9), name
    assert measured.shoulder_half_m == pytest.approx(person.shoulder_half_m, rel=0.01)
    assert measured.hip_half_m == pytest.approx(person.hip_half_m, rel=0.01)
    assert measured.height_m == pytest.approx(person.height_m, rel=0.03)
    assert measured.seed == 3


@pytest.mark.parametrize("shape", [(20, 3), (0, 20, 3), (5, 13, 3)])
def test_a_skeleton_of_the_wrong_shape_is_refused(shape):
    with pytest.raises(InputError, match=r"must have shape \(frames, 20, 3\)"):
        Person.like(np.ones(shape))


def test_impossible_people_are_refused():
    with pytest.raises(InputError, match=r"Person\.thigh_m must be a length above 0 m"):
        dataclasses.replace(Person(), thigh_m=0.0)
    with pytest.raises(InputError, match=r"Person\.tempo"):
        Person(tempo=0.0)
