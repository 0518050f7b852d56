import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.sim.gestures import TABLE_HZ, perform
from wigwag.sim.kinematics import pose_body, rest
from wigwag.sim.motion import Operator, play
from wigwag.sim.person import JOINT, Person
from wigwag.sim.recorded import replay
from wigwag.sim.script import Act, Script, ScriptConfig, plan_replays

RATE = 18.75
RECORDED = Person.random(21)


def kinect(name: str = "right", yaw: float = 0.0, sit_m: float = 0.0) -> np.ndarray:
    """A recording as a Kinect makes it: x to the person's right, y up, z away from the camera."""
    table = perform(name, RECORDED, 1).table
    rows = np.linspace(0, len(table) - 1, int(len(table) / TABLE_HZ * RATE))
    channels = np.stack([np.interp(rows, np.arange(len(table)), column) for column in table.T], axis=1)
    channels = channels + rest(RECORDED)
    channels[:, 2] += np.linspace(sit_m, 0, len(rows))  # pelvis_down
    n, half = len(rows), RECORDED.stance_half_m
    feet = np.zeros((n, 2, 4))
    feet[:, 0, :2] = half * np.array([-np.sin(yaw), np.cos(yaw)])
    feet[:, 1, :2] = -feet[:, 0, :2]
    feet[..., 3] = yaw
    world = pose_body(RECORDED, channels, np.zeros((n, 2)), np.full(n, yaw), feet)
    return np.stack([-world[..., 1], world[..., 2], -world[..., 0]], axis=-1) + np.array([0.3, -0.9, 2.8])


def shown(motion, heading=np.pi, at=(4.0, 0.0)):
    script = Script((Act(1.0, motion),), (), (), 2.5 + motion.duration_s)
    drone = np.array([at[0] + 10 * np.cos(heading), at[1] + 10 * np.sin(heading), 1.5])
    operator = Operator(Person.like(kinect(), seed=1), script, position_m=at, heading_rad=heading)
    return play(operator, 75.0, lambda _: drone)


def relative(joints: np.ndarray) -> np.ndarray:
    return joints - joints[..., [JOINT["hip_center"]], :]


@pytest.mark.parametrize("heading", [np.pi, 0.7])
def test_a_replay_shows_what_was_recorded(heading):
    recording = kinect()
    motion = replay(recording, RATE, smooth_s=0.0)
    times, joints = shown(motion, heading)
    begin = 1.0 + motion.lead_s
    c, s = np.cos(heading), np.sin(heading)
    into_world = np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]]).T @ np.array(
        [[c, s, 0], [-s, c, 0], [0, 0, 1]]
    )
    expected = relative(recording) @ into_world
    for frame in range(len(recording) - 1):
        moment = begin + frame / RATE
        row = int(np.argmin(np.abs(times - moment)))
        np.testing.assert_allclose(times[row], moment, atol=0.007)
        np.testing.assert_allclose(relative(joints[row]), expected[frame], atol=0.06)
    exact = np.array([relative(motion.at(motion.lead_s + f / RATE)) for f in range(len(recording) - 1)])
    np.testing.assert_allclose(
        exact, relative(recording)[:-1] @ np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]]).T, atol=2e-3
    )


def test_a_right_hand_stays_a_right_hand_and_the_face_is_to_the_drone():
    motion = replay(kinect("right"), RATE)
    times, joints = shown(motion)  # facing west: the right side is north
    during = joints[(times > 1.0 + motion.lead_s) & (times < 1.0 + motion.lead_s + motion.recording_s)]
    assert during[:, JOINT["right_wrist"], 1].max() > 0.5
    assert during[:, JOINT["left_wrist"], 1].min() > -0.45
    assert (during[:, JOINT["left_foot"], 0] < during[:, JOINT["left_ankle"], 0]).all()


