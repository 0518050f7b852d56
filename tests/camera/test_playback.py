import threading

import pytest

from wigwag.camera.live import LiveCamera
from wigwag.camera.paced import Paced
from wigwag.camera.playback import Playback
from wigwag.errors import DataError, InputError

from .fakes import Told, frame

S = 1_000_000_000


def test_every_frame_of_a_recording_comes_in_turn():
    source = Told([frame(i) for i in range(5)])
    with Playback(source) as camera:
        assert camera.latest().stamp_ns == 0
        assert [f.stamp_ns for f in camera] == [1, 2, 3, 4]
        assert camera.ended
        assert camera.latest() is None
        assert (camera.counts.received, camera.counts.handed) == (5, 5)
    assert source.closed == 1


def test_frames_out_of_order_are_dropped_from_recordings_too():
    with Playback(Told([frame(s) for s in (0, 30, 10, 30, 60)])) as camera:
        assert [f.stamp_ns for f in camera] == [0, 30, 60]
        assert camera.counts.out_of_order == 2


def test_a_damaged_recording_ends_with_its_error():
    source = Told([frame(0), DataError("damaged"), frame(1)])
    with Playback(source) as camera:
        assert camera.latest().stamp_ns == 0
        with pytest.raises(DataError):
            camera.latest()
        assert camera.ended
        assert camera.latest() is None
    assert source.closed == 1


def test_closing_ends_it():
    camera = Playback(Told([frame(0), frame(1)]))
    camera.close()
    camera.close()
    assert list(camera) == []


class Hand:
    """A clock that waiting moves."""

    def __init__(self):
        self.now, self.waits = 50 * S, []

    def wait(self, event, seconds):
        self.waits.append(round(seconds, 6))
        self.now += round(seconds * S)
        return event.is_set()


def test_a_paced_recording_takes_its_time():
    clock = Hand()
    paced = Paced(Told([frame(s * S) for s in (7, 8, 10)]), 2.0, lambda: clock.now, clock.wait)
    paced.open()
    assert [paced.read().stamp_ns for _ in range(3)] == [50 * S, 50 * S + S // 2, 50 * S + 3 * S // 2]
    assert clock.waits == [0.5, 1.0]
    assert paced.read() is None


def test_a_paced_recording_that_is_late_does_not_wait():
    clock = Hand()
    paced = Paced(Told([frame(s * S) for s in (0, 1, 2)]), 1.0, lambda: clock.now, clock.wait)
    paced.open()
    paced.read()
    clock.now += 5 * S
    assert [paced.read().stamp_ns for _ in range(2)] == [51 * S, 52 * S]
    assert clock.waits == []


def test_closing_wakes_a_paced_recording_from_a_long_wait():
    asleep = threading.Event()

    def wait(event, seconds):
        asleep.set()
        return event.wait(10)

    camera = LiveCamera(Paced(Told([frame(0), frame(3600 * S)]), 1.0, lambda: 0, wait))
    assert camera.latest().stamp_ns == 0
    assert asleep.wait(10)
    camera.close()
    assert not camera._reader.is_alive()


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_speed_that_is_none_is_refused(speed):
    with pytest.raises(InputError, match="speed"):
        Paced(Told([]), speed)
