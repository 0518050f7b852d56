import json
import math

import numpy as np
import pytest

from wigwag.camera.calibration import assumed_intrinsics, check_intrinsics, read_calibration
from wigwag.camera.frame import Intrinsics
from wigwag.errors import DataError, InputError

COLOR = {"width": 640, "height": 480, "fx": 605.0, "fy": 604.0, "cx": 321.0, "cy": 239.0}


def written(tmp_path, data, name="camera.json"):
    path = tmp_path / name
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    return path


def test_the_edges_of_the_picture_are_the_field_of_view_apart():
    i = assumed_intrinsics(1280, 720, 69.0)
    left, right = i.deproject(np.array([[-0.5, 359.5], [1279.5, 359.5]]), np.ones(2))
    assert math.degrees(math.atan2(right[0], 1) - math.atan2(left[0], 1)) == pytest.approx(69.0)
    assert i.fx == i.fy


@pytest.mark.parametrize("hfov_deg", [0.0, 180.0, -60.0, math.nan])
def test_a_field_of_view_that_is_none(hfov_deg):
    with pytest.raises(InputError, match="hfov_deg"):
        assumed_intrinsics(640, 480, hfov_deg)


def test_own_form(tmp_path):
    pose = {"rotation": np.eye(3).tolist(), "translation_m": [0.015, 0, 0]}
    data = {"color": COLOR, "depth": COLOR, "depth_to_color": pose, "depth_unit_m": 0.0005, "rate_hz": 15}
    c = read_calibration(written(tmp_path, data))
    assert c.color == Intrinsics(605.0, 604.0, 321.0, 239.0, 640, 480) == c.depth
    assert c.depth_to_color.translation_m.tolist() == [0.015, 0, 0]
    assert (c.depth_unit_m, c.rate_hz) == (0.0005, 15.0)
    plain = read_calibration(written(tmp_path, {"color": COLOR}))
    assert (plain.depth, plain.depth_unit_m, plain.rate_hz) == (None, 0.001, None)


def test_the_form_of_open3d(tmp_path):
    matrix = [605.0, 0, 0, 0, 604.0, 0, 321.0, 239.0, 1]
    data = {"color_mode": "MJPG_720P", "width": 640, "height": 480, "intrinsic_matrix": matrix}
    c = read_calibration(written(tmp_path, data, "intrinsic.json"))
    assert c.color == Intrinsics(605.0, 604.0, 321.0, 239.0, 640, 480)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"fx": 0.0}, "above 0"),
        ({"fy": float("nan")}, "finite"),
        ({"fx": 0.6, "fy": 0.6}, "in pixels"),
        ({"fx": 605.0, "fy": 60.0}, "fit no camera"),
        ({"cx": 5000.0}, "principal point"),
    ],
)
def test_wrong_intrinsics_are_a_typed_error_that_names_the_file(tmp_path, change, what):
    with pytest.raises(DataError, match=rf"camera.json: color: .*{what}"):
        read_calibration(written(tmp_path, {"color": COLOR | change}))


def test_intrinsics_of_another_size():
    with pytest.raises(DataError, match="for pictures of 640 x 480, but the pictures are 1280 x 720"):
        check_intrinsics(Intrinsics(), (720, 1280, 3), "topic")


@pytest.mark.parametrize(
    "data",
    [
        "{",
        "[]",
        "3",
        {},
        {"color": {"width": 640}},
        {"color": None},
        {"color": COLOR, "depth": COLOR},
        {
            "color": COLOR,
            "depth": COLOR,
            "depth_to_color": {"rotation": [[1, 0], [0, 1]], "translation_m": [0]},
        },
        {"color": COLOR, "depth_unit_m": 0},
        {"color": COLOR, "rate_hz": -1},
        {"width": 640, "height": 480, "intrinsic_matrix": [1, 2]},
    ],
    ids=str,
)
def test_files_that_are_no_calibration(tmp_path, data):
    with pytest.raises(DataError, match=r"camera.json"):
        read_calibration(written(tmp_path, data))


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        read_calibration(tmp_path / "camera.json")
