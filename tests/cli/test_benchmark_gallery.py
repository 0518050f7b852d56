"""``wigwag benchmark gallery`` on a small generated data set."""

import json
from pathlib import Path

import pytest

from tests.datasets.trees import tree
from wigwag.cli.app import run

pytest.importorskip("usearch", reason="needs usearch: pip install 'wigwag[benchmark]'")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tree(tmp_path_factory.mktemp("utd"), range(1, 6), (1, 2, 3), (1, 2))


def gallery(*words: object) -> int:
    return run(["benchmark", "gallery", *map(str, words)])


def test_records_table_and_plot(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, plot = tmp_path / "rows.json", tmp_path / "plot.png"
    words = ["--sizes", 40, 400, "--shortlist", 60, "--json", file, "--out", plot]
    assert gallery("--data", small, *words) == 0
    rows = json.loads(file.read_text())
    assert [row["size"] for row in rows] == [40, 400]
    assert all(0 <= row["recall"] <= 1 and row["ms_per_query_median"] > 0 for row in rows)
    assert rows[0]["recall"] == 1
    assert rows[1]["command"].startswith(f"wigwag benchmark gallery --data {small} --sizes 40 400")
    assert plot.stat().st_size > 1000
    assert "Time grows with size to the power of" in capsys.readouterr().out


def test_faults(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert gallery("--data", small, "--sizes", 5, 5) == 2
    assert "must be positive and rise, but got 5, 5" in " ".join(capsys.readouterr().err.split())
    assert gallery("--data", small, "--shortlist", 0) == 2
    assert "shortlist" in " ".join(capsys.readouterr().err.split())
    assert gallery("--data", tmp_path / "nowhere") == 2
    assert "nowhere" in " ".join(capsys.readouterr().err.split())
