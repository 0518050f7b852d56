"""A loop over fresh pictures: what is frozen, black or absent is told, never handed on."""

import numpy as np
import pytest

from tests.camera.fakes import TINY, Told, frame
from wigwag.camera.frame import Frame
from wigwag.camera.fresh import fresh
from wigwag.camera.live import LiveCamera
from wigwag.camera.playback import Playback
from wigwag.camera.watchdog import Sight
from wigwag.errors import CameraError, DataError

MS = 1_000_000


def test_every_new_frame_of_a_recording_comes_with_its_own_time():
    frames = [frame(k * 33 * MS, seed=k) for k in range(1, 5)]
    glimpses = list(fresh(Playback(Told(frames))))
    assert [g.frame for g in glimpses] == frames
    assert [g.now_ns for g in glimpses] == [f.stamp_ns for f in frames]


def test_a_frozen_picture_is_told_and_not_handed_on():
    frames = [frame(k * 33 * MS, seed=7) for k in range(1, 15)]
    glimpses = list(fresh(Playback(Told(frames))))
    assert glimpses[0].frame is frames[0]
    assert all(g.frame is None for g in glimpses[1:])
    assert glimpses[1].health.sight is Sight.REPEATED
    assert glimpses[-1].health.sight is Sight.STALE
    assert "same picture" in glimpses[-1].health.reason


def test_a_black_picture_is_dark():
    black = Frame(np.zeros((6, 8, 3), np.uint8), None, TINY, 33 * MS)
    (glimpse,) = fresh(Playback(Told([black])))
    assert glimpse.frame is None
    assert glimpse.health.sight is Sight.DARK


def test_time_goes_on_while_no_frame_comes():
    source, now = Told([frame(1), "wait"]), [0]

    def clock():
        now[0] += 200 * MS
        return now[0]

    with LiveCamera(source, clock=clock) as camera:
        glimpses = fresh(camera, timeout_s=0.05)
        assert next(glimpses).frame is not None
        source.waiting.wait(10)
        silent = [next(glimpses) for _ in range(3)]
        source.gate.set()
    assert all(g.frame is None for g in silent)
    assert silent[0].health.sight is Sight.REPEATED
    assert silent[-1].health.sight is Sight.STALE
    assert silent[0].now_ns < silent[-1].now_ns


@pytest.mark.parametrize("error", [CameraError("gone"), DataError("damaged")])
def test_what_the_camera_raises_is_raised_after_what_it_gave(error):
    frames = [frame(33 * MS, seed=1), frame(66 * MS, seed=2)]
    seen = []
    with pytest.raises(type(error), match=str(error)):
        for glimpse in fresh(Playback(Told([*frames, error]))):
            seen.append(glimpse.frame)
    assert seen == frames


def test_frozen_depth_under_living_pictures_is_all_holes():
    depth = np.full((6, 8), 3000, np.uint16)
    frames = [frame(k * 33 * MS, seed=k, depth_mm=depth) for k in range(1, 15)]
    glimpses = list(fresh(Playback(Told(frames))))
    first, last = glimpses[0].frame, glimpses[-1].frame
    assert first is not None
    assert first.depth_mm is depth
    assert last is not None
    assert last.depth_mm is not None
    assert not last.depth_mm.any()
