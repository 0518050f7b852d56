"""`wigwag watch` on the simulated camera: real pixels, real networks, and an account of them."""

import json

import pytest

from wigwag.cli.app import run
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose


@pytest.fixture(scope="module")
def networks():
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


def test_watching_the_simulator_finds_the_operator(networks, tmp_path, capsys):
    file = tmp_path / "watch.json"
    line = ["watch", "--camera", "sim:", "--engage", "first", "--duration-s", "1.5", "--json", str(file)]
    assert run(line) == 0
    (record,) = json.loads(file.read_text())
    assert record["frames_fresh"] >= 40
    assert record["sight_stale"] == 0
    assert record["operator_found"] > 0.9
    assert record["latency_ms_median"] is None, "in a recording no time passes but with its frames"
    assert "the operator's pose in" in capsys.readouterr().out


def test_nobody_who_has_not_engaged_is_the_operator(networks, tmp_path):
    file = tmp_path / "watch.json"
    assert run(["watch", "--camera", "sim:", "--duration-s", "1", "--json", str(file)]) == 0
    (record,) = json.loads(file.read_text())
    assert record["operator_found"] == 0


@pytest.mark.parametrize("line", [["--camera", "nothing"], ["--camera", "sim:", "--duration-s", "0"]])
def test_wrong_use_is_said(line, capsys):
    assert run(["watch", *line]) == 2
    assert "error" in capsys.readouterr().err
