"""MediaPipe Tasks beside ours, on real photos; in the environment of ``--extra mediapipe``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wigwag.errors import InputError, MissingExtraError, ModelError
from wigwag.pose import mediapipe as module
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.mediapipe import MediaPipePose


@pytest.fixture(scope="module")
def loaded(networks: BlazePose) -> MediaPipePose:
    try:
        return MediaPipePose()
    except MissingExtraError as error:
        pytest.skip(f"MediaPipe is not here: {error}")


@pytest.fixture
def engine(loaded: MediaPipePose) -> MediaPipePose:
    loaded.reset()
    return loaded


def apart(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.median(np.linalg.norm(a - b, axis=1)))


def test_both_engines_agree_within_a_pixel(
    engine: MediaPipePose, blazepose: BlazePose, photos: dict[str, np.ndarray]
) -> None:
    followed, detected = [], []
    for photo in photos.values():
        engine.reset()
        blazepose.reset()
        for _ in range(4):
            theirs, ours = engine.track(photo), blazepose.track(photo)
        if theirs is None or ours is None:
            continue
        followed.append(apart(theirs.points_px, ours.points_px))
        np.testing.assert_allclose(np.median(np.abs(theirs.world_m - ours.world_m)), 0.0, atol=0.02)
        np.testing.assert_allclose(np.median(np.abs(theirs.visibility - ours.visibility)), 0.0, atol=0.05)
        one, other = engine.detect(photo), blazepose.detect(photo)
        if one is not None and other is not None:
            detected.append(apart(one.points_px, other.points_px))
    assert len(followed) >= 6
    assert np.median(followed) <= 0.6
    assert np.median(detected) <= 1.2


def test_there_is_no_lag_behind_who_moves(
    engine: MediaPipePose, blazepose: BlazePose, photos: dict[str, np.ndarray]
) -> None:
    """MediaPipe's own smoothing would leave the landmarks some pixels behind at 4 px a frame."""
    away = []
    for k in range(12):
        picture = np.ascontiguousarray(np.roll(photos["land"], 4 * k, axis=1))
        theirs, ours = engine.track(picture), blazepose.track(picture)
        assert theirs is not None
        assert ours is not None
        away.append(apart(theirs.points_px, ours.points_px))
    assert np.median(away[3:]) < 1.0


def test_what_mediapipe_does_not_tell_is_none(engine: MediaPipePose, photos: dict[str, np.ndarray]) -> None:
    body = engine.detect(photos["land"])
    assert body is not None
    assert body.score is None
    assert body.clarity is None
    assert body.points_px.shape == (33, 2)
    assert body.world_m.shape == (33, 3)
    assert ((body.visibility >= 0) & (body.visibility <= 1)).all()


def test_a_picture_by_itself_leaves_the_stream_alone(
    engine: MediaPipePose, photos: dict[str, np.ndarray]
) -> None:
    engine.track(photos["land"])
    alone = engine.track(photos["land"])
    engine.reset()
    engine.track(photos["land"])
    engine.detect(photos["up"])
    between = engine.track(photos["land"])
    assert alone is not None
    assert between is not None
    np.testing.assert_array_equal(alone.points_px, between.points_px)


def test_reset_forgets_whom_it_follows(engine: MediaPipePose, photos: dict[str, np.ndarray]) -> None:
    first = engine.track(photos["land"])
    second = engine.track(photos["land"])
    engine.reset()
    again = engine.track(photos["land"])
    assert first is not None
    assert second is not None
    assert again is not None
    np.testing.assert_array_equal(again.points_px, first.points_px)
    assert (second.points_px != first.points_px).any()


def test_nobody_and_no_picture(engine: MediaPipePose) -> None:
    blank = np.zeros((480, 640, 3), np.uint8)
    assert engine.detect(blank) is None
    assert engine.track(blank) is None
    assert engine.track(blank[:240, ::2]) is None, "of another size, and not in one piece"
    for call in (engine.detect, engine.track):
        with pytest.raises(InputError, match="uint8"):
            call(blank.astype(float))


def test_it_can_be_used_after_it_was_closed(networks: BlazePose, engine: MediaPipePose) -> None:
    blank = np.zeros((480, 640, 3), np.uint8)
    engine.close()
    engine.close()
    assert engine.track(blank) is None


def test_a_bundle_that_is_none(
    engine: MediaPipePose, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "broken.task"
    broken.write_bytes(b"no bundle")
    monkeypatch.setattr(module, "task_file", lambda *_: broken)
    with pytest.raises(ModelError, match=r"broken\.task: MediaPipe cannot use this bundle"):
        MediaPipePose()
