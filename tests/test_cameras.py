import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from wigwag import cameras
from wigwag.camera.live import LiveCamera
from wigwag.camera.playback import Playback
from wigwag.cameras import addresses, forms, open_camera
from wigwag.errors import CameraError, DataError, InputError


@pytest.mark.parametrize("address", ["", "0", "webcam", "flight.mp4", "rtsp://host/s", "Sim:", "/dev/video0"])
def test_a_bad_address_lists_the_forms(address):
    with pytest.raises(InputError) as error:
        open_camera(address)
    for form in (
        "webcam:0",
        "video:FILE",
        "folder:DIR",
        "pairs:DIR",
        "realsense:",
        "FILE.bag",
        "bag:DIR?",
        "sim:",
    ):
        assert form in str(error.value)
    assert repr(address) in str(error.value)


@pytest.mark.parametrize(
    ("address", "error"),
    [
        ("webcam:", InputError),
        ("webcam:77", CameraError),
        ("webcam:0?width=0", InputError),
        ("video:", InputError),
        ("video:none.mp4", DataError),
        ("video:a.mp4?hfov_deg=0", InputError),
        ("video:a.mp4?intrinsics=none.json", DataError),
        ("folder:none", DataError),
        ("folder:none?rate_hz=0", InputError),
        ("pairs:none", DataError),
        ("pairs:none?rate_hz=0", InputError),
        ("sim:window", InputError),
        ("sim:?seed=1.5", InputError),
        ("sim:?duration_s=0", InputError),
        ("sim:?rate_hz=0", InputError),
        ("sim:?speed=2", InputError),
    ],
)
def test_wrong_addresses_are_typed_errors(address, error):
    with pytest.raises(error):
        open_camera(address)


def test_passwords_stay_out_of_messages():
    for address in ("rtsp://me:secret@host/s", "webcam:rtsp://me:secret@host/s?width="):
        with pytest.raises(InputError) as error:
            open_camera(address)
        assert "secret" not in str(error.value)


@pytest.mark.parametrize("address", ["bag:none.bag", "bag:?color=/a"])
def test_bags_that_are_not_there(address):
    pytest.importorskip("rosbags", reason="needs rosbags: pip install 'wigwag[bags]'")
    with pytest.raises(InputError):
        open_camera(address)


def test_the_simulator_shows_the_same_again_and_an_operator():
    def frames(seed):
        with open_camera(f"sim:?seed={seed}&duration_s=0.2&rate_hz=20&distance_m=5") as camera:
            assert isinstance(camera, Playback)
            return list(camera)

    one, again, other = frames(3), frames(3), frames(4)
    assert len(one) == 4
    assert all(
        np.array_equal(a.rgb, b.rgb) and np.array_equal(a.depth_mm, b.depth_mm)
        for a, b in zip(one, again, strict=True)
    )
    assert not np.array_equal(one[0].rgb, other[0].rgb)
    assert np.diff([f.stamp_ns for f in one]) == pytest.approx(5e7, abs=1)
    middle = one[0].depth_mm[200:280, 300:340]
    assert np.abs(np.median(middle[middle > 0]) - 5000) < 400  # the operator stands there


def test_a_folder_by_its_address_waits_or_plays_in_real_time(tmp_path):
    for i in range(5):
        cv2.imwrite(str(tmp_path / f"{i}.png"), np.full((12, 16, 3), 40 * i, np.uint8))
    with open_camera(f"folder:{tmp_path}?rate_hz=10") as camera:
        assert isinstance(camera, Playback)
        assert [f.stamp_ns for f in camera] == [i * 100_000_000 for i in range(5)]
    with open_camera(f"folder:{tmp_path}?rate_hz=1000&realtime=1") as camera:
        assert isinstance(camera, LiveCamera)
        frames = list(camera)
        assert 1 <= len(frames) <= 5
        assert frames[-1].rgb.max() == 160  # the last picture is never lost
        assert camera.counts.handed + camera.counts.skipped == 5


def test_the_documentation_knows_every_form_and_option():
    text = (Path(__file__).parents[1] / "docs" / "cameras.md").read_text()
    for kind, form in cameras._FORMS.items():
        assert f"`{kind}:" in text
        for option in form.options:
            assert f"`{option}`" in text, (kind, option)
    assert len(addresses()) == len(forms().splitlines()) == 7


def test_a_source_is_loaded_only_when_it_is_used():
    code = (
        "import sys; import wigwag.cameras; "
        "heavy = {'cv2', 'av', 'numba', 'rosbags', 'pyrealsense2', 'wigwag.sim.world'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
