import itertools
import sys

import numpy as np
import pytest

from wigwag.camera.live import LiveCamera
from wigwag.camera.playback import Playback
from wigwag.camera.realsense import RealSenseConfig, RealSenseSource
from wigwag.errors import CameraError, DataError, InputError, MissingExtraError
from wigwag.extras import load_realsense

from .fakes import picture
from .software import COLOR, DEPTH, SoftwareRealSense

MS = 1_000_000


@pytest.fixture
def rs():
    try:
        return load_realsense("this test")
    except MissingExtraError as error:
        pytest.skip(str(error))


def depth(seed=0):
    return np.random.default_rng(seed).integers(500, 6000, (DEPTH.height, DEPTH.width)).astype(np.uint16)


def color(seed=0):
    return picture(seed, COLOR.width, COLOR.height)


def fed(software, depths, colors):
    """Return the frames that a source makes of these pictures."""
    host = itertools.count(7_000 * MS, 33 * MS)
    source = RealSenseSource(framesets=lambda: software, now_ns=lambda: next(host))
    source.open()
    software.pair(depths[0], colors[0])  # librealsense joins depth and colour from the second pair on
    frames = []
    for d, c in zip(depths, colors, strict=True):
        software.push(d, c)
        frames.append(source.read())
    source.close()
    return frames


def test_a_device_gives_colour_and_aligned_depth_with_its_own_intrinsics(rs):
    colors = [color(i) for i in range(3)]
    flat = [np.full((DEPTH.height, DEPTH.width), 1500 + 100 * i, np.uint16) for i in range(3)]
    frames = fed(SoftwareRealSense(rs), flat, colors)
    for i, frame in enumerate(frames):
        assert np.array_equal(frame.rgb, colors[i])
        assert frame.depth_mm.shape == (COLOR.height, COLOR.width)
        assert set(np.unique(frame.depth_mm)) <= {0, 1500 + 100 * i}
        assert np.mean(frame.depth_mm > 0) > 0.9
        got, want = frame.intrinsics, COLOR
        assert (got.width, got.height) == (want.width, want.height)
        assert (got.fx, got.fy, got.cx, got.cy) == pytest.approx((want.fx, want.fy, want.cx, want.cy))


def test_stamps_are_on_the_hosts_clock(rs):
    frames = fed(SoftwareRealSense(rs), [depth()] * 3, [color(i) for i in range(3)])
    assert [f.stamp_ns for f in frames] == [7_000 * MS, 7_033 * MS, 7_066 * MS]


@pytest.mark.parametrize("kind", ["bgr8", "yuyv", "y8"])
def test_other_kinds_of_colour(rs, kind):
    import cv2

    grey = np.full((COLOR.height, COLOR.width), 120, np.uint8)
    rgb = np.dstack([np.full_like(grey, 180), grey, np.full_like(grey, 60)])
    pixels = {"bgr8": rgb[:, :, ::-1].copy(), "yuyv": cv2.cvtColor(rgb, cv2.COLOR_RGB2YUV_YUY2), "y8": grey}[
        kind
    ]
    (frame,) = fed(SoftwareRealSense(rs, color=kind), [depth()], [pixels])
    expected = np.dstack([grey] * 3) if kind == "y8" else rgb
    assert np.abs(frame.rgb.astype(int) - expected).max() <= 3


def test_counts_of_another_unit_become_millimetres(rs):
    counts = np.full((DEPTH.height, DEPTH.width), 20_000, np.uint16)
    (frame,) = fed(SoftwareRealSense(rs, unit_m=0.0001), [counts], [color()])
    assert set(np.unique(frame.depth_mm)) <= {0, 2000}


def test_all_zero_depth_goes_on(rs):
    (frame,) = fed(SoftwareRealSense(rs), [np.zeros((DEPTH.height, DEPTH.width), np.uint16)], [color()])
    assert not frame.depth_mm.any()


