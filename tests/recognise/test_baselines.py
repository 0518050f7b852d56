"""The baselines on a few synthetic people, and each one's own idea against a plain computation of it."""

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.base import clone

from tests.recognise.people import GESTURES, clip, clips
from wigwag.distances import dtw
from wigwag.errors import InputError, MissingExtraError, NotFittedError
from wigwag.recognise.baselines import (
    AeonDtwRecognizer,
    CelebiRecognizer,
    ClassicalRecognizer,
    MultiRocketRecognizer,
    RwigemaRecognizer,
    SchneiderRecognizer,
)
from wigwag.recognise.baselines.warp import dtw_each, dtw_weighted
from wigwag.skeleton import Clip, Landmark

MADE = {
    "classical": ClassicalRecognizer(),
    "schneider": SchneiderRecognizer(),
    "celebi": CelebiRecognizer(examples=2),
    "rwigema": RwigemaRecognizer(generations=5, population=3),
}
TRAIN, TEST = clips(GESTURES, (1, 2, 3)), clips(GESTURES, (4, 5), takes=1)


@pytest.fixture(params=MADE)
def baseline(request: pytest.FixtureRequest):
    return clone(MADE[request.param]).fit(TRAIN)


def bare(one: Clip) -> Clip:
    return Clip(one.joints, one.stamps_ns)


def test_people_never_seen_are_recognised(baseline) -> None:
    predicted = baseline.predict([bare(one) for one in TEST])
    assert predicted.tolist() == [one.label for one in TEST]
    assert baseline.classes_.tolist() == sorted(GESTURES)


def test_training_clips_are_their_own_nearest(baseline) -> None:
    assert baseline.score(TRAIN, [one.label for one in TRAIN]) == 1.0


def test_where_a_person_stands_and_how_large_they_are_does_not_matter(baseline) -> None:
    one = TEST[0]
    moved = Clip(one.joints * 1.3 + [0.4, -0.2, 1.0], one.stamps_ns)
    np.testing.assert_allclose(
        baseline.accept_score([bare(one)]), baseline.accept_score([moved]), rtol=2e-3, atol=1e-3
    )


def test_what_was_never_shown_scores_below_what_was(baseline) -> None:
    shown = baseline.accept_score(TEST)
    other = baseline.accept_score(clips(("bow",), (4, 5), takes=2))
    assert shown.min() > other.max()
    assert baseline.recognise(clip("bow", 4, 0)).label is None
    known = sum(baseline.recognise(one).label == one.label for one in TRAIN)
    assert known == len(TRAIN), "a training clip is at distance 0 from itself"


def test_the_threshold_is_chosen_on_people_left_out(baseline) -> None:
    """A training clip judged by its own person would be at distance 0; by other people it is not."""
    assert -np.inf < baseline.accept_threshold_ < 0


@pytest.mark.parametrize("name", MADE)
def test_background_is_never_a_gesture(name: str) -> None:
    taught = TRAIN + clips(("bow",), (1, 2, 3), label=None)
    recogniser = clone(MADE[name]).fit(taught)
    assert recogniser.classes_.tolist() == sorted(GESTURES)
    bows = clips(("bow",), (4, 5))
    assert set(recogniser.predict(bows)) <= set(GESTURES)
    assert recogniser.accept_score(TEST).min() > 0 > recogniser.accept_score(bows).max()


@pytest.mark.parametrize("made", [*MADE.values(), AeonDtwRecognizer(), MultiRocketRecognizer()])
def test_faults(made) -> None:
    with pytest.raises(NotFittedError, match="is not fitted yet"):
        clone(made).predict(TEST)
    with pytest.raises(NotFittedError, match="is not fitted yet"):
        clone(made).accept_score(TEST)
    with pytest.raises(InputError, match="at least one labelled clip, but got an empty list"):
        clone(made).fit([])
    with pytest.raises(InputError, match="every label is None"):
        clone(made).fit(clips(("bow",), (1,), label=None))
    with pytest.raises(InputError, match="got 2 for 1 clips"):
        clone(made).fit(TRAIN[:1], ["a", "b"])


def test_one_person_and_one_clip_are_enough(baseline) -> None:
    alone = clone(baseline).fit(clips(GESTURES, (1,), takes=1))
    assert alone.predict(TRAIN[:1]).tolist() == [TRAIN[0].label]
    assert np.isfinite(alone.accept_score(TEST)).all()
    assert alone.recognise(TRAIN[0]).label in (None, TRAIN[0].label)


# -- each one's own idea --------------------------------------------------------------------------------


@given(st.integers(1, 6), st.integers(1, 6), st.integers(1, 3), st.integers(1, 4), st.integers(0, 99))
def test_kernels_agree_with_the_plain_one(n: int, m: int, coordinates: int, groups: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(n, coordinates, groups)), rng.normal(size=(m, coordinates, groups))
    each = dtw_each(a, b)
    np.testing.assert_allclose(each, [dtw(a[:, :, g], b[:, :, g]) for g in range(groups)])
    np.testing.assert_allclose(dtw_each(b, a), each)
    for g in range(groups):
        alone = np.eye(groups)[g]
        assert dtw_weighted(a, b, alone) == pytest.approx(each[g]), "one joint alone"
    weights = rng.random(groups)
    assert dtw_weighted(a, b, weights) >= weights @ each - 1e-9, "one path for all costs no less"
    assert dtw_weighted(a, a, weights) == pytest.approx(0)


