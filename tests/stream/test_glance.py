"""The second view of a stream: live and in hindsight the same; strangers; none from a camera that flies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wigwag.skeleton import Pose
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.glance import GLANCE_SIGNS, Glance, Glances, scores_of, signs_of
from wigwag.stream.prefix import SIGNS
from wigwag.stream.rows import DOUBTFUL
from wigwag.stream.teach import teach_stream
from wigwag.stream.teach_glance import GlanceLesson
from wigwag.stream.ticks import Ticks
from wigwag.stream.track import Track

from .people import GESTURES, session

STREAMS = [session(number).stream() for number in range(4)]
FOLDS = np.arange(4)


def lesson() -> GlanceLesson:
    return GlanceLesson(STREAMS, GESTURES, FOLDS, seed=0)


@pytest.fixture(scope="module")
def glance() -> Glance:
    """Taught by three actors; the fourth is left out."""
    taught = lesson().without(3)
    assert taught is not None
    return taught


def test_who_is_left_out_is_understood(glance: Glance) -> None:
    taught = lesson()
    for showing in STREAMS[3].showings:
        near_end_ns = showing.onset_ns + round(0.8 * (showing.end_ns - showing.onset_ns))
        now, late = taught.glimpses(glance, 3, np.array([near_end_ns]))[0]
        assert GESTURES[int(now[:-1].argmax())] == GESTURES[int(late[:-1].argmax())] == showing.label
        assert now.sum() == pytest.approx(1.0, abs=1e-5) and now[:-1].max() > 0.8
    resting = taught.glimpses(glance, 3, np.array([1_500_000_000]))[0]
    assert resting[0, -1] > 0.8


def test_rows_at_the_edge_of_a_gesture_teach_nothing() -> None:
    taught = lesson()
    showing, stamps_ns = STREAMS[0].showings[0], taught.tracks[0].stamps_ns

    def at(share: float, later_s: float = 0.0) -> int:
        moment = showing.onset_ns + share * (showing.end_ns - showing.onset_ns) + later_s * 1e9
        return int(taught.classes[0][np.searchsorted(stamps_ns, moment)])

    number = GESTURES.index(showing.label)
    assert [at(0.0), at(0.35), at(0.6), at(1.0), at(1.0, 0.3), at(1.0, 0.55)] == [
        len(GESTURES), DOUBTFUL, number, number, DOUBTFUL, len(GESTURES)
    ]  # fmt: skip


def test_what_is_seen_live_is_what_is_seen_in_hindsight(glance: Glance) -> None:
    stream = STREAMS[3].stream
    whole = glance.of_track(Track.of(stream))
    ticks, live = Ticks(), Glances(glance)
    for joints, stamp_ns in zip(stream.joints[:200], stream.stamps_ns[:200], strict=True):
        ticks.update(Pose(joints, np.ones(13), int(stamp_ns)))
        glimpse = live.update(ticks)
        assert glimpse is not None
        np.testing.assert_allclose(glimpse, whole[ticks.count - 1], atol=2e-5)


def test_a_new_beginning_forgets_what_was_seen(glance: Glance) -> None:
    stream = STREAMS[3].stream
    ticks, live = Ticks(), Glances(glance)
    assert live.update(ticks) is None
    for joints, stamp_ns in zip(stream.joints[:120], stream.stamps_ns[:120], strict=True):
        ticks.update(Pose(joints, np.ones(13), int(stamp_ns)))
        live.update(ticks)
    ticks.update(Pose(stream.joints[300], np.ones(13), int(stream.stamps_ns[300])))
    assert ticks.restarts == 1
    glimpse = live.update(ticks)
    assert glimpse is not None
    np.testing.assert_array_equal(glimpse[0], glimpse[1])


def test_it_sees_where_the_hips_go(glance: Glance) -> None:
    track = Track.of(STREAMS[0].stream)
    carried = replace(track, hips=track.hips + np.float32(0.5))
    assert np.abs(glance.of_track(track) - glance.of_track(carried)).max() > 0.01


def test_signs_say_how_far_the_decided_gesture_is_ahead() -> None:
    likely = np.array([0.7, 0.2, 0.0, 0.1])
    glimpse = np.stack([likely, likely])
    together = np.array([0.5, 0.9, -1.0]) + scores_of(glimpse)
    signs = dict(zip(GLANCE_SIGNS, signs_of(glimpse, 0, together), strict=True))
    assert signs["odds now"] == pytest.approx(np.log(7))
    assert signs["lead now"] == pytest.approx(np.log(3.5))
    assert signs["usual of late"] == pytest.approx(np.log(0.7))
    assert signs["lead of both"] == pytest.approx(-0.4 + 0.2 * np.log(3.5))
    alone = signs_of(np.array([[1.0, 0.0], [1.0, 0.0]]), 0, np.array([1.0]))
    assert np.isfinite(alone).all()


def test_who_saves_it_hears_the_same_and_files_of_before_have_none(tmp_path: Path) -> None:
    model = teach_stream((), streams=STREAMS[:2])
    assert model.glance is not None
    assert model.sureness.center.shape == (len(SIGNS) + len(GLANCE_SIGNS),)
    model.save(tmp_path / "model.wigwag")
    again = StreamModel.load(tmp_path / "model.wigwag")
    assert again.glance is not None
    track = Track.of(STREAMS[2].stream)
    np.testing.assert_array_equal(again.glance.of_track(track), model.glance.of_track(track))
    assert Glance.restored({}) is None


def test_from_a_camera_that_flies_there_is_none() -> None:
    model = teach_stream((), streams=STREAMS[:2], origin="drift")
    assert model.glance is None
    assert model.sureness.center.shape == (len(SIGNS),)
