"""Heavy and Encoded, as a user of scikit-learn meets them, and as a drone does."""

import json
import zipfile

import numpy as np
import pytest
from sklearn.base import clone

from tests.recognise.people import GESTURES, clip, clips
from wigwag.errors import InputError, ModelError, NotFittedError
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer
from wigwag.skeleton import Clip, mirrored

TRAIN = clips(GESTURES, range(4))
TEST = clips(GESTURES, range(10, 13))
TRUTH = [c.label for c in TEST]
OTHERS = clips(("spread", "bow"), range(4), label=None)
MAKERS = {
    "heavy": HeavyRecognizer,
    "heavy_paper": HeavyRecognizer.as_in_paper,
    "encoded": lambda **s: EncodedRecognizer(max_epochs=15, **s),
    "encoded_paper": lambda **s: EncodedRecognizer.as_in_paper(max_epochs=15, **s),
}


@pytest.fixture(scope="module", params=MAKERS)
def fitted(request):
    return MAKERS[request.param]().fit(TRAIN)


@pytest.fixture(scope="module", params=["heavy", "encoded"])
def guarded(request):
    """Knows three gestures, and two movements that are none."""
    return MAKERS[request.param]().fit(TRAIN + OTHERS)


def test_recognises_people_it_never_saw(fitted):
    assert fitted.classes_.tolist() == sorted(GESTURES)
    assert fitted.predict(TEST).tolist() == TRUTH
    assert fitted.score(TEST, TRUTH) == 1.0


def test_probabilities_are_some_and_agree_with_the_decision(fitted):
    probabilities = fitted.predict_proba(TEST)
    assert probabilities.shape == (len(TEST), 3)
    assert (probabilities >= 0).all()
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)
    assert fitted.classes_[probabilities.argmax(axis=1)].tolist() == fitted.predict(TEST).tolist()


def test_gestures_carry_when_how_sure_and_why(fitted):
    gesture = fitted.recognise(TRAIN[0])
    assert gesture.label == TRAIN[0].label
    assert gesture.confidence >= fitted.null_confidence_
    assert (gesture.onset_ns, gesture.end_ns) == (TRAIN[0].stamps_ns[0], TRAIN[0].stamps_ns[-1])
    assert "raise_left_p0_t0" in gesture.reason


def test_what_is_no_gesture_gets_no_label_and_a_reason(guarded):
    for other in clips(("spread", "bow"), range(10, 13), label=None):
        gesture = guarded.recognise(other)
        assert gesture.label is None, other.name
        assert gesture.reason
    answers = [guarded.recognise(c).label for c in TEST]
    wrong = [a for a, t in zip(answers, TRUTH, strict=True) if a not in (None, t)]
    assert not wrong
    assert np.mean([a == t for a, t in zip(answers, TRUTH, strict=True)]) >= 0.85
    # The closed set stays closed: background is no class.
    assert set(guarded.predict(OTHERS)) <= set(GESTURES)


def test_what_is_like_nothing_taught_is_turned_away(guarded):
    rng = np.random.default_rng(0)
    wild = Clip.at_rate(rng.normal(0, 1, (40, 13, 3)), 20)
    gesture = guarded.recognise(wild)
    assert gesture.label is None


def test_unsure_is_null_and_threshold_is_the_users(fitted):
    never = clone(fitted).set_params(null_confidence=1.0).fit(TRAIN)
    gesture = never.recognise(TEST[0])
    assert gesture.label is None
    assert "1.00" in gesture.reason


@pytest.mark.parametrize("name", ["heavy", "encoded"])
def test_left_and_right_mirrored_swap_labels(name):
    swap = {"raise_left": "raise_right", "raise_right": "raise_left"}
    train = [c for c in TRAIN if c.label in swap]
    recogniser = MAKERS[name]().fit([mirrored(c) for c in train], [swap[c.label] for c in train])
    for c in TEST:
        if c.label in swap:
            assert recogniser.predict([c]).tolist() == [c.label]
            assert recogniser.predict([mirrored(c)]).tolist() == [swap[c.label]]


def test_place_size_and_heading_do_not_matter():
    recogniser = HeavyRecognizer().fit(TRAIN)
    turn = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    for c in TEST[::3]:
        moved = Clip(1.3 * (c.joints @ turn.T) + [2.0, 0.5, -1.0], c.stamps_ns)
        a, b = recogniser.recognise(c), recogniser.recognise(moved)
        assert a.label == b.label
        assert a.confidence == pytest.approx(b.confidence, abs=1e-3)


def test_the_same_gestures_from_another_camera_rate(fitted):
    slow_and_fast = [clip(c.name.rsplit("_p", 1)[0], 10, 0, rate_hz=r) for c in TEST[:1] for r in (12, 30)]
    if fitted.preparation is None:  # the plain form compares velocities of frames as they come
        assert fitted.predict(slow_and_fast).tolist() == ["raise_left", "raise_left"]


def test_k_is_chosen_on_people_left_out_unless_given(fitted):
    assert fitted.k_ in fitted.k_scores_
    assert clone(fitted).set_params(k=3).fit(TRAIN).k_ == 3


def test_scikit_learn_contract(fitted):
    fresh = clone(fitted)
    assert fresh.get_params() == fitted.get_params()
    assert not [name for name in vars(fresh) if name.endswith("_")]
    again = fresh.fit(TRAIN)
    assert again is fresh
    np.testing.assert_allclose(again.predict_proba(TEST), fitted.predict_proba(TEST), atol=1e-5)


