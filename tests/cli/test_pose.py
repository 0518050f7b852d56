"""``wigwag pose`` and ``wigwag doctor``: what they write, and what they say when something is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from wigwag import __version__
from wigwag.cli.doctor import Doctor, check_packages
from wigwag.cli.pose import PoseCommand, read_picture
from wigwag.errors import InputError, ModelError
from wigwag.pose.models import DETECTOR, LANDMARKERS, find_model

PHOTOS = Path(__file__).parents[2].parent / "shared" / "data" / "operator_photos"


@pytest.fixture(scope="module")
def models() -> None:
    try:
        find_model(DETECTOR)
        find_model(LANDMARKERS["full"])
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


@pytest.fixture
def blank(tmp_path: Path) -> Path:
    path = tmp_path / "blank.png"
    assert cv2.imwrite(str(path), np.full((120, 160, 3), 90, np.uint8))
    return path


@pytest.mark.usefixtures("models")
def test_bad_files_are_named_and_the_rest_goes_on(
    tmp_path: Path, blank: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, empty, gone = tmp_path / "text.jpg", tmp_path / "empty.png", tmp_path / "gone.jpg"
    text.write_text("no picture at all")
    empty.touch()
    out, records = tmp_path / "drawn", tmp_path / "deep" / "pose.json"
    code = PoseCommand((text, empty, gone, tmp_path, blank), out=out, json=records).run()
    said = capsys.readouterr()
    assert code == 2
    assert f"{text}: is no picture that can be read (17 bytes)" in said.err
    assert f"{empty}: is no picture that can be read (0 bytes)" in said.err
    assert f"{gone}: there is no such file" in said.err
    assert f"{tmp_path}: is a folder" in said.err
    assert said.err.count("Expected a picture file such as JPEG or PNG.") == 4
    assert "Traceback" not in said.err + said.out
    assert f"nobody found: {blank}" in said.out
    assert [path.name for path in out.iterdir()] == ["blank.jpg"]
    rows = json.loads(records.read_text())
    assert [row["file"] for row in rows] == [str(p) for p in (text, empty, gone, tmp_path, blank)]
    assert not any(row["found"] for row in rows)
    assert rows[-1]["error"] is None
    assert {row["command"] for row in rows} == {"wigwag pose"}
    assert {row["version"] for row in rows} == {__version__}


@pytest.mark.usefixtures("models")
def test_real_photos_are_drawn_and_recorded(tmp_path: Path) -> None:
    photos = tuple(sorted(PHOTOS.glob("land/*.jpg"))[:2])
    if not photos:
        pytest.skip(f"needs the operator photos in {PHOTOS}")
    records = tmp_path / "pose.json"
    assert PoseCommand(photos, out=tmp_path, json=records).run() == 0
    for photo, row in zip(photos, json.loads(records.read_text()), strict=True):
        assert row["found"]
        assert np.shape(row["landmarks_px"]) == (33, 2)
        assert np.shape(row["visibility"]) == (33,)
        drawn, original = cv2.imread(str(tmp_path / photo.name)), cv2.imread(str(photo))
        assert drawn.shape == original.shape
        u, v = np.mean(np.array(row["landmarks_px"])[[11, 23]], axis=0).astype(int)
        change = np.abs(drawn.astype(int) - original).max(axis=2)
        assert change[v - 3 : v + 4, u - 3 : u + 4].max() > 60, "the trunk's side is drawn"
        assert np.median(change[60:]) < 10, "the rest of the picture is left alone"


@pytest.mark.usefixtures("models")
def test_pictures_of_one_name_do_not_overwrite_each_other(tmp_path: Path, blank: Path) -> None:
    twin = tmp_path / "other" / blank.name
    twin.parent.mkdir()
    twin.write_bytes(blank.read_bytes())
    out = tmp_path / "drawn"
    assert PoseCommand((blank, twin, blank), out=out).run() == 0
    assert sorted(path.name for path in out.iterdir()) == ["blank.jpg", "other_blank.jpg"]


def test_wrong_use_is_an_error_that_helps(tmp_path: Path, blank: Path) -> None:
    with pytest.raises(InputError, match="No picture was given"):
        PoseCommand(()).run()
    with pytest.raises(InputError, match=r"cannot be made a folder.*--out"):
        PoseCommand((blank,), out=blank).run()
    with pytest.raises(ModelError, match="To place it by hand"):
        PoseCommand((blank,), out=tmp_path / "drawn", models_dir=tmp_path).run()


def test_pictures_come_as_rgb_whatever_they_are(tmp_path: Path) -> None:
    red = np.zeros((8, 9, 3), np.uint8)
    red[..., 2] = 255
    for name, picture in (
        ("bgr.png", red),
        ("alpha.png", np.dstack([red, np.full((8, 9), 128, np.uint8)])),
        ("deep.png", red.astype(np.uint16) * 257),
    ):
        cv2.imwrite(str(tmp_path / name), picture)
        np.testing.assert_array_equal(read_picture(tmp_path / name)[0, 0], [255, 0, 0])
    cv2.imwrite(str(tmp_path / "grey.png"), np.full((8, 9), 77, np.uint8))
    assert read_picture(tmp_path / "grey.png").shape == (8, 9, 3)


@pytest.mark.usefixtures("models")
def test_doctor_where_all_is_well(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    records = tmp_path / "doctor.json"
    assert Doctor(json=records).run() == 0
    rows = {row["check"]: row for row in json.loads(records.read_text())}
    assert {"Python", "numpy", "ai-edge-litert", DETECTOR.name, "pose network"} <= set(rows)
    assert all(row["state"] != "missing" for row in rows.values())
    assert all(row["command"] == "wigwag doctor" for row in rows.values())
    assert "ms a frame" in rows["pose network"]["detail"]
    assert "All that is needed works here." in capsys.readouterr().out


def test_doctor_where_the_networks_are_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("WIGWAG_MODELS", raising=False)
    assert Doctor().run() == 1
    said = capsys.readouterr().out
    assert f"{DETECTOR.name}: the first run that needs it fetches it; or now: wigwag doctor --fetch" in said
    assert "npm pack" in said, "how to get the optional ones"
    assert not list(tmp_path.rglob("*.tflite")), "looking fetches nothing"


def test_doctor_where_a_network_is_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("WIGWAG_MODELS", str(tmp_path))
    (tmp_path / DETECTOR.name).write_bytes(b"damaged")
    assert Doctor().run() == 1
    assert f"{tmp_path / DETECTOR.name}: its SHA-256 sum is not" in capsys.readouterr().out


def test_doctor_names_packages_that_are_missing() -> None:
    found = list(check_packages(["numpy>=1.26", "no-such-package-at-all>=3; python_version>'3'"]))
    assert [(f.check, f.state) for f in found] == [("numpy", "ok"), ("no-such-package-at-all", "missing")]
    assert found[1].fix.endswith("python -m pip install 'no-such-package-at-all>=3'")
