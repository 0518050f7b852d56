"""The README's tables come from the records, and nowhere else."""

import json
from pathlib import Path

import pytest

from wigwag.errors import InputError
from wigwag.evaluate.tables import BEGIN, END, fill

LIFT = {
    "landmark": "wrist", "median_abs_mm": 15.1, "bias_mm": 0.0, "beyond_150_mm": 0.034, "missing": 0.001,
    "knock_out": 0.1, "within_1_sigma": 0.663, "within_2_sigma": 0.901, "frames": 1838,
    "subjects": "s2 s4 s6 s8 (not fitted on)",
}  # fmt: skip


def test_tables_stand_between_the_markers(tmp_path: Path) -> None:
    page, records = tmp_path / "README.md", tmp_path / "lift.json"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", "utf-8")
    records.write_text(json.dumps([LIFT, LIFT | {"subjects": "all"}, LIFT | {"landmark": "left_wrist"}]))
    fill(page, {"lift": [records]})
    text = page.read_text("utf-8")
    assert text.startswith("before\n") and text.endswith("after\n") and "old" not in text
    assert text.count("| wrist | 10 | 15.1 | 3.4 | 0.1 | 66.3 | 90.1 | 1838 |") == 1
    assert "left_wrist" not in text


def test_a_page_without_markers_is_left_alone(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("nothing here", "utf-8")
    with pytest.raises(InputError, match="markers"):
        fill(page, {})
    assert page.read_text("utf-8") == "nothing here"


def test_an_unknown_table_is_refused(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    with pytest.raises(InputError, match="Available tables: demo, utd"):
        fill(page, {"nonsense": []})


def test_rejection_is_averaged_over_draws_and_nothing_else(tmp_path: Path) -> None:
    page, records = tmp_path / "page.md", tmp_path / "reject.json"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    one = {
        "recognizer": "kernel", "known": 6, "unknown": 21, "background": "other classes", "auroc": 0.99,
        "false_accept_at_95": 0.02, "true_accept_at_threshold": 0.96, "false_accept_at_threshold": 0.01,
    }  # fmt: skip
    other = one | {"known": 21, "unknown": 6, "auroc": 0.5}
    records.write_text(json.dumps([one, one | {"false_accept_at_95": 0.04}, other]))
    fill(page, {"reject": [records]})
    text = page.read_text("utf-8")
    assert "| kernel | 6 / 21 | other classes | 99.0 | 3.0 | 96.0 | 1.0 | 2 |" in text
    assert "| kernel | 21 / 6 | other classes | 50.0 |" in text
