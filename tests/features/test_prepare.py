"""Preparation: one rate, smoothed, cut to the movement."""

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.features import Preparation
from wigwag.skeleton import Clip


def swing(rate_hz: float, rest_s: float = 0.0, noise: float = 0.0, seed: int = 0) -> Clip:
    """Rest, one second of moving the left arm, rest."""
    times = np.arange(0, 1 + 2 * rest_s + 1e-9, 1 / rate_hz)
    phase = np.clip(times - rest_s, 0, 1)
    joints = np.zeros((len(times), 13, 3))
    joints[:, :, 1] = np.arange(13)
    joints[:, 5, 0] = np.sin(np.pi * phase)
    return Clip.at_rate(
        joints + np.random.default_rng(seed).normal(0, noise, joints.shape), rate_hz, "a", "b", "c"
    )


def test_none_leaves_the_clip_alone():
    clip = swing(30)
    assert Preparation.none().apply(clip) is clip


def test_two_cameras_of_different_rate_give_the_same_clip():
    preparation = Preparation(trim=0)
    fast, slow = (preparation.apply(swing(rate)) for rate in (60, 20))
    assert len(fast) == len(slow) == 32
    assert np.abs(fast.joints - slow.joints).max() < 0.02
    np.testing.assert_allclose(fast.stamps_ns, slow.stamps_ns, atol=2)


def test_resampling_follows_a_straight_line_exactly_through_uneven_stamps():
    stamps = np.array([0, 20, 90, 100, 300]) * 1_000_000
    clip = Clip(stamps[:, None, None] * np.ones((1, 13, 3)) * 1e-9, stamps)
    out = Preparation(rate_hz=50, smooth_s=0, trim=0, frames=None).apply(clip)
    assert len(out) == 16
    np.testing.assert_allclose(out.joints[:, 0, 0], out.times_s, atol=1e-9)


def test_smoothing_takes_noise_away():
    rough = swing(60, noise=0.02)
    settings = {"rate_hz": None, "trim": 0, "frames": None}
    smooth = Preparation(smooth_s=0.1, **settings).apply(rough).joints
    truth = Preparation(smooth_s=0.1, **settings).apply(swing(60)).joints
    assert (smooth - truth).std() < 0.5 * (rough.joints - swing(60).joints).std()


def test_trimming_cuts_rest_at_both_ends_and_keeps_the_movement():
    clip = swing(30, rest_s=1.0)
    out = Preparation(rate_hz=None, smooth_s=0, trim=0.1, frames=None).apply(clip)
    assert out.duration_s == pytest.approx(1.0, abs=0.15)
    assert out.stamps_ns[0] == pytest.approx(1e9, abs=0.1e9)
    assert out.joints[:, 5, 0].max() > 0.99
    assert (out.label, out.subject, out.name) == ("a", "b", "c")


def test_rest_is_found_under_drift_and_noise():
    rng = np.random.default_rng(0)
    clip = swing(30, rest_s=1.0)
    drift = clip.times_s[:, None, None] * np.array([0.4, 0.0, 0.3])
    shaken = Clip(
        clip.joints + drift + rng.normal(0, [0.006, 0.006, 0.015], clip.joints.shape), clip.stamps_ns
    )
    for seen in (clip, shaken):
        out = Preparation(frames=None).apply(seen)
        assert 0.7e9 < out.stamps_ns[0] < 1.2e9
        assert out.duration_s == pytest.approx(1.0, abs=0.35)


@pytest.mark.parametrize(
    "preparation", [Preparation(), Preparation(frames=None), Preparation(rate_hz=None, frames=2)]
)
@pytest.mark.parametrize("frames", [2, 3, 300])
def test_still_and_short_clips_pass(preparation, frames):
    still = Clip.at_rate(np.ones((frames, 13, 3)), 30)
    out = preparation.apply(still)
    assert len(out) >= 2
    np.testing.assert_allclose(out.joints, 1)


@pytest.mark.parametrize("setting", [{"rate_hz": 0}, {"smooth_s": -1}, {"trim": 1.0}, {"frames": 1}])
def test_names_a_wrong_setting(setting):
    with pytest.raises(InputError, match=rf"Preparation\.{next(iter(setting))} must"):
        Preparation(**setting)
