import threading

import numpy as np
import pytest

from wigwag.camera.live import LiveCamera, ReconnectConfig
from wigwag.errors import CameraError, DataError, InputError

from .fakes import Metronome, Told, frame, picture

MS = 1_000_000


def at_once(delays):
    """Wait between attempts without waiting, and note how long it would have been."""

    def wait(event, seconds):
        delays.append(seconds)
        return event.is_set()

    return wait


@pytest.mark.parametrize("minutes", [10])
def test_a_slow_consumer_gets_new_frames_and_memory_does_not_grow(minutes):
    source = Metronome(rate_hz=120)
    period_ns = 1_000_000_000 // 15
    ages, stamps = [], []
    with LiveCamera(source) as camera:
        source.go_to(source.period_ns)
        for _ in range(minutes * 60 * 15):
            got = camera.latest()
            ages.append(source.now_ns - got.stamp_ns)
            stamps.append(got.stamp_ns)
            source.go_to(source.now_ns + period_ns)  # the consumer is busy
            # what it hands on now is as old as the frame, by now
            assert source.now_ns - got.stamp_ns <= period_ns + source.period_ns
        counts = camera.counts
    assert max(ages) <= source.period_ns
    assert np.all(np.diff(stamps) > 0)
    assert counts.received == pytest.approx(minutes * 60 * 120, rel=0.001)
    assert counts.handed == minutes * 60 * 15
    assert counts.received - counts.handed - counts.skipped in (0, 1)  # one may wait to be fetched
    assert source.most_alive <= 4  # in the slot, with the consumer, on its way, being replaced


def test_every_frame_goes_to_a_consumer_that_is_fast_enough():
    source = Metronome(rate_hz=30)
    stamps = []
    with LiveCamera(source) as camera:
        for i in range(1, 50):
            source.go_to(i * source.period_ns)
            stamps.append(camera.latest().stamp_ns)
        assert camera.counts.skipped == 0
    assert stamps == [i * source.period_ns for i in range(1, 50)]


def test_latest_never_gives_a_frame_twice():
    source = Told([frame(1), "wait", frame(2)])
    with LiveCamera(source) as camera:
        source.waiting.wait(10)
        assert camera.latest().stamp_ns == 1
        assert camera.latest(timeout_s=0.0) is None
        assert not camera.ended
        source.gate.set()
        assert camera.latest().stamp_ns == 2
        assert camera.latest() is None
        assert camera.ended


def test_iterating_yields_until_the_end():
    source = Told([frame(5), "wait"])
    with LiveCamera(source) as camera:
        frames = iter(camera)
        assert next(frames).stamp_ns == 5
        source.gate.set()
        assert list(frames) == []
    assert source.closed


def test_unplugged_and_back():
    delays = []
    lost = CameraError("unplugged")
    source = Told(
        [frame(100 * MS), "wait", lost, frame(3 * MS), frame(36 * MS)],
        openings=[CameraError("no device"), CameraError("no device"), None],
    )
    with LiveCamera(source, wait=at_once(delays)) as camera:
        assert camera.latest().stamp_ns == 100 * MS
        source.gate.set()
        stamps = [f.stamp_ns for f in camera]
        assert camera.counts.reconnects == 1
        assert camera.counts.received == 3
    assert delays == [0.25, 0.5, 1.0]
    assert source.opened == 4
    assert stamps[-1] > 100 * MS  # the device counts from zero again, the stamps go on


def test_a_camera_that_does_not_come_back_is_a_typed_error():
    delays = []
    source = Told([frame(1), "wait", CameraError("unplugged")], openings=[CameraError("no device")] * 99)
    config = ReconnectConfig(first_s=0.5, longest_s=2.0, give_up_s=9.0)
    with LiveCamera(source, config, at_once(delays)) as camera:
        assert camera.latest().stamp_ns == 1
        source.gate.set()
        with pytest.raises(CameraError, match=r"told:.* did not come back within 9.5 s.*no device"):
            camera.latest()
        with pytest.raises(CameraError):  # and again, however often one asks
            list(camera)
        assert not camera.connected
    assert delays == [0.5, 1.0, 2.0, 2.0, 2.0, 2.0]


def test_a_camera_that_opens_but_never_gives_a_frame_is_given_up():
    delays = []
    source = Told([CameraError("no frame")] * 99)
    with (
        LiveCamera(source, ReconnectConfig(1.0, 1.0, give_up_s=5.0), at_once(delays)) as camera,
        pytest.raises(CameraError, match="no frame"),
    ):
        camera.latest()
    assert sum(delays) == 5.0


def test_closing_ends_the_attempts():
    waits = threading.Event()

    def wait(event, seconds):
        waits.set()
        return event.wait(10)

    source = Told([CameraError("unplugged")])
    camera = LiveCamera(source, wait=wait)
    assert waits.wait(10)
    camera.close()
    camera.close()
    assert camera.latest() is None
    assert camera.ended
    assert source.interrupted
    assert source.opened == 1


def test_a_camera_that_is_not_there_is_known_at_once():
    class Missing(Told):
        def open(self):
            raise CameraError("no device")

    with pytest.raises(CameraError, match="no device"):
        LiveCamera(Missing([]))


def test_frames_out_of_order_are_dropped():
    source = Told([frame(40), frame(20), frame(40), "wait", frame(60)])
    with LiveCamera(source) as camera:
        source.waiting.wait(10)
        assert camera.latest().stamp_ns == 40
        source.gate.set()
        assert camera.latest().stamp_ns == 60
        assert camera.counts.out_of_order == 2


@pytest.mark.parametrize("error", [DataError("damaged"), InputError("wrong size"), RuntimeError("a bug")])
def test_other_errors_reach_whoever_asks_for_frames(error):
    source = Told([frame(1), "wait", error])
    with LiveCamera(source) as camera:
        assert camera.latest().stamp_ns == 1
        source.gate.set()
        with pytest.raises(type(error), match=str(error)):
            camera.latest()
    assert source.closed


def test_the_frame_before_an_error_is_handed_on_first():
    source = Told([frame(1), DataError("damaged")])
    with LiveCamera(source) as camera:
        camera._reader.join(10)
        assert camera.latest().stamp_ns == 1
        with pytest.raises(DataError):
            camera.latest()


def test_depth_of_another_size_cannot_become_a_frame():
    from wigwag.camera.frame import Frame

    with pytest.raises(InputError, match="Align depth to colour"):
        Frame(picture(), np.zeros((3, 4), np.uint16), frame(0).intrinsics, 0)


def test_waits_that_would_spin_are_refused():
    with pytest.raises(InputError):
        ReconnectConfig(first_s=0.0)
    with pytest.raises(InputError):
        ReconnectConfig(first_s=2.0, longest_s=1.0)
