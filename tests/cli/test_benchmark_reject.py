"""``wigwag benchmark reject`` on a small generated data set."""

import json
from pathlib import Path

import pytest

from tests.datasets.skeletons import precog_arrays, saved, takes
from tests.datasets.trees import tree
from wigwag.cli.app import run


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All classes, two training people and one test person."""
    return tree(tmp_path_factory.mktemp("utd"), range(1, 28), (1, 2, 3), (1,))


def reject(*words: object) -> int:
    return run(["benchmark", "reject", *map(str, words)])


def test_every_setting_and_draw_is_recorded(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = saved(tmp_path / "precog.npz", precog_arrays(takes((1, 2), (1, 2), (1,), 100)))
    file = tmp_path / "rows.json"
    words = ["--recognizer", "classical", "--draws", 2, "--precog", other, "--precog-clips", 3]
    assert reject("--data", small, *words, "--json", file) == 0
    rows = json.loads(file.read_text())
    assert [(row["known"], row["unknown"], row["draw"]) for row in rows] == [
        (6, 21, 0), (6, 21, 1), (6, 21, 0), (6, 21, 1), (21, 6, 0), (21, 6, 1),
    ]  # fmt: skip
    assert len({row["background"] for row in rows}) == 3
    for row in rows:
        for key in (
            "auroc", "false_accept_at_95", "true_accept_at_threshold", "false_accept_at_threshold"
        ):  # fmt: skip
            assert 0 <= row[key] <= 1
        assert len(row["known_classes"]) == row["known"]
        assert row["command"].startswith("wigwag benchmark reject --data ")
    assert rows[0]["auroc"] > 0.7, "what was taught as no gesture is told apart"
    said = capsys.readouterr().out
    assert "PRECOG: 4 clips of 2 people" in said
    assert "21 of 27" in said


def test_faults(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reject("--data", small, "--draws", 0) == 2
    assert "--draws must be 1 or more, but got 0" in " ".join(capsys.readouterr().err.split())
    assert reject("--data", small, "--recognizer", "classical", "--precog", tmp_path / "no.npz") == 2
    assert "no.npz: no such file or folder. PRECOG" in " ".join(capsys.readouterr().err.split())
    some = ["--recognizer", "classical", "--precog", tmp_path, "--precog-clips", 0]
    assert reject("--data", small, *some) == 2
    assert "--precog-clips must be 1 or more" in " ".join(capsys.readouterr().err.split())
