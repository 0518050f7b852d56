import cv2
import numpy as np
import pytest

from wigwag.camera.folder import FolderSource
from wigwag.camera.lens import LensConfig
from wigwag.camera.playback import Playback
from wigwag.errors import DataError, InputError

from .fakes import picture


def test_pictures_come_in_order_and_at_the_rate(tmp_path):
    pictures = [picture(i, 16, 12) for i in range(11)]
    for i, rgb in enumerate(pictures):
        cv2.imwrite(str(tmp_path / f"p{i}.png"), rgb[:, :, ::-1])
    with Playback(FolderSource(tmp_path, rate_hz=10.0, lens=LensConfig(hfov_deg=90.0))) as camera:
        frames = list(camera)
    assert all(np.array_equal(f.rgb, rgb) for f, rgb in zip(frames, pictures, strict=True))
    assert [f.stamp_ns for f in frames] == [i * 100_000_000 for i in range(11)]
    assert frames[0].intrinsics.fx == pytest.approx(8.0)
    assert frames[0].depth_mm is None


def test_grey_16_bit_and_pictures_of_other_sizes_go_on(tmp_path):
    cv2.imwrite(str(tmp_path / "0.png"), picture(0)[:, :, 0])
    cv2.imwrite(str(tmp_path / "1.png"), picture(0).astype(np.uint16) * 257)
    cv2.imwrite(str(tmp_path / "2.jpg"), picture(0, 20, 10))
    with Playback(FolderSource(tmp_path)) as camera:
        assert [(f.rgb.shape, f.intrinsics.width) for f in camera] == [
            ((6, 8, 3), 8),
            ((6, 8, 3), 8),
            ((10, 20, 3), 20),
        ]


def test_a_damaged_picture_is_named(tmp_path):
    cv2.imwrite(str(tmp_path / "0.png"), picture(0))
    (tmp_path / "1.png").write_bytes((tmp_path / "0.png").read_bytes()[:40])
    with Playback(FolderSource(tmp_path)) as camera:
        assert camera.latest() is not None
        with pytest.raises(DataError, match=r"1.png: is no picture"):
            camera.latest()


def test_folders_that_are_none(tmp_path):
    with pytest.raises(DataError, match="no pictures in it"):
        Playback(FolderSource(tmp_path))
    with pytest.raises(DataError, match="no such folder"):
        Playback(FolderSource(tmp_path / "none"))
    with pytest.raises(InputError, match="rate_hz"):
        FolderSource(tmp_path, rate_hz=0.0)
