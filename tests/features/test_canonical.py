"""The canonical form: the same as preparation and normalisation, and what must not change it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.recognise.people import GESTURES, STANDING, clip
from wigwag.errors import InputError
from wigwag.features import Normalisation, Preparation
from wigwag.features.canonical import Canonical, CanonicalForm, _canonical
from wigwag.skeleton import Clip, mirrored

ORIGINS = ("start", "drift")


def wandering(seed: int) -> Clip:
    """A body whose landmarks wander between uneven stamps: nothing about it is tidy."""
    rng = np.random.default_rng(seed)
    frames = int(rng.integers(12, 90))
    steps = rng.normal(0, 0.02, (frames, 13, 3)).cumsum(axis=0)
    stamps = np.cumsum(rng.integers(15_000_000, 60_000_000, frames))
    return Clip(rng.uniform(0.5, 2) * (STANDING + steps), stamps, name=f"wandering{seed}")


def at_rate(seed: int, rate_hz: float, *, rest_s: float = 0.5) -> Clip:
    """A smooth movement with rest on both sides, as a camera of some rate would see it."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(0, 0.3, (13, 3)) * (np.arange(13) < 7)[:, None]
    times = np.arange(0, 1.6 + 2 * rest_s, 1 / rate_hz)
    phase = np.clip((times - rest_s) / 1.6, 0, 1)
    joints = STANDING + (np.sin(np.pi * phase) ** 2)[:, None, None] * ways
    joints = joints + (phase * np.sin(2 * np.pi * phase))[:, None, None] * ways[:, ::-1]
    return Clip.at_rate(joints, rate_hz)


def close(a: Canonical, b: Canonical, atol: float = 2e-5) -> None:
    np.testing.assert_allclose(a.joints, b.joints, atol=atol)
    np.testing.assert_allclose(a.trunk, b.trunk, atol=atol)
    assert a.duration_s == pytest.approx(b.duration_s, abs=atol)


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize("trim", [0.0, 0.15])
@given(seed=st.integers(0, 100_000))
def test_is_what_preparation_and_normalisation_do(origin, trim, seed):
    prepared = Preparation(rate_hz=30, smooth_s=0.107, trim=trim, frames=24).apply(wandering(seed))
    normal = Normalisation(origin=origin, size="arms", size_over="clip").apply(prepared)
    found = CanonicalForm(trim=trim, origin=origin).apply(wandering(seed))
    # 'arms' is four mean bones there, and an upper arm with its forearm, two of them, here.
    np.testing.assert_allclose(found.joints, 2 * normal.joints, atol=1e-5 * np.abs(normal.joints).max())
    assert found.duration_s == pytest.approx(prepared.duration_s, abs=1e-7)


def test_says_its_shapes_and_types():
    found = CanonicalForm(frames=17).apply(wandering(1))
    assert (found.joints.shape, found.joints.dtype) == ((17, 13, 3), np.float32)
    assert (found.trunk.shape, found.trunk.dtype) == ((17, 2, 3), np.float32)
    assert isinstance(found.duration_s, float)


@pytest.mark.parametrize("origin", ORIGINS)
@given(
    seed=st.integers(0, 1000),
    shift=st.lists(st.floats(-10, 10), min_size=3, max_size=3),
    growth=st.floats(0.5, 2.0),
    degrees=st.floats(-180, 180),
)
def test_stepping_aside_growing_and_turning_change_nothing(origin, seed, shift, growth, degrees):
    form, angle = CanonicalForm(origin=origin), np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    before = at_rate(seed, 30)
    other = Clip(growth * before.joints @ turn.T + np.array(shift), before.stamps_ns)
    close(form.apply(other), form.apply(before), 1e-4)


def test_tilting_does_change_it():
    """The law above says something: what is not about the vertical stays visible."""
    before, angle = at_rate(3, 30), np.deg2rad(20)
    tilt = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    other = CanonicalForm().apply(Clip(before.joints @ tilt.T, before.stamps_ns))
    assert np.abs(other.joints - CanonicalForm().apply(before).joints).max() > 0.1


def test_the_unit_is_an_arm_and_the_person_faces_the_camera():
    found = CanonicalForm().apply(Clip.at_rate(np.stack([STANDING] * 40), 20))
    body = found.joints.astype(float)
    arms = [np.linalg.norm(body[:, b] - body[:, a], axis=1) for a, b in ((1, 3), (3, 5), (2, 4), (4, 6))]
    np.testing.assert_allclose(np.sum(arms, axis=0) / 2, 1, atol=1e-6)
    np.testing.assert_allclose((body[:, 7] + body[:, 8]) / 2, 0, atol=1e-6)
    assert (body[:, 1, 0] > body[:, 2, 0]).all()  # the left shoulder is at the camera's right
    np.testing.assert_allclose(found.trunk[:, 1], (body[:, 1] + body[:, 2]) / 2, atol=1e-6)


