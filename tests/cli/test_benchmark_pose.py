"""``wigwag benchmark pose`` and ``wigwag benchmark camera``, for a moment."""

import json

import pytest

from wigwag.cli.app import run
from wigwag.errors import MissingExtraError, ModelError
from wigwag.evaluate import chain, pose
from wigwag.pose import engine as engines
from wigwag.pose.blazepose import BlazePose


@pytest.fixture
def networks():
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


@pytest.fixture
def litert_alone(networks, monkeypatch):
    real = engines.open_engine

    def without_mediapipe(name, *rest):
        if name == "mediapipe":
            raise MissingExtraError("The pose engine 'mediapipe' needs the package mediapipe")
        return real(name, *rest)

    monkeypatch.setattr(engines, "open_engine", without_mediapipe)


def words(captured):
    return " ".join(captured.split())


def test_litert_alone_says_so(litert_alone, tmp_path, capsys):
    file = tmp_path / "rows.json"
    assert run(["benchmark", "pose", "--seconds", "0.4", "--json", str(file)]) == 0
    rows = json.loads(file.read_text())
    assert [(r["engine"], r["model"], r["mode"]) for r in rows] == [
        ("litert", "full", mode) for mode in ("detect", "track", "search")
    ]
    for row in rows:
        assert row["ms_median"] > 0
        assert row["agreement_px_median"] is None
        assert row["command"].startswith("wigwag benchmark pose --seconds 0.4")
        assert row["seed"] == 3
    assert rows[1]["found"] == rows[1]["frames"] == 10
    assert rows[2]["found"] == 0
    assert "left out: The pose engine 'mediapipe' needs" in words(capsys.readouterr().out)


def test_engines_that_disagree_are_no_success(networks, monkeypatch, capsys):
    row = {
        "engine": "litert", "model": "full", "mode": "track", "data": "photos", "frames": 1, "found": 1,
        "timed": 1, "ms_median": 1.0, "ms_p95": 1.0, "times_litert": 1.0, "agreement_px_median": 1.2,
        "agreement_px_p95": 3.0,
    }  # fmt: skip
    both = [row, row | {"engine": "mediapipe"}]
    monkeypatch.setattr(pose, "measure", lambda *_, **__: iter(both))
    assert run(["benchmark", "pose"]) == 1
    said = words(capsys.readouterr().out)
    assert said.count("The engines disagree: full, photos: 1.20 px") == 1
    monkeypatch.setattr(pose, "measure", lambda *_, **__: iter([r | {"mode": "detect"} for r in both]))
    assert run(["benchmark", "pose"]) == 0, "a picture by itself is looked at twice by one of them"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["pose", "--seconds", "0"], "--seconds must be from 0.2 to 600, but got 0.0."),
        (["camera", "--seconds", "nan"], "--seconds must be from 0.2 to 600, but got nan."),
        (["pose", "--models"], "--models names no network"),
    ],
)
def test_faults(options, message, capsys):
    assert run(["benchmark", *options]) == 2
    assert message in words(capsys.readouterr().err)


def test_no_photos(tmp_path, capsys):
    assert run(["benchmark", "pose", "--photos", str(tmp_path)]) == 2
    assert "there is no picture in it" in words(capsys.readouterr().err)


def test_camera_to_pose(networks, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(chain, "_RENDERED_S", 0.2)
    monkeypatch.setattr(chain, "_ROUNDS", 2)
    file = tmp_path / "rows.json"
    assert run(["benchmark", "camera", "--seconds", "0.4", "--json", str(file)]) == 0
    rows = {r["measure"]: r for r in json.loads(file.read_text())}
    assert list(rows) == [
        "following",
        "searching, nobody there",
        "searching, somebody at 9 m",
        "from stamp to pose, 30 Hz",
        "besides the engine",
        "from stamp to pose, 120 Hz, engine at 15 Hz",
        "memory of a process",
    ]
    assert rows["following"]["frames"] >= 10
    assert rows["from stamp to pose, 120 Hz, engine at 15 Hz"]["skipped"] > 0
    assert 100 < rows["memory of a process"]["rss_mb"] < 600
    assert all(r["engine"] == "litert" and r["model"] == "full" for r in rows.values())
    assert "From a frame with depth, 640x480" in capsys.readouterr().out
