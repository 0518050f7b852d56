"""The README's tables come from the records, and nowhere else."""

import json
from pathlib import Path

import pytest

from wigwag.errors import InputError
from wigwag.evaluate.tables import BEGIN, END, fill

LIFT = {
    "landmark": "wrist", "median_abs_mm": 15.1, "bias_mm": 0.0, "beyond_150_mm": 0.034, "missing": 0.001,
    "frames": 1838, "subjects": "s2 s4 s6 s8 (not fitted on)",
}  # fmt: skip


def test_tables_stand_between_the_markers(tmp_path: Path) -> None:
    page, records = tmp_path / "README.md", tmp_path / "lift.json"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", "utf-8")
    records.write_text(json.dumps([LIFT, LIFT | {"subjects": "all"}, LIFT | {"landmark": "left_wrist"}]))
    fill(page, {"lift": [records]})
    text = page.read_text("utf-8")
    assert text.startswith("before\n") and text.endswith("after\n") and "old" not in text
    assert text.count("| wrist | 15.1 | 3.4 | 0.1 | 1838 |") == 1
    assert "left_wrist" not in text


def test_a_page_without_markers_is_left_alone(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("nothing here", "utf-8")
    with pytest.raises(InputError, match="markers"):
        fill(page, {})
    assert page.read_text("utf-8") == "nothing here"
