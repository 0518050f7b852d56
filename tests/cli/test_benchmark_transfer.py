"""``wigwag benchmark transfer`` on a small generated data set."""

import json
from pathlib import Path

import pytest

from tests.datasets.skeletons import msr_arrays, saved, takes
from wigwag.cli.app import run


def transfer(*words: object) -> int:
    return run(["benchmark", "transfer", *map(str, words)])


def test_every_recogniser_is_recorded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recorded = takes((1, 2, 3), (1, 3, 5), (1, 2))
    recorded[3, 5, 2][:] = 0
    data = saved(tmp_path / "msr_action3d.npz", msr_arrays(recorded))
    file = tmp_path / "rows.json"
    assert transfer("--data", data, "--recognizer", "classical", "heavy", "--json", file) == 0
    rows = json.loads(file.read_text())
    assert [row["recognizer"] for row in rows] == ["classical", "heavy"]
    for row in rows:
        assert (row["data"], row["protocol"], row["people"], row["cases"]) == ("MSR-Action3D", "loso", 3, 17)
        assert row["accuracy_mean"] > 0.8
    assert rows[0]["ece"] is None
    assert 0 <= rows[1]["ece"] <= 1
    assert "a03_s05_e02: nobody is seen" in capsys.readouterr().out
    assert (
        transfer("--data", data, "--recognizer", "classical", "--people", "s01", "s03", "--json", file) == 0
    )
    assert json.loads(file.read_text())[0]["people"] == 2


def test_faults(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert transfer("--data", tmp_path, "--recognizer", "classical") == 2
    assert "MSR-Action3D comes from Li, Zhang, Liu 2010" in " ".join(capsys.readouterr().err.split())
    data = saved(tmp_path / "msr_action3d.npz", msr_arrays(takes()))
    assert transfer("--data", data, "--seeds", 0) == 2
    assert "--seeds must be 1 or more" in " ".join(capsys.readouterr().err.split())
    assert transfer("--data", data, "--recognizer", "classical", "--people", "s01") == 2
    assert "two people or more, but got s01" in " ".join(capsys.readouterr().err.split())
