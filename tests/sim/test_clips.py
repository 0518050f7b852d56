from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.sim.clips import (
    LANDMARK_BIAS,
    TRAINING_SEED,
    SensorConfig,
    cut,
    to_camera,
    training_clips,
    training_sessions,
)
from wigwag.sim.gestures import BACKGROUND, COMMANDS, DISTRACTORS
from wigwag.sim.person import Person
from wigwag.skeleton import MIRROR, Landmark


@pytest.fixture(scope="module")
def clips():
    return training_clips(n_people=2, repetitions=1, seed=4, pieces=5)


def test_each_person_shows_every_command_and_nothing_that_is_kept_for_the_demo(clips):
    assert Counter(c.label for c in clips if c.label) == dict.fromkeys(COMMANDS, 2)
    names = {c.name.split(" of ")[0] for c in clips}
    assert names == {*COMMANDS, *BACKGROUND, "between"}
    assert not names & set(DISTRACTORS)
    subjects = {c.subject for c in clips}
    assert len(subjects) == 2
    assert all(int(s.split()[1]) >= TRAINING_SEED for s in subjects)


def test_clips_are_what_a_camera_at_30_hz_sees(clips):
    for clip in clips:
        assert np.diff(clip.stamps_ns).max() < 34e6
        assert 0.5 < clip.duration_s < 4.0
        hips = clip.joints[:, [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean(axis=1)
        assert (hips[:, 2] > 2.5).all() and (hips[:, 2] < 6.6).all(), "in front of the camera"
        assert np.abs(hips[:, 0]).max() < 1.5
        assert (clip.joints[:, Landmark.NOSE, 1] < clip.joints[:, Landmark.LEFT_HEEL, 1]).all(), "y is down"
        # Facing the camera, the person's left is at the right of the picture.
        across = clip.joints[:, Landmark.LEFT_SHOULDER, 0] - clip.joints[:, Landmark.RIGHT_SHOULDER, 0]
        assert np.median(across) > 0.15


def test_the_same_seed_gives_the_same_clips_and_another_other_people(clips):
    again = training_clips(n_people=2, repetitions=1, seed=4, pieces=5)
    assert [c.name for c in again] == [c.name for c in clips]
    np.testing.assert_array_equal(again[3].joints, clips[3].joints)
    other = training_clips(n_people=1, repetitions=1, seed=5, pieces=5)
    assert {c.subject for c in other}.isdisjoint({c.subject for c in clips})


def test_margins_vary_about_the_truth():
    session = training_sessions(n_people=1, repetitions=2, seed=0)[0]
    cuts = [c for c in cut(session, pieces=0)]
    extra = [c.duration_s - (s.end_s - s.start_s) for c, s in zip(cuts, session.shown, strict=True)]
    assert -0.35 < min(extra) < 0.0 < max(extra) < 0.65
    exact = cut(session, margin_s=(0.0, 0.0), pieces=0)
    np.testing.assert_allclose(
        [c.duration_s for c in exact], [s.end_s - s.start_s for s in session.shown], atol=0.07
    )


def test_noise_is_as_large_as_configured():
    quiet = SensorConfig(sideways_m=0.0, depth_per_m=0.0, glitch_share=0.0, session_bias_m=0.0)
    loud = replace(quiet, sideways_m=0.012, depth_per_m=0.002)
    one, two = (training_sessions(1, 1, 3, sensor=s)[0].stream.joints for s in (quiet, loud))
    error = (two - one)[:, Landmark.NOSE]
    np.testing.assert_allclose(error[:, :2].std(axis=0), 0.012, rtol=0.25)
    step = np.diff(error[:, :2], axis=0).std() / error[:, :2].std()
    assert step < 0.6, "an error across lasts"
    stereo = error[:, 2] / one[:, Landmark.NOSE, 2] ** 2
    assert stereo.std() == pytest.approx(0.002, rel=0.15)


def test_landmarks_lie_where_the_network_puts_them():
    plain = SensorConfig(sideways_m=0.0, depth_per_m=0.0, glitch_share=0.0, session_bias_m=0.0, bias=False)
    one, two = (training_sessions(1, 1, 3, sensor=replace(plain, bias=b))[0] for b in (False, True))
    off = (two.stream.joints - one.stream.joints)[0]
    height = Person.random(int(one.stream.subject.split()[1])).height_m
    np.testing.assert_allclose(off, LANDMARK_BIAS * height, atol=1e-9)


def test_the_bias_is_the_same_on_both_sides() -> None:
    np.testing.assert_array_equal(LANDMARK_BIAS[list(MIRROR)] * [-1, 1, 1], LANDMARK_BIAS)


def test_glitches_are_rare_and_touch_only_the_arms():
    plain = SensorConfig(sideways_m=0.0, depth_per_m=0.0, glitch_share=0.0, session_bias_m=0.0)
    one, two = (
        training_sessions(1, 1, 3, sensor=replace(plain, glitch_share=g))[0].stream.joints
        for g in (0.0, 0.02)
    )
    hit = (np.abs(two - one) > 1e-9).any(axis=2).mean(axis=0)
    arms = [Landmark.LEFT_ELBOW, Landmark.RIGHT_ELBOW, Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST]
    assert 0.005 < hit[arms].mean() < 0.04
    assert np.delete(hit, arms).max() == 0


def test_world_to_camera_by_hand():
    point = np.array([[[3.0, 4.0, 1.0]] * 20])
    seen = to_camera(point, np.array([[1.0, 4.0, 1.5]]), np.array([0.0]))  # looking east
    np.testing.assert_allclose(seen[0, 0], [0.0, 0.5, 2.0], atol=1e-12)
    seen = to_camera(point, np.array([[4.0, 3.0, 1.5]]), np.array([np.pi / 2]))  # looking north
    np.testing.assert_allclose(seen[0, 0], [-1.0, 0.5, 1.0], atol=1e-12)


def test_a_camera_needs_a_rate():
    with pytest.raises(InputError, match="rate_hz must be above 0"):
        SensorConfig(rate_hz=0)
