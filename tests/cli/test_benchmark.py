"""``wigwag benchmark`` from the command line to files and exit codes, on a small generated data set."""

import json
from collections.abc import Sequence
from pathlib import Path

import cv2
import pytest

import wigwag
from tests.datasets.trees import mat, movement, tree, zipped
from tests.evaluate.test_lift import with_depth
from wigwag.cli.app import run

SIX = (1, 6, 7, 9, 24, 27)
ROW = {
    "recognizer", "protocol", "classes", "n_train", "n_test", "accuracy_mean", "accuracy_std",
    "accuracy_ci95",
    "macro_f1_mean", "fit_s", "ms_per_case_median", "ms_per_case_p95", "total_s", "seeds", "command", "seed",
    "version",
}  # fmt: skip


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six classes, four people, two trials."""
    return tree(tmp_path_factory.mktemp("utd"), SIX, (1, 2, 3, 4), (1, 2))


def benchmark(*words: object) -> int:
    return run(["benchmark", *map(str, words)])


def test_utd_mhad_end_to_end(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "rows.json", tmp_path / "pictures"
    code = benchmark("utd-mhad", "--data", small, "--classes", 6, "--seeds", 1, "--json", file, "--out", out)
    assert code == 0
    rows = json.loads(file.read_text())
    assert [(row["recognizer"], row["protocol"]) for row in rows] == [
        (recognizer, protocol)
        for recognizer in ("kernel", "kernel-fast", "heavy", "encoded")
        for protocol in ("random", "cross-subject", "loso")
    ]
    for row in rows:
        assert set(row) >= ROW
        assert all(not isinstance(value, dict) for value in row.values())
        assert row["accuracy_mean"] > 0.8, "movements this different are told apart"
        low, high = row["accuracy_ci95"]
        assert 0 <= low <= row["accuracy_mean"] <= high <= 1
        assert row["version"] == wigwag.__version__
        assert row["command"].startswith("wigwag benchmark utd-mhad --data ")
    assert (rows[1]["n_train"], rows[1]["n_test"]) == (24, 24)
    pictures = {p.name for p in out.iterdir()}
    assert len(pictures) == 12
    assert "confusion_encoded_loso_6.png" in pictures
    assert cv2.imread(str(out / "confusion_heavy_random_6.png")) is not None
    said = capsys.readouterr().out
    assert "98.72" in said, "the paper's figure stands beside ours"
    assert "missing:" in said


def test_command_in_the_record_runs_again(small: Path, tmp_path: Path) -> None:
    words = ["--data", small, "--recognizer", "heavy", "--protocol", "random", "--classes", 6, "--seeds", 1]
    first, second = tmp_path / "1.json", tmp_path / "2.json"
    assert benchmark("utd-mhad", *words, "--json", first) == 0
    row = json.loads(first.read_text())[0]
    again = row["command"].replace(str(first), str(second)).split()[1:]
    assert run(again) == 0
    other = json.loads(second.read_text())[0]
    for key in ("accuracy_mean", "accuracy_ci95", "macro_f1_mean", "n_train", "seeds", "seed"):
        assert row[key] == other[key]


def test_damaged_recordings_are_named_and_the_rest_is_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root = tree(tmp_path / "utd", SIX, range(1, 9), range(1, 5))
    (root / "Skeleton" / "a1_s1_t1_skeleton.mat").write_bytes(b"damaged")
    (root / "Skeleton" / "a6_s2_t1_skeleton.mat").write_bytes(mat("d_skel", movement(6, 2, 1)[:19]))
    (root / "Skeleton" / "a7_s2_t2_skeleton.mat").unlink()
    file = tmp_path / "rows.json"
    words = ["--recognizer", "heavy", "--protocol", "cross-subject", "--classes", 6, "--seeds", 1]
    assert benchmark("utd-mhad", "--data", zipped(root, tmp_path / "S.zip"), *words, "--json", file) == 0
    said = capsys.readouterr().out
    assert "a1_s1_t1_skeleton.mat: is no readable MATLAB file" in said
    assert "a6_s2_t1_skeleton.mat: d_skel must have shape (20, 3, frames), but got (19, 3, 24)" in said
    assert "missing: 1 recording(s): a7_s2_t2_skeleton.mat" in said
    row = json.loads(file.read_text())[0]
    assert (row["n_train"], row["n_test"]) == (95, 94)


def test_rows_that_cannot_be_run_do_not_stop_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Everybody is a training person, so cross-subject has nobody to judge."""
    root = tree(tmp_path / "utd", SIX, (1, 3), (1, 2, 3))
    file = tmp_path / "rows.json"
    words = ["--data", root, "--recognizer", "heavy", "--classes", 6, "--seeds", 1, "--json", file]
    assert benchmark("utd-mhad", *words) == 0
    assert "left out: heavy, cross-subject, 6 classes: The cross-subject split needs" in (
        " ".join(capsys.readouterr().out.split())
    )
    assert [row["protocol"] for row in json.loads(file.read_text())] == ["random", "loso"]
    assert benchmark("utd-mhad", *words, "--protocol", "cross-subject") == 2