def test_unplugged_and_back(rs):
    devices = []

    def plug_in():
        if len(devices) == 2:
            devices.append(None)
            raise RuntimeError("No device connected")
        devices.append(SoftwareRealSense(rs))
        devices[-1].pair(depth(), color())
        for i in range(3):
            devices[-1].push(depth(i), color(i))
        return Unplugged(devices[-1], after=3 if len(devices) < 4 else 99)

    source = RealSenseSource(framesets=plug_in, config=RealSenseConfig(timeout_s=0.2))
    stamps = []
    with LiveCamera(source, wait=lambda event, s: event.is_set()) as camera:
        while camera.counts.reconnects < 2:
            if (frame := camera.latest()) is not None:
                stamps.append(frame.stamp_ns)
    assert len(devices) >= 4
    assert stamps
    assert stamps == sorted(set(stamps))


class Unplugged:
    """A device that is pulled out after so many frames."""

    def __init__(self, software, after):
        self.software, self.left = software, after

    def wait(self, timeout_ms):
        self.left -= 1
        self.software.unplugged = self.left < 0
        return self.software.wait(timeout_ms)

    def stop(self):
        self.software.stop()


def test_a_silent_device_is_a_typed_error(rs):
    software = SoftwareRealSense(rs)
    source = RealSenseSource(framesets=lambda: software, config=RealSenseConfig(timeout_s=0.05))
    source.open()
    with pytest.raises(CameraError, match="realsense:: no frames came"):
        source.read()
    source.close()
    with pytest.raises(CameraError, match="not open"):
        source.read()


def recorded(rs, path, n=8):
    """Record with what this librealsense writes: .bag up to 2.56, .db3 since."""
    for suffix in (".bag", ".db3"):
        try:
            software = SoftwareRealSense(rs, record=path.with_suffix(suffix))
        except RuntimeError:
            continue
        for i in range(n):
            software.push(depth(i), color(i))
            software.wait(1000)
        software.stop()
        return path.with_suffix(suffix)
    raise AssertionError("librealsense records neither .bag nor .db3")


def test_a_recording_plays_once_and_keeps_its_stamps(rs, tmp_path):
    path = recorded(rs, tmp_path / "flight")
    with Playback(RealSenseSource(path=path)) as camera:
        frames = list(camera)
    assert 7 <= len(frames) <= 8  # the first set may lack its depth
    assert np.diff([f.stamp_ns for f in frames]) == pytest.approx(33 * MS)
    for f in frames:
        i = round(f.stamp_ns / (33 * MS))
        assert np.array_equal(f.rgb, color(i))
    whole = [f for f in frames if f.depth_mm is not None]
    assert len(whole) >= 7
    assert all(f.depth_mm.any() for f in whole)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8])
def test_a_truncated_recording_is_a_typed_error(rs, tmp_path, share):
    path = recorded(rs, tmp_path / "flight")
    data = path.read_bytes()
    cut = tmp_path / f"cut{path.suffix}"
    cut.write_bytes(data[: int(share * len(data))])
    with pytest.raises(DataError, match=rf"cut{path.suffix}"), Playback(RealSenseSource(path=cut)) as camera:
        list(camera)


def test_a_recording_that_is_not_there(rs, tmp_path):
    with pytest.raises(DataError, match="no such file"):
        Playback(RealSenseSource(path=tmp_path / "none.bag"))


def test_a_device_that_is_not_there(rs):
    with pytest.raises(CameraError, match=r"realsense:000: cannot be opened with 640 x 480 at 30 Hz"):
        RealSenseSource(serial="000").open()


def test_without_the_extra_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyrealsense2", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'wigwag\[realsense\]'"):
        RealSenseSource()


@pytest.mark.parametrize("change", [{"width": 0}, {"rate_hz": -30}, {"timeout_s": 0.0}])
def test_what_no_device_can_do_is_refused(change):
    with pytest.raises(InputError, match="above 0"):
        RealSenseConfig(**change)