def test_start_keeps_walking_and_drift_takes_it_out_but_not_sitting_down():
    going = np.linspace(0, 0.5, 60)[:, None, None] * np.array([1.0, 0.8, 0.5])
    walk = Clip.at_rate(STANDING + going, 30)
    travelled = {}
    for origin in ORIGINS:
        hips = CanonicalForm(origin=origin, trim=0).apply(walk).trunk[:, 0]
        travelled[origin] = np.abs(hips[-1] - hips[0])
    assert (travelled["start"] > 0.3).all()
    # The trunk is smoothed less than the landmarks it is centred by: at its ends, not quite 0 is left.
    assert travelled["drift"][1] > 0.3
    assert (travelled["drift"][[0, 2]] < 0.1 * travelled["start"][[0, 2]]).all()


@pytest.mark.parametrize("seed", range(4))
def test_cameras_of_any_rate_see_nearly_the_same(seed):
    form = CanonicalForm()
    slow, usual, fast = (form.apply(at_rate(seed, rate)) for rate in (18, 30, 60))

    def apart(a: Canonical, b: Canonical) -> float:
        return float(np.sqrt(np.mean((a.joints - b.joints) ** 2)))

    movement = float(usual.joints.std(axis=0).max())
    assert apart(fast, usual) < 0.04 * movement
    assert apart(slow, usual) < 0.06 * movement
    assert apart(form.apply(at_rate(seed + 1, 30)), usual) > 0.5 * movement  # another one is far away
    assert slow.duration_s == pytest.approx(usual.duration_s, abs=0.12)
    assert fast.duration_s == pytest.approx(usual.duration_s, abs=0.05)


@pytest.mark.parametrize("seed", range(3))
def test_rest_around_the_movement_is_cut_off(seed):
    form = CanonicalForm()
    short, long = form.apply(at_rate(seed, 30, rest_s=0.5)), form.apply(at_rate(seed, 30, rest_s=2.0))
    assert short.duration_s == pytest.approx(long.duration_s, abs=0.07)
    assert np.abs(short.joints - long.joints).max() < 0.05
    whole = CanonicalForm(trim=0).apply(at_rate(seed, 30, rest_s=2.0))
    assert whole.duration_s > long.duration_s + 3


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize("kind", GESTURES)
def test_commutes_with_the_mirror(origin, kind):
    form, shown = CanonicalForm(origin=origin), clip(kind, 1, 0)
    plain = form.apply(shown)
    swapped = mirrored(Clip.at_rate(plain.joints, 30)).joints
    np.testing.assert_allclose(form.apply(mirrored(shown)).joints, swapped, atol=2e-5)


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize(
    "joints",
    [
        np.stack([STANDING, STANDING + 0.1]),
        np.stack([STANDING] * 30),
        np.zeros((2, 13, 3)),
        np.ones((40, 13, 3)),
        np.arange(20)[:, None, None] * np.ones((20, 13, 3)),
        1e6 + np.stack([STANDING] * 20),
    ],
    ids=["two frames", "motionless", "two frames in one point", "one point", "moving point", "far away"],
)
@pytest.mark.parametrize("rate_hz", [1, 30, 1000])
def test_odd_clips_stay_finite(origin, joints, rate_hz):
    found = CanonicalForm(origin=origin).apply(Clip.at_rate(joints, rate_hz))
    assert np.isfinite(found.joints).all() and np.isfinite(found.trunk).all()
    assert found.duration_s > 0


def test_takes_single_precision_and_views_and_leaves_them_alone():
    joints = np.repeat(wandering(2).joints.astype(np.float32), 2, axis=0)[::2]
    kept = joints.copy()
    found = CanonicalForm().apply(Clip.at_rate(joints, 30))
    np.testing.assert_array_equal(joints, kept)
    close(found, CanonicalForm().apply(Clip.at_rate(kept.astype(np.float64), 30)))


def test_whole_numbers_for_settings_compile_nothing_anew():
    """Bug: ``trim=0`` instead of ``0.0`` cost fifteen seconds."""
    CanonicalForm().apply(wandering(0))
    before = len(_canonical.signatures)
    CanonicalForm(rate_hz=30, smooth_s=1, fine_smooth_s=1, trim=0).apply(wandering(0))
    assert len(_canonical.signatures) == before


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ({"rate_hz": 0}, "CanonicalForm.rate_hz must be positive, but got 0"),
        ({"rate_hz": float("nan")}, "CanonicalForm.rate_hz must be positive"),
        ({"smooth_s": -1}, "CanonicalForm.smooth_s must be positive, but got -1"),
        ({"fine_smooth_s": 0}, "CanonicalForm.fine_smooth_s must be positive"),
        ({"trim": 1.0}, "CanonicalForm.trim must be within 0 and 1, but got 1.0"),
        ({"trim": -0.1}, "CanonicalForm.trim must be within 0 and 1"),
        ({"frames": 3}, "CanonicalForm.frames must be at least 4, but got 3"),
        ({"origin": "hips"}, "CanonicalForm.origin must be 'start' or 'drift', but got 'hips'"),
    ],
)
def test_wrong_settings_are_named(setting, said):
    with pytest.raises(InputError, match=said):
        CanonicalForm(**setting)
