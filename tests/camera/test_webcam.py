import json

import av
import numpy as np
import pytest

from wigwag.camera.address import hide_password
from wigwag.camera.lens import LensConfig
from wigwag.camera.live import LiveCamera, ReconnectConfig
from wigwag.camera.webcam import WebcamConfig, WebcamSource
from wigwag.errors import CameraError, DataError, InputError

from .fakes import picture


class Capture:
    """Stands in for ``cv2.VideoCapture``; an item that is None is a grab that fails."""

    def __init__(self, items, there=True):
        self.items, self.there, self.released = items, there, False

    def isOpened(self):
        return self.there

    def grab(self):
        if not self.items:
            return False
        self.now = self.items.pop(0)
        return self.now is not None

    def retrieve(self):
        return (False, None) if isinstance(self.now, str) else (True, self.now)

    def release(self):
        self.released = True


def source(items, **more):
    captures = []

    def make(target):
        captures.append(Capture(items))
        return captures[-1]

    stamps = iter(range(0, 10**12, 33_000_000))
    made = WebcamSource("0", capture=make, now_ns=lambda: next(stamps), **more)
    made.captures = captures
    return made


def test_pictures_become_frames_with_an_assumed_lens():
    bgr = picture(1, 64, 48)
    webcam = source([bgr, bgr[:, :, 0], bgr.astype(np.uint16) * 257])
    webcam.open()
    frame = webcam.read()
    assert np.array_equal(frame.rgb, bgr[:, :, ::-1])
    assert frame.depth_mm is None
    assert (frame.intrinsics.width, frame.intrinsics.height) == (64, 48)
    assert frame.intrinsics.fx == pytest.approx(32 / np.tan(np.radians(32.5)))
    assert webcam.read().rgb.shape == (48, 64, 3)  # grey
    assert np.array_equal(webcam.read().rgb, bgr[:, :, ::-1])  # 16 bits


def test_unplugged_and_back():
    webcam = source([picture(1), None, picture(2)])
    with LiveCamera(webcam, wait=lambda event, s: event.is_set()) as camera:
        stamps = []
        frames = iter(camera)
        while camera.counts.received < 2 or not stamps:
            stamps.append(next(frames).stamp_ns)
        assert camera.counts.reconnects >= 1
    assert webcam.captures[0].released
    assert sorted(stamps) == stamps


def test_what_cannot_be_decoded_counts_as_lost():
    webcam = source(["damaged"])
    webcam.open()
    with pytest.raises(CameraError, match="could not be decoded"):
        webcam.read()


def test_a_camera_that_is_not_there():
    webcam = WebcamSource("9", capture=lambda target: Capture([], there=False))
    with pytest.raises(CameraError, match="webcam:9: OpenCV cannot open it"):
        webcam.open()
    with pytest.raises(CameraError):
        webcam.read()


def test_a_url_that_opencv_reads(tmp_path):
    path = tmp_path / "stream.avi"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mjpeg", rate=10)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuvj420p"
        for i in range(3):
            grey = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 60 * (i + 1), np.uint8), format="rgb24")
            container.mux(stream.encode(grey))
        container.mux(stream.encode())
    webcam = WebcamSource(f"file://{path}")
    webcam.open()
    assert [round(float(webcam.read().rgb.mean()) / 60) for _ in range(3)] == [1, 2, 3]
    with pytest.raises(CameraError, match="stream ended"):
        webcam.read()
    webcam.close()
    webcam.close()


def test_a_url_that_never_comes_back_is_given_up(tmp_path):
    with pytest.raises(CameraError):
        LiveCamera(WebcamSource(f"file://{tmp_path}/none.avi"), ReconnectConfig(give_up_s=0.0))


def test_a_pipeline_without_gstreamer_says_what_it_takes():
    with pytest.raises(CameraError, match="built with GStreamer"):
        WebcamSource("videotestsrc num-buffers=0 ! fakesink").open()


def test_passwords_stay_out_of_messages():
    assert hide_password("rtsp://h/s@2") == "rtsp://h/s@2"
    webcam = WebcamSource("rtsp://me:secret@h/s", capture=lambda target: Capture([], there=False))
    with pytest.raises(CameraError) as error:
        webcam.open()
    assert "secret" not in str(error.value)
    assert "me:***@h" in str(error.value)


def test_a_lens_from_a_file(tmp_path):
    path = tmp_path / "camera.json"
    lens = {"width": 8, "height": 6, "fx": 9.0, "fy": 9.0, "cx": 4.0, "cy": 3.0}
    path.write_text(json.dumps({"color": lens}))
    webcam = source([picture(1), picture(2, 16, 12)], config=WebcamConfig(lens=LensConfig(intrinsics=path)))
    webcam.open()
    assert webcam.read().intrinsics.fx == 9.0
    with pytest.raises(DataError, match="pictures are 16 x 12"):
        webcam.read()


def test_what_is_wrong_is_known_before_the_camera_is_opened():
    with pytest.raises(InputError, match="timeout_s must be above 0"):
        WebcamConfig(timeout_s=0.0)
    with pytest.raises(InputError, match="webcam:0"):
        WebcamSource("")
    with pytest.raises(InputError, match="hfov_deg"):
        WebcamSource("0", WebcamConfig(lens=LensConfig(hfov_deg=0.0)))
