"""References are embedded when they are asked for, and give what embedding all of them at once gives."""

import weakref

import numpy as np
import pytest

from tests.recognise.people import GESTURES, clips
from wigwag.features import Embedding, FrameScaler
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer
from wigwag.recognise.embedded import EmbeddedClips

CLIPS = clips(GESTURES, range(8), takes=2)


@pytest.fixture
def embedded_clips(monkeypatch):
    """Names of the clips that were embedded, in order."""
    names, original = [], Embedding.embed
    monkeypatch.setattr(
        Embedding, "embed", lambda self, clip: (names.append(clip.name), original(self, clip))[1]
    )
    return names


def test_gives_what_embedding_all_at_once_gives():
    embedding = Embedding().fit()
    eager = embedding.transform(CLIPS)
    scaler = FrameScaler().fit(eager)
    lazy = EmbeddedClips(CLIPS, embedding, scaler)
    assert len(lazy) == len(CLIPS)
    for one, other, i in zip(lazy, scaler.transform(eager), range(len(lazy)), strict=True):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(lazy[i], other)
    np.testing.assert_array_equal(lazy[-2:][0], lazy[len(CLIPS) - 2])


@pytest.mark.parametrize("method", ["minmax", "quantile", "std"])
def test_a_scaler_learns_the_same_one_by_one(method):
    embedding = Embedding().fit()
    lazy = FrameScaler(method).fit(EmbeddedClips(CLIPS, embedding))
    eager = FrameScaler(method).fit(embedding.transform(CLIPS))
    np.testing.assert_array_equal(lazy.center_, eager.center_)
    np.testing.assert_array_equal(lazy.half_range_, eager.half_range_)


def test_keeps_the_last_asked_for_and_no_more(embedded_clips):
    lazy = EmbeddedClips(CLIPS, Embedding().fit())
    for _ in lazy:
        pass
    assert not lazy._kept
    for i in range(40):
        assert lazy[i] is lazy[i]
        lazy[0]
    assert len(lazy._kept) == 32
    del embedded_clips[:]
    lazy[0], lazy[39], lazy[7]
    assert embedded_clips == [CLIPS[7].name]  # 0 was asked for all the time, 7 long ago


def test_loading_embeds_nothing_and_deciding_only_what_is_near(tmp_path, embedded_clips):
    path = tmp_path / "model.wigwag"
    fitted = HeavyRecognizer(k=1).fit(CLIPS[3:])
    fitted.save(path)
    del embedded_clips[:]
    loaded = HeavyRecognizer.load(path)
    assert not embedded_clips
    gesture = loaded.recognise(CLIPS[0])
    assert 2 <= len(embedded_clips) <= 12  # the clip itself, and a few of 45 references
    assert gesture == fitted.recognise(CLIPS[0])


@pytest.mark.parametrize("scaling", ["minmax", "quantile"])
@pytest.mark.parametrize("make", [HeavyRecognizer, EncodedRecognizer])
def test_fitting_never_holds_all_embeddings(make, scaling, monkeypatch):
    alive, most = weakref.WeakValueDictionary(), 0
    original = EmbeddedClips._embed

    def watched(self, clip):
        nonlocal most
        sequence = original(self, clip)
        alive[id(sequence)] = sequence
        most = max(most, len(alive))
        return sequence

    monkeypatch.setattr(EmbeddedClips, "_embed", watched)
    settings = {"max_epochs": 1} if make is EncodedRecognizer else {}
    make(scaling=scaling, k=1, **settings).fit(CLIPS[:12])
    assert 1 <= most <= 4