def test_labels_from_y_overrule_the_clips():
    recogniser = HeavyRecognizer().fit(TRAIN, ["x" if c.label == "circle_left" else "y" for c in TRAIN])
    assert recogniser.classes_.tolist() == ["x", "y"]


# -- save and load ---------------------------------------------------------------------------------------


def test_a_round_trip_changes_no_prediction(fitted, tmp_path):
    path = tmp_path / "new" / "model.wigwag"
    fitted.save(path)
    loaded = type(fitted).load(path)
    np.testing.assert_array_equal(loaded.predict_proba(TEST), fitted.predict_proba(TEST))
    assert [loaded.recognise(c) for c in TEST] == [fitted.recognise(c) for c in TEST]
    assert loaded.get_params() == fitted.get_params()
    assert [p.name for p in path.parent.iterdir()] == ["model.wigwag"]
    loaded.save(path)  # a loaded one can be kept again
    np.testing.assert_array_equal(type(fitted).load(path).predict(TEST), fitted.predict(TEST))


def test_damaged_and_foreign_files_are_named(tmp_path):
    path = tmp_path / "model.wigwag"
    HeavyRecognizer().fit(TRAIN).save(path)
    good = path.read_bytes()

    with pytest.raises(ModelError, match=r"nowhere\.wigwag: there is no such model"):
        HeavyRecognizer.load(tmp_path / "nowhere.wigwag")
    with pytest.raises(ModelError, match=r"holds a HeavyRecognizer, but EncodedRecognizer\.load"):
        EncodedRecognizer.load(path)
    for broken in (b"", b"PK", good[: len(good) // 2], b"\0" * 100, good[:200] + b"\xff" * 64 + good[264:]):
        path.write_bytes(broken)
        with pytest.raises(ModelError, match=r"model\.wigwag: .*(damaged|does not hold)"):
            HeavyRecognizer.load(path)
    path.write_bytes(good)
    rewrite(path, "header.json", lambda h: {**h, "version": 99})
    with pytest.raises(ModelError, match="format version 99, but this wigwag reads version 1"):
        HeavyRecognizer.load(path)
    path.write_bytes(good)
    rewrite(path, "facts.json", lambda f: {**f, "k": 5})
    with pytest.raises(ModelError, match="SHA-256"):
        HeavyRecognizer.load(path)
    path.write_bytes(good)
    rewrite(path, "header.json", lambda h: {**h, "format": "another"})
    with pytest.raises(ModelError, match="'another'"):
        HeavyRecognizer.load(path)
    with pytest.raises(ModelError):
        HeavyRecognizer.load(tmp_path)  # a folder


def rewrite(path, member, change):
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members[member] = json.dumps(change(json.loads(members[member]))).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)


def test_a_failed_save_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "model.wigwag"
    recogniser = HeavyRecognizer().fit(TRAIN)
    recogniser.save(path)
    before = path.read_bytes()

    def full_disk(*_):
        raise OSError("no space left")

    monkeypatch.setattr("wigwag.recognise.store.os.replace", full_disk)
    with pytest.raises(OSError, match="no space left"):
        recogniser.save(path)
    assert path.read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


# -- faults and odd input ----------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [HeavyRecognizer, EncodedRecognizer])
def test_faults(make, tmp_path):
    with pytest.raises(NotFittedError, match=f"{make.__name__} is not fitted yet"):
        make().predict(TEST)
    with pytest.raises(NotFittedError):
        make().recognise(TEST[0])
    with pytest.raises(NotFittedError):
        make().save(tmp_path / "m")
    with pytest.raises(InputError, match="empty list"):
        make().fit([])
    with pytest.raises(InputError, match="one label a clip, but got 2 for 24"):
        make().fit(TRAIN, ["a", "b"])
    with pytest.raises(InputError, match="at least one gesture"):
        make().fit(OTHERS)
    with pytest.raises(InputError, match="element 1 is ndarray"):
        make().fit([TRAIN[0], TRAIN[0].joints])
    with pytest.raises(InputError, match="motion_weight must be positive"):
        make(motion_weight=0).fit(TRAIN)
    with pytest.raises(InputError, match=r"k must be 1 or more"):
        make(k=0).fit(TRAIN)


def test_encoded_names_a_wrong_width():
    with pytest.raises(InputError, match=r"EncodedRecognizer\.latent must be 1 or more"):
        EncodedRecognizer(latent=0).fit(TRAIN)


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.filterwarnings("error")
def test_few_short_still_and_repeated_clips(name):
    two_frames = Clip.at_rate(TRAIN[0].joints[:2], 20)
    still = Clip.at_rate(np.repeat(TRAIN[0].joints[:1], 30, axis=0), 20)
    point = Clip.at_rate(np.zeros((10, 13, 3)), 20)
    for train in (
        [TRAIN[0]],
        TRAIN[:2],
        [TRAIN[0]] * 6,
        [TRAIN[0], TRAIN[-1]],
        [still, two_frames, point, *OTHERS[:2]],
    ):
        labels = [c.label or "still" for c in train]
        if train[-1].label is None:
            labels[-2:] = [None, None]
        recogniser = MAKERS[name]().fit(train, labels)
        for query in (two_frames, still, point, TRAIN[0], TRAIN[-1]):
            assert recogniser.predict([query])[0] in recogniser.classes_
            assert np.isfinite(recogniser.predict_proba([query])).all()
            gesture = recogniser.recognise(query)
            assert gesture.label is None or gesture.label in recogniser.classes_
    assert MAKERS[name]().fit([TRAIN[0]] * 6).recognise(TRAIN[0]).label == TRAIN[0].label
