import json

import cv2
import numpy as np
import pytest

from wigwag.camera.pairs import PairsSource
from wigwag.camera.playback import Playback
from wigwag.errors import DataError, InputError

from .fakes import picture

COLOR = {"width": 32, "height": 24, "fx": 40.0, "fy": 40.0, "cx": 15.5, "cy": 11.5}
SMALL = {"width": 16, "height": 12, "fx": 15.0, "fy": 15.0, "cx": 7.5, "cy": 5.5}
POSE = {"rotation": np.eye(3).tolist(), "translation_m": [0.0, 0.0, 0.0]}


def depth(seed=0, shape=(24, 32)):
    return np.random.default_rng(seed).integers(1, 6000, shape).astype(np.uint16)


def write(folder, n=3, *, calibration=None, shape=(24, 32), name="camera.json", color="color"):
    for part in (color, "depth"):
        (folder / part).mkdir()
    for i in range(n):
        cv2.imwrite(str(folder / color / f"{i:05d}.png"), picture(i, 32, 24)[:, :, ::-1])
        cv2.imwrite(str(folder / "depth" / f"{i:05d}.png"), depth(i, shape))
    (folder / name).write_text(json.dumps(calibration or {"color": COLOR}))
    return folder


def test_pairs_become_frames(tmp_path):
    with Playback(PairsSource(write(tmp_path, calibration={"color": COLOR, "rate_hz": 15}))) as camera:
        frames = list(camera)
    assert len(frames) == 3
    for i, f in enumerate(frames):
        assert np.array_equal(f.rgb, picture(i, 32, 24))
        assert np.array_equal(f.depth_mm, depth(i))
        assert f.stamp_ns == round(i * 1e9 / 15)
        assert f.intrinsics.fx == 40.0


def test_as_open3d_writes_an_azure_kinect(tmp_path):
    matrix = [40.0, 0, 0, 0, 41.0, 0, 15.5, 11.5, 1]
    data = {"color_mode": "MJPG_720P", "width": 32, "height": 24, "intrinsic_matrix": matrix}
    with Playback(PairsSource(write(tmp_path, calibration=data, name="intrinsic.json"), rate_hz=5)) as camera:
        frames = list(camera)
    assert frames[1].intrinsics.fy == 41.0
    assert frames[1].stamp_ns == 200_000_000


def test_depth_of_another_camera_is_aligned(tmp_path):
    calibration = {"color": COLOR, "depth": SMALL, "depth_to_color": POSE}
    write(tmp_path, n=1, calibration=calibration, shape=(12, 16))
    flat = np.full((12, 16), 1234, np.uint16)
    cv2.imwrite(str(tmp_path / "depth" / "00000.png"), flat)
    with Playback(PairsSource(tmp_path)) as camera:
        (frame,) = camera
    assert frame.depth_mm.shape == (24, 32)
    assert (frame.depth_mm == 1234).all()


def test_depth_of_another_size_is_a_typed_error(tmp_path):
    with (
        Playback(PairsSource(write(tmp_path, shape=(12, 16)))) as camera,
        pytest.raises(DataError, match=r"00000.png: depth is 16 x 12, colour 32 x 24.*depth_to_color"),
    ):
        camera.latest()


def test_depth_that_is_not_of_its_calibrations_size(tmp_path):
    calibration = {"color": COLOR, "depth": SMALL, "depth_to_color": POSE}
    with (
        Playback(PairsSource(write(tmp_path, calibration=calibration))) as camera,
        pytest.raises(DataError, match=r"00000.png: .*\(12, 16\)"),
    ):
        camera.latest()


def test_wrong_intrinsics_are_a_typed_error(tmp_path):
    with (
        Playback(PairsSource(write(tmp_path, calibration={"color": SMALL}))) as camera,
        pytest.raises(DataError, match=r"camera.json: the intrinsics are for pictures of 16 x 12"),
    ):
        camera.latest()


def test_all_zero_depth_and_missing_depth_go_on(tmp_path):
    write(tmp_path, color="rgb")
    cv2.imwrite(str(tmp_path / "depth" / "00000.png"), np.zeros((24, 32), np.uint16))
    (tmp_path / "depth" / "00001.png").unlink()
    with Playback(PairsSource(tmp_path)) as camera:
        frames = list(camera)
    assert not frames[0].depth_mm.any()
    assert frames[1].depth_mm is None
    assert frames[2].depth_mm.any()


def test_a_truncated_depth_picture_is_named(tmp_path):
    path = write(tmp_path) / "depth" / "00001.png"
    path.write_bytes(path.read_bytes()[:60])
    with Playback(PairsSource(tmp_path)) as camera:
        assert camera.latest() is not None
        with pytest.raises(DataError, match=r"depth.00001.png: is no picture"):
            camera.latest()


def test_what_is_missing_is_named(tmp_path):
    with pytest.raises(DataError, match=r"no camera.json or intrinsic.json"):
        Playback(PairsSource(tmp_path))
    write(tmp_path)
    for i in range(3):
        (tmp_path / "depth" / f"{i:05d}.png").rename(tmp_path / "depth" / f"d{i}.png")
    with pytest.raises(DataError, match=r"the same name; the first are 00000.png and d0.png"):
        Playback(PairsSource(tmp_path))
    with pytest.raises(InputError, match="rate_hz"):
        PairsSource(tmp_path, rate_hz=-1)
