from fractions import Fraction

import av
import numpy as np
import pytest

from wigwag.camera.lens import LensConfig
from wigwag.camera.playback import Playback
from wigwag.camera.video import VideoSource
from wigwag.errors import DataError

W, H = 64, 48


def write(path, n=30, *, codec="libx264", pix_fmt="yuv420p", options=None, stamps=None):
    """Write pictures whose brightness is their number."""
    with av.open(str(path), "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=15)
        stream.width, stream.height, stream.pix_fmt = W, H, pix_fmt
        stream.options = {"g": "5", "bf": "0"} if codec == "libx264" else {}
        rng = np.random.default_rng(0)
        for i in range(n):
            rgb = rng.integers(0, 20, (H, W, 3), dtype=np.uint8) + np.uint8(6 * i % 200)
            picture = av.VideoFrame.from_ndarray(rgb, format="rgb24")
            picture.pts = i if stamps is None else stamps[i]
            picture.time_base = Fraction(1, 15)
            container.mux(stream.encode(picture))
        container.mux(stream.encode())
    return path


@pytest.mark.parametrize("name", ["a.mp4", "a.mkv", "a.avi"])
def test_every_picture_comes_with_the_files_own_time(tmp_path, name):
    with Playback(VideoSource(write(tmp_path / name))) as camera:
        frames = list(camera)
    assert len(frames) == 30
    assert np.diff([f.stamp_ns for f in frames]) == pytest.approx(1e9 / 15, abs=1.1e6)  # mkv counts ms
    brightness = [f.rgb.mean() for f in frames]
    assert np.diff(brightness) == pytest.approx(6, abs=3)
    assert frames[0].rgb.shape == (H, W, 3)
    assert frames[0].depth_mm is None


def test_pictures_at_uneven_times_keep_them(tmp_path):
    with Playback(VideoSource(write(tmp_path / "a.mkv", n=4, stamps=[0, 1, 7, 9]))) as camera:
        stamps = np.array([f.stamp_ns for f in camera])
    assert stamps * 15e-9 == pytest.approx([0, 1, 7, 9], abs=0.02)


@pytest.mark.parametrize(("codec", "pix_fmt"), [("ffv1", "gray"), ("ffv1", "gray16le"), ("ffv1", "rgb48le")])
def test_grey_and_16_bit_videos(tmp_path, codec, pix_fmt):
    path = tmp_path / "a.mkv"
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=15)
        stream.width, stream.height, stream.pix_fmt = W, H, pix_fmt
        rgb = np.full((H, W, 3), 200, np.uint8)
        container.mux(stream.encode(av.VideoFrame.from_ndarray(rgb, format="rgb24").reformat(format=pix_fmt)))
        container.mux(stream.encode())
    with Playback(VideoSource(path)) as camera:
        (frame,) = camera
    assert frame.rgb.shape == (H, W, 3)
    assert abs(int(frame.rgb.mean()) - 200) <= 2


@pytest.mark.parametrize(
    ("name", "options"),
    [("a.mp4", {"movflags": "faststart"}), ("a.mkv", {}), ("a.avi", {})],
)
def test_a_truncated_video_gives_what_is_in_it_and_then_a_typed_error(tmp_path, name, options):
    whole = write(tmp_path / name, n=60, options=options).read_bytes()
    path = tmp_path / f"cut_{name}"
    path.write_bytes(whole[: len(whole) // 2])
    frames = []
    with (
        pytest.raises(DataError, match=r"cut_a.*cut short: it says \d.\d s but ends after"),
        Playback(VideoSource(path)) as camera,
    ):
        for frame in camera:
            frames.append(frame)
    assert 5 < len(frames) < 45


def test_a_video_whose_index_is_gone_cannot_be_opened(tmp_path):
    whole = write(tmp_path / "a.mp4").read_bytes()
    path = tmp_path / "cut.mp4"
    path.write_bytes(whole[: len(whole) // 2])  # the index is at the end
    with pytest.raises(DataError, match=r"cut.mp4: is no video that FFmpeg reads, or was cut short"):
        Playback(VideoSource(path))


def test_a_film_cut_short_by_a_crash_plays_as_far_as_it_goes(tmp_path):
    options = {"movflags": "frag_keyframe+empty_moov"}  # as wigwag writes its own films: no length inside
    whole = write(tmp_path / "a.mp4", n=60, options=options).read_bytes()
    path = tmp_path / "cut.mp4"
    path.write_bytes(whole[: len(whole) // 2])
    with Playback(VideoSource(path)) as camera:
        assert 20 < len(list(camera)) < 40


def test_a_damaged_stretch_is_left_out(tmp_path):
    data = bytearray(write(tmp_path / "a.mkv", n=60).read_bytes())
    middle = len(data) // 2
    data[middle : middle + 400] = np.random.default_rng(1).bytes(400)
    path = tmp_path / "damaged.mkv"
    path.write_bytes(data)
    with Playback(VideoSource(path)) as camera:
        stamps = [f.stamp_ns for f in camera]
    assert 30 < len(stamps) <= 60
    assert stamps[-1] > 3.8e9  # to the end
    assert np.all(np.diff(stamps) > 0)


def test_files_that_are_no_video(tmp_path):
    noise = tmp_path / "noise.mp4"
    noise.write_bytes(np.random.default_rng(0).bytes(5000))
    empty = tmp_path / "empty.mp4"
    empty.touch()
    for path in (noise, empty):
        with pytest.raises(DataError, match=r"no video|cut short"):
            Playback(VideoSource(path))
    with pytest.raises(DataError, match="no such file"):
        Playback(VideoSource(tmp_path / "none.mp4"))
    sound = tmp_path / "sound.wav"
    with av.open(str(sound), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000)
        stream.layout = "mono"
        beep = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        beep.sample_rate = 8000
        container.mux(stream.encode(beep))
    with pytest.raises(DataError, match="no pictures in it"):
        Playback(VideoSource(sound))


def test_the_lens_is_what_was_said(tmp_path):
    with Playback(VideoSource(write(tmp_path / "a.mp4", n=1), LensConfig(hfov_deg=90.0))) as camera:
        assert next(iter(camera)).intrinsics.fx == pytest.approx(32.0)
