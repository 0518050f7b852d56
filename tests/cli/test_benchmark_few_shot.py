"""``wigwag benchmark few-shot`` on a small generated data set."""

import json
from pathlib import Path

import pytest

import wigwag
from tests.datasets.trees import tree
from wigwag.cli.app import run


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tree(tmp_path_factory.mktemp("utd"), (1, 6, 9), (1, 2, 3, 4), (1, 2, 3))


def few_shot(*words: object) -> int:
    return run(["benchmark", "few-shot", *map(str, words)])


def test_every_setting_is_recorded(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rows.json"
    assert few_shot("--data", small, "--recognizer", "classical", "--draws", 2, "--json", file) == 0
    rows = json.loads(file.read_text())
    assert [(row["setting"], row["examples"]) for row in rows] == [
        ("others", 1), ("others", 2), ("others", 4), ("others", 8), ("own+others", 1), ("own+others", 2),
        ("own", 1), ("own", 2),
    ]  # fmt: skip
    for row in rows:
        low, high = row["accuracy_ci95"]
        assert 0 <= low <= row["accuracy_mean"] <= high <= 1
        assert row["protocol"] == "cross-subject"
        assert (row["draws"], row["seed"], row["version"]) == (2, 0, wigwag.__version__)
        assert row["command"].startswith("wigwag benchmark few-shot --data ")
        assert all(not isinstance(value, dict) for value in row.values())
    assert [row["n_train"] for row in rows] == [3, 6, 12, 18, 21, 24, 3, 6]
    assert rows[-1]["accuracy_mean"] > 0.9, "movements this different are told apart"
    said = capsys.readouterr().out
    assert "own+others" in said
    assert str(file) in " ".join(said.split())


def test_one_setting_alone_and_everybody_left_out_once(small: Path, tmp_path: Path) -> None:
    file = tmp_path / "rows.json"
    words = ["--recognizer", "classical", "schneider", "--setting", "own", "--protocol", "loso", "--draws", 1]
    assert few_shot("--data", small, *words, "--json", file) == 0
    rows = json.loads(file.read_text())
    assert [(row["recognizer"], row["setting"], row["people"]) for row in rows] == [
        ("classical", "own", 4), ("classical", "own", 4), ("schneider", "own", 4), ("schneider", "own", 4),
    ]  # fmt: skip
    again = [*rows[0]["command"].replace(str(file), str(tmp_path / "2.json")).split()[1:]]
    assert run(again) == 0
    other = json.loads((tmp_path / "2.json").read_text())
    assert [row["accuracy_mean"] for row in other] == [row["accuracy_mean"] for row in rows]


def test_faults(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert few_shot("--data", small, "--draws", 0) == 2
    assert "--draws must be 1 or more, but got 0" in " ".join(capsys.readouterr().err.split())
    assert few_shot("--data", small, "--recognizer", "nobody") == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "recognizer must be one of" in said
    assert "heavy, encoded" in said
    assert few_shot("--data", tmp_path / "nowhere", "--recognizer", "classical") == 2
    assert "no such file or folder" in " ".join(capsys.readouterr().err.split())