def fails(capsys: pytest.CaptureFixture[str], words: Sequence[object], *needed: str) -> None:
    assert benchmark(*words) == 2
    caught = capsys.readouterr()
    said = " ".join(caught.err.split())
    assert "Traceback" not in caught.err + caught.out
    for text in needed:
        assert text in said


def test_faults_end_with_code_2_and_say_what_to_do(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nowhere = tmp_path / "nowhere"
    fails(capsys, ("utd-mhad", "--data", nowhere), "no such file or folder", "UTD-MHAD", "Skeleton.zip")
    fails(capsys, ("lift", "--data", nowhere), "no such file or folder", "UTD-MHAD", "Skeleton.zip")
    fails(capsys, ("utd-mhad", "--data", tmp_path), "holds none of Skeleton/, Skeleton.zip")
    fails(capsys, ("lift", "--data", small), "depth part of UTD-MHAD is expected as Depth_56_clips.zip")
    fails(capsys, ("utd-mhad", "--data", small, "--seeds", 0), "--seeds must be 1 or more, but got 0")
    fails(capsys, ("utd-mhad", "--data", small, "--json", tmp_path), "cannot be written")
    with pytest.raises(SystemExit) as caught:
        benchmark("utd-mhad", "--data", small, "--classes", 5)
    assert caught.value.code == 2


def test_lift_end_to_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = with_depth(tmp_path / "utd", 2950)
    (root / "Depth" / "a1_s3_t1_depth.mat").write_bytes(b"damaged")
    file = tmp_path / "lift.json"
    assert benchmark("lift", "--data", root, "--json", file) == 0
    rows = json.loads(file.read_text())
    for row in rows:
        assert set(row) >= {
            "landmark", "median_abs_mm", "bias_mm", "beyond_150_mm", "missing", "statistic", "command",
            "seed", "version",
        }  # fmt: skip
        assert row["statistic"] == "surface"
    assert {"left_shoulder", "right_wrist", "shoulder", "elbow", "wrist"} <= {row["landmark"] for row in rows}
    said = capsys.readouterr().out
    assert "a1_s3_t1_depth.mat: is no readable MATLAB file" in said
    assert all(name in said for name in ("surface", "quartile", "median", "pixel"))


def test_lift_with_pixels_knocked_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root, file = with_depth(tmp_path / "utd", 2950), tmp_path / "lift.json"
    assert benchmark("lift", "--data", root, "--json", file, "--knock-out", 0.1) == 0
    rows = json.loads(file.read_text())
    assert {row["knock_out"] for row in rows} == {0.1}
    assert all(row["within_1_sigma"] <= row["within_2_sigma"] for row in rows)
    assert "10% of the pixels knocked out" in " ".join(capsys.readouterr().out.split())
    fails(capsys, ("lift", "--data", root, "--knock-out", 1.0), "knock_out must be a share from 0 to below 1")


def test_smooth_end_to_end(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "smooth.json"
    assert benchmark("smooth", "--data", small, "--json", file) == 0
    rows = json.loads(file.read_text())
    assert [row["filter"] for row in rows] == ["none", "by visibility", "PoseFilter"]
    assert {"lag_ms_p95", "overshoot_max", "rest_rms_mm", "command", "seed", "version"} <= set(rows[0])
    assert "PoseFilter" in capsys.readouterr().out
