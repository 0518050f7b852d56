"""Varied copies of clips: other bodies and tempos, and still the same movement of a possible body."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.recognise.people import GESTURES, clip
from wigwag.errors import InputError
from wigwag.features.augment import Augmentation
from wigwag.skeleton import Clip

SHOWN = clip("spread", 1, 0, rate_hz=60)
SMOOTH = Clip.at_rate(SHOWN.joints, 60, "spread", "p1", "here.mat")
STILL = Augmentation(bones=0, tilt_deg=0, warp=0, tempo=0, crop=0)
LEFT = [(1, 3), (3, 5), (7, 9), (9, 11)]
RIGHT = [(2, 4), (4, 6), (8, 10), (10, 12)]
STRONG = Augmentation(bones=0.5, tilt_deg=60, warp=3.0, tempo=1.0, crop=0.39)


def lengths(joints, bones):
    return np.stack([np.linalg.norm(joints[:, b] - joints[:, a], axis=1) for a, b in bones], axis=1)


def vary(clip: Clip, seed: int, augmentation: Augmentation | None = None) -> Clip:
    return (augmentation or Augmentation()).apply(clip, np.random.default_rng(seed))


def test_with_every_spread_at_0_nothing_changes():
    same = vary(SMOOTH, 0, STILL)
    np.testing.assert_allclose(same.joints, SMOOTH.joints, atol=1e-12)
    np.testing.assert_allclose(same.stamps_ns, SMOOTH.stamps_ns, atol=2)


def test_label_subject_and_name_stay_and_the_clip_is_left_alone():
    kept = SMOOTH.joints.copy()
    other = vary(SMOOTH, 1)
    assert (other.label, other.subject, other.name) == ("spread", "p1", "here.mat")
    np.testing.assert_array_equal(SMOOTH.joints, kept)


def test_the_seed_decides():
    np.testing.assert_array_equal(vary(SMOOTH, 3).joints, vary(SMOOTH, 3).joints)
    np.testing.assert_array_equal(vary(SMOOTH, 3).stamps_ns, vary(SMOOTH, 3).stamps_ns)
    assert len(vary(SMOOTH, 3)) != len(vary(SMOOTH, 4)) or not np.allclose(
        vary(SMOOTH, 3).joints, vary(SMOOTH, 4).joints
    )


@given(seed=st.integers(0, 10_000))
def test_bones_change_by_one_factor_over_the_clip_the_same_left_and_right(seed):
    other = vary(SMOOTH, seed, Augmentation(crop=0))
    left = lengths(other.joints, LEFT) / lengths(SMOOTH.joints, LEFT)
    right = lengths(other.joints, RIGHT) / lengths(SMOOTH.joints, RIGHT)
    np.testing.assert_allclose(left, np.broadcast_to(left[:1], left.shape), rtol=1e-9)
    np.testing.assert_allclose(right, left, rtol=1e-9)
    shoulders = lengths(other.joints, [(1, 2)]) / lengths(SMOOTH.joints, [(1, 2)])
    np.testing.assert_allclose(shoulders, shoulders.mean() + 0 * shoulders, rtol=1e-9)
    np.testing.assert_allclose(  # nobody's hips are touched, but for the turn
        lengths(other.joints, [(7, 8)]), lengths(SMOOTH.joints, [(7, 8)]), rtol=1e-9
    )


def test_bones_vary_as_much_as_was_asked_for():
    factors = np.array(
        [lengths(vary(SMOOTH, s, Augmentation(crop=0)).joints[:1], LEFT)[0] for s in range(300)]
    ) / lengths(SMOOTH.joints[:1], LEFT)
    np.testing.assert_allclose(np.log(factors).std(axis=0), 0.08, rtol=0.2)
    np.testing.assert_allclose(np.log(factors).mean(axis=0), 0, atol=0.02)


@given(seed=st.integers(0, 10_000))
def test_tilting_turns_the_whole_body_and_changes_no_distance(seed):
    other = vary(SMOOTH, seed, Augmentation(bones=0, warp=0, tempo=0, crop=0, tilt_deg=30))
    pairs = [(a, b) for a in range(13) for b in range(a)]
    np.testing.assert_allclose(lengths(other.joints, pairs), lengths(SMOOTH.joints, pairs), atol=1e-9)
    before, after = ((c.joints[0, 7] + c.joints[0, 8]) / 2 for c in (SMOOTH, other))
    np.testing.assert_allclose(after, before, atol=1e-9)
    across = other.joints[0, 1] - other.joints[0, 2]
    # A camera pitches and rolls; to turn about the vertical alone is the canonical form's affair.
    assert across[0] > 0


@pytest.mark.parametrize("augmentation", [Augmentation(), STRONG], ids=["usual", "strong"])
@given(seed=st.integers(0, 10_000))
def test_time_runs_forward_from_where_it_did(augmentation, seed):
    other = vary(SMOOTH, seed, augmentation)
    assert (np.diff(other.stamps_ns) > 0).all()  # Clip checks it too
    assert other.stamps_ns[0] >= SMOOTH.stamps_ns[0]
    assert np.isfinite(other.joints).all()


def test_the_tempo_varies_as_much_as_was_asked_for_and_so_does_its_evenness():
    longer = [vary(SMOOTH, s, Augmentation(warp=0, crop=0)).duration_s for s in range(300)]
    assert np.std(np.log(np.array(longer) / SMOOTH.duration_s)) == pytest.approx(0.1, rel=0.2)
    even = vary(SMOOTH, 0, Augmentation(warp=0, crop=0))
    assert np.ptp(np.diff(even.stamps_ns)) <= 2
    warped = np.array([np.diff(vary(SMOOTH, s, Augmentation(crop=0)).times_s) for s in range(300)])
    uneven = (warped / warped.mean(axis=1, keepdims=True)).max(axis=1) - 1
    # Two in three times the warp is below its spread; then no frame lasts longer than that share more.
    assert np.quantile(uneven, 0.68) == pytest.approx(0.15, rel=0.2)


@given(seed=st.integers(0, 10_000), crop=st.floats(0, 0.39))
def test_at_most_the_share_is_cut_off_at_each_end(seed, crop):
    marked = SMOOTH.joints.copy()
    marked[:, 0, 1] = np.arange(len(SMOOTH))  # the nose says which frame it is
    numbered = Clip(marked, SMOOTH.stamps_ns)
    other = vary(numbered, seed, Augmentation(bones=0, tilt_deg=0, warp=0, tempo=0, crop=crop))
    frames = np.round(other.joints[:, 0, 1]).astype(int)
    np.testing.assert_array_equal(np.diff(frames), 1)
    most = crop * len(SMOOTH)
    assert 0 <= frames[0] <= most
    assert len(SMOOTH) - 1 - most <= frames[-1] <= len(SMOOTH) - 1
    np.testing.assert_allclose(other.stamps_ns, SMOOTH.stamps_ns[frames], atol=2)


@pytest.mark.parametrize("frames", [2, 3, 4, 5, 9])
def test_short_clips_stay_clips(frames):
    short = Clip.at_rate(SMOOTH.joints[:frames], 60)
    for seed in range(20):
        assert 2 <= len(vary(short, seed, STRONG)) <= frames
        assert len(vary(short, seed)) >= frames - 2


@pytest.mark.parametrize("kind", GESTURES)
def test_bodies_in_one_point_stay_finite(kind):
    point = Clip.at_rate(np.ones((10, 13, 3)), 30, kind)
    np.testing.assert_allclose(vary(point, 0).joints, 1)


@pytest.mark.parametrize("name", ["bones", "tilt_deg", "warp", "tempo", "crop"])
def test_wrong_settings_are_named(name):
    with pytest.raises(InputError, match=rf"Augmentation\.{name} must be 0 or more, but got -0\.1"):
        Augmentation(**{name: -0.1})
    with pytest.raises(InputError, match=rf"Augmentation\.{name} must be 0 or more, but got nan"):
        Augmentation(**{name: float("nan")})


def test_something_of_a_clip_must_be_left():
    with pytest.raises(InputError, match=r"Augmentation\.crop must be below 0\.4, but got 0\.4"):
        Augmentation(crop=0.4)
