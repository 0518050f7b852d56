import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.sim.kinematics import CHANNEL, CHANNELS, METRES, blend, pose_body, rest
from wigwag.sim.person import JOINT, TREE, Person


def body(person: Person, heading: float = 0.0, where=(0.0, 0.0), **channels: float) -> np.ndarray:
    """Pose one body from channels in degrees and metres."""
    row = rest(person)
    for name, value in channels.items():
        row[CHANNEL[name]] = value if name in METRES else np.deg2rad(value)
    left = person.stance_half_m * np.array([-np.sin(heading), np.cos(heading)])
    feet = np.array([[[*(np.array(where) + left), 0.0, heading], [*(np.array(where) - left), 0.0, heading]]])
    return pose_body(person, row[None], np.array([where]), np.array([heading]), feet)[0]


def bones(joints: np.ndarray) -> np.ndarray:
    return np.array([np.linalg.norm(joints[..., c, :] - joints[..., p, :], axis=-1) for c, p in TREE]).T


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_bones_keep_their_lengths_in_any_pose(person_seed, pose_seed):
    person, rng = Person.random(person_seed), np.random.default_rng(pose_seed)
    angles = {name: rng.uniform(-60, 60) for name in CHANNELS if name not in METRES}
    shifts = {name: rng.uniform(-0.15, 0.15) for name in METRES}
    moved = body(person, rng.uniform(-4, 4), tuple(rng.normal(size=2)), **angles, **shifts)
    np.testing.assert_allclose(bones(moved), bones(body(person)), atol=1e-9)


def test_the_body_faces_its_heading_with_its_left_to_the_left():
    joints = body(Person(), heading=np.pi / 2)  # looking north: left is west
    assert joints[JOINT["left_shoulder"], 0] < -0.1 < 0.1 < joints[JOINT["right_shoulder"], 0]
    assert joints[JOINT["left_foot"], 1] > joints[JOINT["left_ankle"], 1] + 0.05


@pytest.mark.parametrize(("side", "sign"), [("left", 1), ("right", -1)])
def test_an_arm_points_where_its_channels_say(side, sign):
    person = Person()

    def pointing(**values: float) -> np.ndarray:
        straight = {f"{side}_bend": 0.0, f"{side}_forward": 0.0, f"{side}_roll": 0.0}
        joints = body(person, **(straight | {f"{side}_{name}": value for name, value in values.items()}))
        span = joints[JOINT[f"{side}_wrist"]] - joints[JOINT[f"{side}_elbow"]]
        return span / np.linalg.norm(span)

    np.testing.assert_allclose(pointing(**{"raise": 0}), [0, 0, -1], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 90}), [0, sign, 0], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 90, "forward": 90}), [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 180}), [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 0, "swing": 90}), [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 0, "bend": 90}), [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 0, "bend": 90, "roll": 90}), [0, -sign, 0], atol=1e-9)
    np.testing.assert_allclose(pointing(**{"raise": 90, "bend": 90, "roll": -90}), [0, 0, 1], atol=1e-9)


def test_leaning_and_squatting_go_where_they_say():
    person = Person()
    upright, head = body(person), JOINT["head"]
    assert body(person, lean_forward=30)[head, 0] > upright[head, 0] + 0.2
    assert body(person, lean_left=30)[head, 1] > upright[head, 1] + 0.2
    squat = body(person, pelvis_down=0.3)
    assert squat[JOINT["hip_center"], 2] == pytest.approx(upright[JOINT["hip_center"], 2] - 0.3)
    knees = squat[[JOINT["left_knee"], JOINT["right_knee"]], 0]
    assert (knees > 0.2).all(), "knees bend forward"
    ankles = [JOINT["left_ankle"], JOINT["right_ankle"]]
    np.testing.assert_allclose(squat[ankles], upright[ankles], atol=1e-9)


def test_a_foot_out_of_reach_is_pulled_off_the_ground_rather_than_the_leg_stretched():
    person = Person()
    raised = body(person, pelvis_down=-0.2)
    assert raised[JOINT["left_ankle"], 2] > person.ankle_height_m + 0.1
    np.testing.assert_allclose(bones(raised), bones(body(person)), atol=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 1000), st.floats(0, 1))
def test_blending_between_poses_of_one_body_keeps_its_bones(seed, weight):
    person, rng = Person.random(seed), np.random.default_rng(seed)
    first, second = (
        body(person, rng.uniform(-2, 2), left_raise=rng.uniform(0, 170), right_bend=rng.uniform(0, 140))
        for _ in range(2)
    )
    between = blend(first, second, weight)
    np.testing.assert_allclose(bones(between), bones(first), rtol=0.02)


def test_blending_begins_and_ends_exactly():
    person = Person()
    first, second = body(person), body(person, 1.0, (0.3, 0.2), left_raise=120, right_raise=40)
    np.testing.assert_allclose(blend(first, second, 0.0), first, atol=1e-12)
    np.testing.assert_allclose(blend(first, second, 1.0), second, atol=1e-12)
