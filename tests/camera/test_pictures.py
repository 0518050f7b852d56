import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.camera.pictures import as_rgb, picture_files, read_depth, read_rgb, to_millimetres
from wigwag.errors import DataError, InputError

from .fakes import picture


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [0, 1, 3, 4])
def test_16_bit_grey_and_transparent_pictures_become_rgb(kind, channels):
    rgb = picture(3) if channels >= 3 else np.repeat(picture(3)[:, :, :1], 3, axis=2)
    pixels = rgb.astype(kind) * (257 if kind is np.uint16 else 1)
    if channels == 4:
        pixels = np.concatenate([pixels, np.full((6, 8, 1), 77, kind)], axis=2)
    elif channels < 2:
        pixels = pixels[:, :, 0] if channels == 0 else pixels[:, :, :1]
    assert np.array_equal(as_rgb(pixels), rgb)
    assert np.array_equal(as_rgb(pixels, "bgr"), rgb[:, :, ::-1])
    assert as_rgb(pixels).flags.c_contiguous


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((4, 4, 2), np.uint8),
        np.zeros((4, 4), np.float32),
        np.zeros(4, np.uint8),
        np.zeros((0, 4), np.uint8),
    ],
)
def test_what_is_no_picture_is_refused(pixels):
    with pytest.raises(InputError, match=r"uint8 or uint16"):
        as_rgb(pixels)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_files_are_read_as_rgb(tmp_path, kind):
    rgb = picture(1, 32, 24)
    scale = 257 if kind is np.uint16 else 1
    cv2.imwrite(str(tmp_path / "a.png"), rgb[:, :, ::-1].astype(kind) * scale)
    cv2.imwrite(str(tmp_path / "grey.png"), rgb[:, :, 0].astype(kind) * scale)
    assert np.array_equal(read_rgb(tmp_path / "a.png"), rgb)
    assert np.array_equal(read_rgb(tmp_path / "grey.png"), np.repeat(rgb[:, :, :1], 3, axis=2))


def test_depth_files(tmp_path):
    depth = np.array([[0, 500], [13106, 13107]], np.uint16)
    cv2.imwrite(str(tmp_path / "d.png"), depth)
    assert np.array_equal(read_depth(tmp_path / "d.png"), depth)
    assert np.array_equal(read_depth(tmp_path / "d.png", 0.0002), [[0, 100], [2621, 2621]])
    assert np.array_equal(read_depth(tmp_path / "d.png", 0.005), [[0, 2500], [65530, 65535]])
    cv2.imwrite(str(tmp_path / "view.png"), picture())
    with pytest.raises(DataError, match=r"view.png: depth must be a 16-bit picture"):
        read_depth(tmp_path / "view.png")


def test_depth_that_is_no_number_or_too_far_is_a_hole():
    metres = np.array([[0.0, np.nan, np.inf], [-1.0, 65.6, 1.2344]], np.float32)
    assert to_millimetres(metres, 1.0).tolist() == [[0, 0, 0], [0, 0, 1234]]


@given(st.binary(max_size=200))
def test_damaged_files_are_typed_errors(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("pictures") / "bad.png"
    path.write_bytes(data)
    with pytest.raises(DataError, match=r"bad.png: is no picture"):
        read_rgb(path)


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_rgb(tmp_path / "none.png")
    with pytest.raises(DataError, match="no such folder"):
        picture_files(tmp_path / "none")
    with pytest.raises(DataError, match="no pictures"):
        picture_files(tmp_path)


def test_files_come_in_the_order_of_their_numbers(tmp_path):
    for name in ("frame10.png", "frame2.PNG", "frame1.png", "notes.txt", ".hidden.png"):
        (tmp_path / name).touch()
    assert [f.name for f in picture_files(tmp_path)] == ["frame1.png", "frame2.PNG", "frame10.png"]
