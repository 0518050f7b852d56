import sys

import cv2
import numpy as np
import pytest

from wigwag.camera.align import DepthAligner, Extrinsic
from wigwag.camera.bags import BagConfig, BagSource
from wigwag.camera.frame import Intrinsics
from wigwag.camera.playback import Playback
from wigwag.errors import DataError, InputError, MissingExtraError

from .fakes import picture
from .rosbag import COLOR, DEPTH, DEPTH_INFO, INFO, bag

pytest.importorskip("rosbags", reason="needs rosbags: pip install 'wigwag[bags]'")

MS = 1_000_000
T0 = 1_700_000_000 * 10**9
LENS = Intrinsics(40.0, 41.0, 15.5, 11.5, 32, 24)
SMALL = Intrinsics(15.0, 15.0, 7.5, 5.5, 16, 12)
KINDS = ["ros1", "ros2", "mcap"]


def rgb(i):
    return picture(i, 32, 24)


def depth(i, shape=(24, 32)):
    return np.random.default_rng(i).integers(1, 6000, shape).astype(np.uint16)


def write(folder, kind="mcap", n=6, *, late_ns=3 * MS, dark=(), depth_frame="color", lens=LENS):
    """Write a bag whose depth is stamped and logged ``late_ns`` after colour, and missing at ``dark``."""
    with bag(folder, kind) as w:
        for i in range(n):
            t = T0 + i * 33 * MS
            w.write(INFO, w.info(t, lens), t)
            w.write(COLOR, w.image(t, rgb(i), "rgb8"), t)
            if i not in dark:
                w.write(DEPTH, w.image(t + late_ns, depth(i), "16UC1", depth_frame), t + abs(late_ns))
    return w.path


def frames_of(path, **config):
    with Playback(BagSource(path, BagConfig(**config))) as camera:
        return list(camera)


@pytest.mark.parametrize("kind", KINDS)
def test_colour_and_depth_come_together(tmp_path, kind):
    frames = frames_of(write(tmp_path, kind))
    assert len(frames) == 6
    for i, f in enumerate(frames):
        assert np.array_equal(f.rgb, rgb(i))
        assert np.array_equal(f.depth_mm, depth(i))
        assert f.stamp_ns == T0 + i * 33 * MS
        assert f.intrinsics == LENS


def test_a_single_file_of_mcap(tmp_path):
    (file,) = write(tmp_path).glob("*.mcap")
    assert len(frames_of(file)) == 6


@pytest.mark.parametrize("late_ms", [-15, -3, 0, 15])
def test_depth_goes_to_the_nearest_colour(tmp_path, late_ms):
    frames = frames_of(write(tmp_path, late_ns=late_ms * MS))
    assert all(np.array_equal(f.depth_mm, depth(i)) for i, f in enumerate(frames))


def test_depth_that_is_missing_for_a_while_is_missing_there_alone(tmp_path):
    frames = frames_of(write(tmp_path, n=40, dark=range(10, 30)))
    assert [f.depth_mm is None for f in frames] == [10 <= i < 30 for i in range(40)]


def test_the_topics_can_be_named(tmp_path):
    with bag(tmp_path, "mcap") as w:
        for topic, i in (("/left/image", 1), ("/right/image", 2)):
            w.write(topic, w.image(T0, rgb(i), "rgb8"), T0)
        w.write("/lens", w.info(T0, LENS), T0)
        w.write("/range", w.image(T0, depth(0), "16UC1"), T0)
    with pytest.raises(DataError, match=r"which topic is color\? .* /left/image, /range, /right/image"):
        frames_of(w.path)
    (frame,) = frames_of(w.path, color="/right/image", depth="/range", info="/lens")
    assert np.array_equal(frame.rgb, rgb(2))
    assert np.array_equal(frame.depth_mm, depth(0))
    with pytest.raises(DataError, match=r"has no topic /nowhere for \?depth.*/range"):
        frames_of(w.path, color="/right/image", depth="/nowhere")
    with pytest.raises(
        DataError, match=r"no CameraInfo for /right/image. Name it: \?info=/topic; there is /lens"
    ):
        frames_of(w.path, color="/right/image", depth="/range")


def test_colour_alone_without_camera_info_goes_by_the_lens(tmp_path):
    with bag(tmp_path, "mcap") as w:
        w.write("/image/compressed", w.compressed(T0, cv2.imencode(".png", rgb(1))[1].tobytes(), "png"), T0)
    (frame,) = frames_of(w.path)
    assert frame.rgb.shape == (24, 32, 3)
    assert frame.depth_mm is None
    assert frame.intrinsics.fx == pytest.approx(16 / np.tan(np.radians(32.5)))


