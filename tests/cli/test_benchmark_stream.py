"""``wigwag benchmark stream`` on a small generated data set."""

import json
from pathlib import Path

import pytest

from tests.datasets.skeletons import precog_arrays, saved, takes
from tests.datasets.trees import mat
from tests.evaluate.stream.people import raw_swing
from tests.evaluate.stream.test_run import Arms, Deaf
from wigwag.cli.app import run
from wigwag.evaluate.stream import systems

FIELDS = {
    "data", "vocabulary", "hours", "events", "event_f1", "detection_rate", "false_positive_rate",
    "false_commands_per_hour", "false_commands_ci95", "jaccard", "delay_from_end_s_median",
    "share_seen_median", "action_point_f1",
}  # fmt: skip
"""What every record must hold."""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The six classes by eight people, once each; PRECOG by four."""
    root = tmp_path_factory.mktemp("data")
    folder = root / "utd_mhad" / "Skeleton"
    folder.mkdir(parents=True)
    (root / "precog").mkdir()
    saved(root / "precog" / "precog.npz", precog_arrays(takes((1,), (1, 2, 3, 4), (1,), 150)))
    for label in ("a1", "a6", "a7", "a9", "a24", "a27"):
        for person in range(1, 9):
            joints = raw_swing(f"s{person}", label).transpose(1, 2, 0)
            (folder / f"{label}_s{person}_t1_skeleton.mat").write_bytes(mat("d_skel", joints))
    return root


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(systems.SYSTEMS, "arms", lambda _: Arms(("a6", "a1")))
    monkeypatch.setitem(systems.SYSTEMS, "deaf", lambda _: Deaf())
    monkeypatch.setattr("wigwag.evaluate.stream.plan.SIMULATED_PEOPLE", 4)


def stream(small: Path, *words: object) -> int:
    return run(["benchmark", "stream", "--data-dir", str(small), *map(str, words)])


def test_every_row_is_recorded(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rows.json"
    words = ["--system", "arms", "--rounds", 1, "--data", "utd-mhad", "precog", "simulated"]
    assert stream(small, *words, "--corrupt", "nan", "gap", "--json", file) == 0
    rows = json.loads(file.read_text())
    shown = [(row["data"], row["corrupt"]) for row in rows]
    assert len(shown) == len(set(shown)) == 4 * 3
    assert ("negatives", "gap") in shown
    for row in rows:
        assert set(row) >= FIELDS
        assert row["command"].startswith("wigwag benchmark stream --data-dir ")
        assert (
            row["false_commands_ci95"][0] <= row["false_commands_per_hour"] <= row["false_commands_ci95"][1]
        )
        assert ("f1_lost" in row) == (row["corrupt"] is not None)
        assert row.get("exceptions", 0) == 0
    said = capsys.readouterr().out
    assert "Commands in streams" in said and "utd-mhad, nan" in said


def test_the_hour_of_listening_is_measured(
    small: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from wigwag.evaluate.stream import cost

    assert cost.resident_mb() > 10
    short = cost.run_cost
    monkeypatch.setattr(cost, "run_cost", lambda *a, **k: short(*a, **k | {"hours": 0.005}))
    assert stream(small, "--system", "deaf", "--data", "cost") == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "deaf, 6 gestures, 0.01 h:" in said or "deaf, 6 gestures, 0.00 h:" in said
    assert "Commands in streams" not in said


def test_faults(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert stream(small, "--system", "oracle") == 2
    assert "no system 'oracle'" in " ".join(capsys.readouterr().err.split())
    assert stream(small, "--system", "deaf", "--data", "utkinect") == 2
    assert "utkinect: nothing was read that could be shown" in " ".join(capsys.readouterr().err.split())
    assert stream(tmp_path, "--system", "deaf") == 2
    assert "UTD-MHAD comes from" in " ".join(capsys.readouterr().err.split())
    assert stream(small, "--system", "deaf", "--rounds", 0) == 2
    assert "rounds must be 1 or more" in " ".join(capsys.readouterr().err.split())
