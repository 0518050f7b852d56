import struct
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.camera.ros_images import depth_of, extrinsic_of, intrinsics_of, rgb_of
from wigwag.errors import DataError

from .fakes import picture

RGB = picture(5, 16, 12)
DEPTH = np.random.default_rng(2).integers(0, 9000, (12, 16)).astype(np.uint16)


def image(pixels, encoding, padding=0, big_endian=False):
    pixels = np.ascontiguousarray(pixels)
    height, width = pixels.shape[:2]
    if big_endian:
        pixels = pixels.astype(pixels.dtype.newbyteorder(">"))
    rows = np.pad(pixels.reshape(height, -1).view(np.uint8), ((0, 0), (0, padding)), constant_values=7)
    return SimpleNamespace(
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=int(big_endian),
        step=rows.shape[1],
        data=rows.ravel(),
    )


def compressed(data, kind):
    return SimpleNamespace(format=kind, data=np.frombuffer(data, np.uint8))


@pytest.mark.parametrize("padding", [0, 5])
@pytest.mark.parametrize(
    ("encoding", "pixels"),
    [
        ("rgb8", RGB),
        ("bgr8", RGB[:, :, ::-1]),
        ("8UC3", RGB[:, :, ::-1]),
        ("rgba8", np.dstack([RGB, DEPTH.astype(np.uint8)])),
        ("bgra8", np.dstack([RGB[:, :, ::-1], DEPTH.astype(np.uint8)])),
        ("rgb16", RGB.astype(np.uint16) * 257),
        ("bgr16", RGB[:, :, ::-1].astype(np.uint16) * 257),
    ],
)
def test_colours_rows_and_bytes_in_any_order(encoding, pixels, padding):
    for big in (False, True):
        assert np.array_equal(rgb_of(image(pixels, encoding, padding, big), "/t"), RGB)


@pytest.mark.parametrize(("encoding", "scale"), [("mono8", 1), ("8UC1", 1), ("mono16", 257), ("16UC1", 257)])
def test_grey_pictures(encoding, scale):
    grey = RGB[:, :, 0]
    pixels = grey if scale == 1 else grey.astype(np.uint16) * scale
    assert np.array_equal(rgb_of(image(pixels, encoding), "/t"), np.dstack([grey] * 3))


@pytest.mark.parametrize("encoding", ["bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"])
def test_mosaics_have_the_right_colours(encoding):
    colour = {"r": 200, "g": 120, "b": 40}
    a, b, c, d = (colour[letter] for letter in encoding[6:10])
    mosaic = np.tile(np.array([[a, b], [c, d]], np.uint8), (6, 8))
    middle = rgb_of(image(mosaic, encoding), "/t")[4:8, 4:12].reshape(-1, 3)
    assert np.abs(middle.astype(int) - (200, 120, 40)).max() <= 2


@pytest.mark.parametrize(
    ("encoding", "code"),
    [
        ("yuv422", cv2.COLOR_RGB2YUV_UYVY),
        ("uyvy", cv2.COLOR_RGB2YUV_UYVY),
        ("yuv422_yuy2", cv2.COLOR_RGB2YUV_YUY2),
    ],
)
def test_packed_colours(encoding, code):
    flat = np.broadcast_to(np.array([180, 120, 60], np.uint8), (12, 16, 3)).copy()
    packed = cv2.cvtColor(flat, code)
    assert np.abs(rgb_of(image(packed, encoding), "/t").astype(int) - flat).max() <= 3


def test_compressed_pictures():
    png = cv2.imencode(".png", RGB[:, :, ::-1])[1].tobytes()
    assert np.array_equal(rgb_of(compressed(png, "rgb8; png compressed bgr8"), "/t"), RGB)
    with pytest.raises(DataError, match=r"/t: is no picture"):
        rgb_of(compressed(png[:50], "png"), "/t")


def test_depth_in_millimetres_and_metres():
    assert np.array_equal(depth_of(image(DEPTH, "16UC1"), "/d"), DEPTH)
    assert np.array_equal(depth_of(image(DEPTH, "mono16", 3, True), "/d"), DEPTH)
    metres = DEPTH.astype(np.float32) / 1000
    metres[DEPTH == 0] = np.nan
    assert np.array_equal(depth_of(image(metres, "32FC1"), "/d"), DEPTH)
    with pytest.raises(DataError, match="must be 16UC1 or 32FC1"):
        depth_of(image(RGB, "rgb8"), "/d")


def test_compressed_depth():
    header = struct.pack("<iff", 0, 0.0, 0.0)
    png = cv2.imencode(".png", DEPTH)[1].tobytes()
    assert np.array_equal(depth_of(compressed(header + png, "16UC1; compressedDepth png"), "/d"), DEPTH)
    assert np.array_equal(depth_of(compressed(png, "16UC1; png compressed"), "/d"), DEPTH)
    a = 100.0 * 101.0  # as depth_image_transport quantises up to 10 m
    b = 1 - a / 10.0
    metres = DEPTH / 1e3
    counts = np.where(DEPTH > 200, a / np.maximum(metres, 0.2) + b, 0).astype(np.uint16)
    header = struct.pack("<iff", 0, a, b)
    quantised = cv2.imencode(".png", counts)[1].tobytes()
    got = depth_of(compressed(header + quantised, "32FC1; compressedDepth png"), "/d")
    assert not got[DEPTH <= 200].any()
    error_mm = np.abs(got.astype(float) - DEPTH)[DEPTH > 200]
    assert (error_mm <= 1e3 * metres[DEPTH > 200] ** 2 / a + 1).all()  # a count is finer when near
    for bad in (header, header + png[:30], b""):
        with pytest.raises(DataError):
            depth_of(compressed(bad, "16UC1; compressedDepth png"), "/d")
    coloured = cv2.imencode(".png", RGB)[1].tobytes()
    with pytest.raises(DataError, match="16-bit PNG"):
        depth_of(compressed(coloured, "jpeg"), "/d")


@pytest.mark.parametrize(
    "change", [{"data": np.zeros(10, np.uint8)}, {"step": 3}, {"height": 0}, {"encoding": "jpg2000"}]
)
def test_damaged_images_are_typed_errors(change):
    message = image(RGB, "rgb8")
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(DataError, match=r"^/t: "):
        rgb_of(message, "/t")


def test_intrinsics_of_both_generations():
    k = [600.0, 0, 320, 0, 601, 240, 0, 0, 1]
    one, two = SimpleNamespace(K=k, width=640, height=480), SimpleNamespace(k=k, width=640, height=480)
    assert intrinsics_of(one) == intrinsics_of(two)
    assert (intrinsics_of(two).fy, intrinsics_of(two).cx) == (601.0, 320.0)


@given(st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_any_quaternion_is_a_rotation(q):
    from scipy.spatial.transform import Rotation

    names = dict(zip("xyzw", q, strict=True))
    transform = SimpleNamespace(rotation=SimpleNamespace(**names), translation=SimpleNamespace(x=1, y=2, z=3))
    made = extrinsic_of(transform)
    assert np.allclose(made.rotation, Rotation.from_quat(q).as_matrix())
    assert made.translation_m.tolist() == [1, 2, 3]