def test_depth_of_another_camera_is_aligned_through_the_tree_of_transforms(tmp_path):
    half = np.sin(np.radians(1.0))
    with bag(tmp_path, "mcap") as w:
        w.write("/tf_static", w.tf("body", "color", (0.1, 0.2, 0.3)), T0)
        w.write(
            "/tf_static", w.tf("/body", "ir", (0.1, 0.15, 0.3), (0.0, half, 0.0, np.cos(np.radians(1.0)))), T0
        )
        w.write(INFO, w.info(T0, LENS), T0)
        w.write(DEPTH_INFO, w.info(T0, SMALL, "ir"), T0)
        near = (depth(0, (12, 16)) // 8 + 1500).astype(np.uint16)
        w.write(DEPTH, w.image(T0, near, "16UC1", "ir"), T0)
        w.write(COLOR, w.image(T0, rgb(0), "rgb8"), T0)
    (frame,) = frames_of(w.path)
    c, s = np.cos(np.radians(2.0)), np.sin(np.radians(2.0))
    by_hand = Extrinsic(np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([0.0, -0.05, 0.0]))
    assert np.array_equal(frame.depth_mm, DepthAligner(SMALL, LENS, by_hand)(near))


def test_depth_of_another_camera_without_a_way_between_them(tmp_path):
    with bag(tmp_path, "mcap") as w:
        w.write(INFO, w.info(T0, LENS), T0)
        w.write(DEPTH_INFO, w.info(T0, LENS, "ir"), T0)
        w.write(DEPTH, w.image(T0, depth(0), "16UC1", "ir"), T0)
        w.write(COLOR, w.image(T0, rgb(0), "rgb8"), T0)
    with pytest.raises(DataError, match=r"seen from 'ir', colour from 'color', and /tf_static does not join"):
        frames_of(w.path)
    (frame,) = frames_of(w.path, aligned=True)
    assert np.array_equal(frame.depth_mm, depth(0))


def test_depth_of_another_size_is_a_typed_error(tmp_path):
    with bag(tmp_path, "mcap") as w:
        w.write(INFO, w.info(T0, LENS), T0)
        w.write(DEPTH, w.image(T0, depth(0, (12, 16)), "16UC1"), T0)
        w.write(COLOR, w.image(T0, rgb(0), "rgb8"), T0)
    with pytest.raises(DataError, match=r"depth is 16 x 12, colour 32 x 24.*\?depth_info"):
        frames_of(w.path)


def test_wrong_intrinsics_are_a_typed_error(tmp_path):
    with pytest.raises(DataError, match=r"camera_info: .* for pictures of 16 x 12"):
        frames_of(write(tmp_path, lens=SMALL))
    zero = Intrinsics(0.0, 0.0, 0.0, 0.0, 32, 24)  # an uncalibrated camera says so in ROS
    (tmp_path / "zero").mkdir()
    with pytest.raises(DataError, match=r"camera_info: fx and fy must be finite and above 0"):
        frames_of(write(tmp_path / "zero", lens=zero))


def test_frames_out_of_order_black_pictures_and_all_zero_depth_go_on(tmp_path):
    with bag(tmp_path, "mcap") as w:
        w.write(INFO, w.info(T0, LENS), T0)
        for log, i in enumerate((0, 2, 1, 3)):
            t = T0 + i * 33 * MS
            w.write(COLOR, w.image(t, np.zeros((24, 32, 3), np.uint8), "rgb8"), T0 + log * 33 * MS)
            w.write(DEPTH, w.image(t, np.zeros((24, 32), np.uint16), "16UC1"), T0 + log * 33 * MS)
    with Playback(BagSource(w.path)) as camera:
        frames = list(camera)
        assert camera.counts.out_of_order == 1
    assert [(f.stamp_ns - T0) // (33 * MS) for f in frames] == [0, 2, 3]
    assert all(f.depth_mm is not None and not f.depth_mm.any() for f in frames)


def test_a_header_without_a_stamp_leaves_the_log_time(tmp_path):
    with bag(tmp_path, "mcap") as w:
        w.write(COLOR, w.image(0, rgb(0), "rgb8"), T0 + 5)
    assert frames_of(w.path)[0].stamp_ns == T0 + 5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.0, 0.5, 0.95])
def test_a_truncated_bag_is_a_typed_error(tmp_path, kind, share):
    path = write(tmp_path, kind, n=30)
    file = path if kind == "ros1" else next(f for f in path.iterdir() if f.suffix in (".mcap", ".db3"))
    file.write_bytes(file.read_bytes()[: int(share * file.stat().st_size)])
    with pytest.raises(DataError, match=r"flight"):
        frames_of(path)


def test_bags_that_are_none(tmp_path):
    with pytest.raises(DataError, match="there is no such bag"):
        frames_of(tmp_path / "none.bag")
    (tmp_path / "a.txt").write_text("no bag")
    for path in (tmp_path, tmp_path / "a.txt"):
        with pytest.raises(DataError, match="no bag that can be read"):
            frames_of(path)
    with bag(tmp_path, "mcap") as w:
        w.write(INFO, w.info(T0, LENS), T0)
    with pytest.raises(DataError, match=r"no topic of colour pictures.*Pictures are in: none"):
        frames_of(w.path)
    with pytest.raises(InputError, match="tolerance"):
        BagSource(w.path, BagConfig(tolerance_s=-1))


def test_without_the_extra_the_message_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'wigwag\[bags\]'"):
        BagSource(tmp_path)