def test_kernels_refuse_what_does_not_match() -> None:
    a = np.zeros((4, 3, 13))
    for b in (np.zeros((4, 3, 12)), np.zeros((4, 2, 13)), np.zeros((0, 3, 13)), np.zeros((4, 39))):
        with pytest.raises(InputError, match="alike but for the frames"):
            dtw_each(a, b)
    with pytest.raises(InputError, match="needs 13 weights"):
        dtw_weighted(a, a, np.ones(3))


def test_classical_is_the_plain_distance() -> None:
    recogniser = ClassicalRecognizer().fit(TRAIN)
    query = recogniser._sequence(TEST[0])
    np.testing.assert_allclose(
        recogniser._distances(query), [dtw(query, r) for r in recogniser.references_], rtol=1e-4
    )


def test_schneider_compares_only_what_moves() -> None:
    recogniser = SchneiderRecognizer().fit(TRAIN)
    moving = recogniser._moves(recogniser._sequence(clip("raise_left", 1, 0))).reshape(13, 2)
    assert moving[Landmark.LEFT_WRIST, 1]
    assert not moving[[Landmark.RIGHT_WRIST, Landmark.LEFT_KNEE, Landmark.RIGHT_HEEL]].any()
    still = clip("nothing", 1, 0)
    assert not recogniser._moves(recogniser._sequence(still)).any()
    assert np.isfinite(recogniser.accept_score([still])).all()


def test_schneider_knows_no_depth() -> None:
    recogniser = SchneiderRecognizer().fit(TRAIN)
    one = TEST[0]
    joints = one.joints.copy()
    joints[:, [Landmark.LEFT_WRIST, Landmark.RIGHT_KNEE], 2] += 0.3  # not the shoulders, which give the scale
    np.testing.assert_allclose(
        recogniser.accept_score([one]), recogniser.accept_score([Clip(joints, one.stamps_ns)])
    )


def test_celebi_weighs_joints_by_how_far_they_travel() -> None:
    recogniser = CelebiRecognizer(beta=0.3).fit(TRAIN)
    np.testing.assert_allclose(recogniser.weights_.sum(axis=1), 1)
    left = recogniser.weights_[recogniser.classes_.tolist().index("raise_left")]
    assert left[Landmark.LEFT_WRIST] > left[Landmark.LEFT_ELBOW] > left[Landmark.RIGHT_KNEE]
    even = CelebiRecognizer(beta=1e6).fit(TRAIN).weights_
    np.testing.assert_allclose(even, 1 / 13, err_msg="a large beta makes all joints alike")
    assert CelebiRecognizer(examples=2).fit(TRAIN).beta_ > 0


def test_rwigema_learns_weights_that_serve_people_left_out() -> None:
    """Only the left arm tells these two apart; noise on the legs of one person must not decide."""
    rng = np.random.default_rng(0)
    taught = []
    for one in clips(("raise_left", "circle_left"), (1, 2, 3, 4)):
        joints = one.joints.copy()
        joints[:, Landmark.LEFT_HEEL] += np.cumsum(rng.normal(0, 0.2, (len(one), 3)), axis=0)
        taught.append(Clip(joints, one.stamps_ns, one.label, one.subject, one.name))
    even = RwigemaRecognizer(generations=0, population=1, random_state=0).fit(taught)
    found = RwigemaRecognizer(generations=15, population=4, random_state=0).fit(taught)
    assert found.inner_accuracy_ >= even.inner_accuracy_
    assert found.inner_accuracy_ > 0.9
    again = RwigemaRecognizer(generations=15, population=4, random_state=0).fit(taught)
    np.testing.assert_array_equal(found.weights_, again.weights_)


# -- libraries ------------------------------------------------------------------------------------------


def test_peers_see_what_a_user_would_give_them() -> None:
    pytest.importorskip("aeon", reason="aeon is not installed; pip install 'wigwag[benchmark]'")
    recogniser = AeonDtwRecognizer(frames=16).fit(TRAIN)
    assert recogniser.predict([bare(one) for one in TEST]).tolist() == [one.label for one in TEST]
    arrays = recogniser._arrays(TEST[:1])
    assert arrays.shape == (1, 39, 16)
    background = TRAIN + clips(("bow",), (1, 2, 3), label=None)
    recogniser = AeonDtwRecognizer(frames=16).fit(background)
    bows = clips(("bow",), (4, 5))
    assert set(recogniser.predict(bows)) <= set(GESTURES)
    assert recogniser.accept_score(TEST).min() > recogniser.accept_score(bows).max()
    assert recogniser.recognise(bows[0]).label is None
    assert recogniser.recognise(TEST[0]).label == TEST[0].label


@pytest.mark.parametrize("made", [AeonDtwRecognizer(), MultiRocketRecognizer()])
def test_a_missing_library_is_named(made, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("distance_based", "convolution_based"):
        monkeypatch.setitem(sys.modules, f"aeon.classification.{name}", None)
    with pytest.raises(MissingExtraError, match=r"aeon is not installed.*wigwag\[benchmark\]"):
        clone(made).fit(TRAIN)
