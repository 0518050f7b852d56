"""``wigwag benchmark dtw`` with few references."""

import json

import pytest

from wigwag.cli.app import run
from wigwag.evaluate import dtw as module


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(module, "REFERENCES", 30)
    monkeypatch.setattr(module, "PEERS", ())


def benchmark(*words):
    return run(["benchmark", "dtw", *map(str, words)])


def test_records_and_table(few, tmp_path, capsys):
    file = tmp_path / "rows.json"
    assert benchmark("--features", 16, "--queries", 6, "--json", file) == 0
    rows = json.loads(file.read_text())
    cases = ("D=16, band 6", "D=16, unconstrained")
    assert {row["case"] for row in rows} == {c + end for c in cases for end in ("", ", nearest only")}
    for row in rows:
        assert row["ms_per_query_median"] > 0
        assert row["disagreement"] <= 1e-5
        assert row["inputs"] == "random walks"
        assert row["command"].startswith("wigwag benchmark dtw --features 16 --queries 6")
        if row["library"] == "wigwag":
            assert row["times_ours"] == 1
    assert "30 references of 64 frames (random walks)" in " ".join(capsys.readouterr().out.split())


def test_disagreement_is_no_success(few, monkeypatch, capsys):
    monkeypatch.setattr(module, "AGREEMENT", -1.0)
    assert benchmark("--features", 16, "--queries", 1) == 1
    assert (
        "Libraries disagree by more than 1e-5: D=16, band 6; D=16, unconstrained" in capsys.readouterr().out
    )


def test_faults(tmp_path, capsys):
    assert benchmark("--queries", 0) == 2
    assert "--queries must be 1 or more, but got 0" in " ".join(capsys.readouterr().err.split())
    assert benchmark("--data", tmp_path / "nowhere") == 2
    assert "nowhere" in " ".join(capsys.readouterr().err.split())
