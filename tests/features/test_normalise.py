"""Normalisation: what a person's place, size and heading must not change."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.features import Normalisation
from wigwag.features.normalise import UP
from wigwag.skeleton import Clip, Landmark, mirrored

STANDING = np.array(
    [
        [0.0, -0.65, 3.0], [0.18, -0.45, 3.0], [-0.18, -0.45, 3.0], [0.22, -0.18, 3.0], [-0.22, -0.18, 3.0],
        [0.24, 0.06, 2.98], [-0.24, 0.06, 2.98], [0.1, 0.05, 3.0], [-0.1, 0.05, 3.0], [0.11, 0.45, 3.0],
        [-0.11, 0.45, 3.0], [0.12, 0.85, 3.05], [-0.12, 0.85, 3.05],
    ]
)  # fmt: skip
ALL = [
    Normalisation.paper(),
    Normalisation.paper(upright=True),
    Normalisation(),
    Normalisation(origin="start", size="torso", size_over="clip", upright="clip"),
]


def moving(seed: int = 0, frames: int = 25) -> Clip:
    rng = np.random.default_rng(seed)
    steps = rng.normal(0, 0.02, (frames, 13, 3)).cumsum(axis=0)
    return Clip.at_rate(STANDING + steps, 25, "wave", "ann", "here.mat")


def turned(clip: Clip, degrees: float) -> Clip:
    angle = np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return Clip(clip.joints @ turn.T, clip.stamps_ns)


@pytest.mark.parametrize("normalisation", ALL)
@given(
    seed=st.integers(0, 1000),
    shift=st.lists(st.floats(-20, 20), min_size=3, max_size=3),
    growth=st.floats(0.5, 2.0),
)
@settings(max_examples=15, deadline=None)
def test_stepping_aside_and_growing_change_nothing(normalisation, seed, shift, growth):
    clip = moving(seed)
    other = Clip(growth * clip.joints + np.array(shift), clip.stamps_ns)
    np.testing.assert_allclose(
        normalisation.apply(other).joints, normalisation.apply(clip).joints, rtol=0, atol=1e-9
    )


@given(seed=st.integers(0, 1000), degrees=st.floats(-180, 180))
@settings(max_examples=15, deadline=None)
def test_turning_changes_nothing_when_facing_the_camera_is_on(seed, degrees):
    normalisation = Normalisation(face_camera=True)
    clip = moving(seed)
    np.testing.assert_allclose(
        normalisation.apply(turned(clip, degrees)).joints, normalisation.apply(clip).joints, atol=1e-9
    )
    # The law says something: without it, turning does show.
    off = Normalisation(face_camera=False)
    if abs(degrees) > 1:
        assert np.abs(off.apply(turned(clip, degrees)).joints - off.apply(clip).joints).max() > 1e-3


@pytest.mark.parametrize("normalisation", ALL)
def test_commutes_with_the_mirror(normalisation):
    clip = moving(3)
    np.testing.assert_allclose(
        normalisation.apply(mirrored(clip)).joints, mirrored(normalisation.apply(clip)).joints, atol=1e-9
    )


def test_the_papers_three_stages():
    clip = moving(4)
    joints = Normalisation.paper(upright=True).apply(clip).joints
    hips = (joints[:, Landmark.LEFT_HIP] + joints[:, Landmark.RIGHT_HIP]) / 2
    shoulders = (joints[:, Landmark.LEFT_SHOULDER] + joints[:, Landmark.RIGHT_SHOULDER]) / 2
    np.testing.assert_allclose(hips, 0, atol=1e-12)
    np.testing.assert_allclose(
        shoulders / np.linalg.norm(shoulders, axis=1, keepdims=True), UP + 0 * shoulders, atol=1e-9
    )
    size = np.maximum(2.5 * np.linalg.norm(shoulders, axis=1), np.linalg.norm(joints, axis=2).max(axis=1))
    np.testing.assert_allclose(size, 1, atol=1e-9)


def test_start_keeps_walking_and_drift_keeps_only_sitting_down():
    sink_and_walk = np.linspace(0, 0.4, 25)[:, None, None] * np.array([1.0, 1.0, 0.0])
    clip = Clip.at_rate(STANDING + sink_and_walk, 25)

    def travel(origin):
        joints = Normalisation(origin=origin, size="torso").apply(clip).joints
        hips = (joints[:, Landmark.LEFT_HIP] + joints[:, Landmark.RIGHT_HIP]) / 2
        return np.abs(hips[-1] - hips[0])

    assert travel("hips") == pytest.approx([0, 0, 0], abs=1e-12)
    assert travel("drift")[0] == pytest.approx(0, abs=1e-12)
    assert travel("drift")[1] > 0.2
    assert (travel("start")[:2] > 0.2).all()


def test_size_by_the_arms_does_not_see_where_the_hips_are():
    lower = STANDING.copy()
    lower[[Landmark.LEFT_HIP, Landmark.RIGHT_HIP], 1] += 0.085
    sizes = {}
    for size in ("arms", "torso"):
        wide = [
            np.ptp(Normalisation(size=size).apply(Clip.at_rate(np.stack([j] * 5), 30)).joints[0, 1:3, 0])
            for j in (STANDING, lower)
        ]
        sizes[size] = abs(wide[1] / wide[0] - 1)
    assert sizes["arms"] < 1e-9
    assert sizes["torso"] > 0.05


@pytest.mark.parametrize("normalisation", ALL)
@pytest.mark.parametrize("frames", [2, 30])
def test_bodies_without_extent_stay_finite(normalisation, frames):
    assert np.isfinite(normalisation.apply(Clip.at_rate(np.ones((frames, 13, 3)), 30)).joints).all()
    upside_down = np.stack([STANDING * [1, -1, 1]] * frames)
    assert np.isfinite(normalisation.apply(Clip.at_rate(upside_down, 30)).joints).all()


def test_an_upside_down_body_is_stood_up():
    clip = Clip.at_rate(np.stack([STANDING * [1, -1, 1]] * 3), 30)
    joints = Normalisation.paper(upright=True).apply(clip).joints
    assert joints[0, Landmark.NOSE, 1] < joints[0, Landmark.LEFT_HIP, 1]


def test_keeps_label_subject_and_name():
    clip = Normalisation().apply(moving())
    assert (clip.label, clip.subject, clip.name) == ("wave", "ann", "here.mat")


@pytest.mark.parametrize(
    "setting", [{"origin": "feet"}, {"size": "big"}, {"upright": "yes"}, {"torso_multiplier": 0}]
)
def test_names_a_wrong_setting(setting):
    with pytest.raises(InputError, match=rf"Normalisation\.{next(iter(setting))} must"):
        Normalisation(**setting)