def test_moving_into_and_out_of_a_recording_is_smooth_and_on_the_ground():
    motion = replay(kinect(), RATE)
    times, joints = shown(motion)
    speed = np.linalg.norm(np.diff(joints, axis=0) * 75.0, axis=2)
    assert speed.max() < 8.0
    edges = (np.abs(times[1:] - 1.2) < 0.3) | (np.abs(times[1:] - (0.8 + motion.duration_s)) < 0.4)
    assert speed[edges].max() < 2.5
    assert joints[..., 2].min() > 0.0
    feet = joints[:, [JOINT["left_foot"], JOINT["right_foot"]], 2]
    assert feet.min(axis=1).max() < 0.1


def test_sitting_takes_its_time():
    recording = kinect("up", sit_m=0.4)
    motion = replay(recording, RATE)
    assert motion.blend_s[0] > 0.9 and motion.hold_s[0] > 0.5
    assert motion.blend_s[1] == 0.4 and motion.hold_s[1] == 0.0
    times, joints = shown(motion)
    hips = joints[:, JOINT["hip_center"], 2]
    down = np.abs(np.diff(hips[times < 1.0 + motion.blend_s[0]]) * 75.0).max()
    assert 0.3 < down < 0.9
    held = joints[(times > 1.02 + motion.blend_s[0]) & (times < 0.98 + motion.lead_s)]
    assert np.ptp(held, axis=0).max() < 1e-9


def test_smoothing_takes_jitter_out():
    recording = kinect()
    noisy = recording + np.random.default_rng(0).normal(0, 0.01, recording.shape)
    rough, smooth, true = (
        replay(r, RATE, smooth_s=s).joints for r, s in ((noisy, 0.0), (noisy, 0.06), (recording, 0.0))
    )
    legs = [JOINT["left_knee"], JOINT["right_knee"]]
    jitter = [np.std(np.diff((r - true)[:, legs], axis=0)) for r in (smooth, rough)]
    assert jitter[0] < 0.6 * jitter[1]


def test_a_turned_recording_stays_turned():
    motion = replay(kinect(yaw=0.5), RATE)
    across = motion.joints[0, JOINT["left_hip"]] - motion.joints[0, JOINT["right_hip"]]
    assert np.arctan2(-across[0], across[1]) == pytest.approx(0.5, abs=0.02)


def test_a_stream_of_recordings_keeps_order_labels_and_truth():
    items = [(replay(kinect(n), RATE, name=n), n, n != "wave", "s2") for n in ("up", "wave", "stop", "down")]
    script = plan_replays(items, seed=3, shuffle=False)
    assert [s.label for s in script.shown] == ["up", "wave", "stop", "down"]
    assert [s.is_command for s in script.shown] == [True, False, True, True]
    for act, truth in zip(script.acts, script.shown, strict=True):
        assert truth.start_s == pytest.approx(act.start_s + act.motion.lead_s)
        assert truth.end_s - truth.start_s == pytest.approx(act.motion.recording_s)
    assert {s.label for s in plan_replays(items, seed=4).shown} == {"up", "wave", "stop", "down"}
    still = plan_replays(items, seed=3, config=ScriptConfig(walk_share=0.0), shuffle=False)
    assert still.walks == ()


def test_standing_goes_on_where_the_recording_ends():
    recording = kinect()
    recording[..., 2] -= np.linspace(0, 0.5, len(recording))[:, None]  # half a metre towards the camera
    motion = replay(recording, RATE)
    _, joints = shown(motion)
    hips = joints[-1, JOINT["hip_center"], :2]
    np.testing.assert_allclose(hips, [3.5, 0.0], atol=0.08)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.zeros((30, 13, 3)), r"a9_s1_t1: a recording must have shape"),
        (np.zeros((1, 20, 3)), r"a9_s1_t1: a recording must have shape"),
        (np.full((30, 20, 3), np.nan), r"a9_s1_t1: joints hold NaN or infinity, first in frame 0"),
    ],
)
def test_bad_recordings_are_named(bad, message):
    with pytest.raises(InputError, match=message):
        replay(bad, name="a9_s1_t1")


def test_a_rate_must_be_positive():
    with pytest.raises(InputError, match="rate_hz must be above 0"):
        replay(kinect(), 0.0)
