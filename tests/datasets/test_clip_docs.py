"""The example in docs/clips.md is a clip."""

import re
from pathlib import Path

from wigwag.datasets.folder import load_clip, text_of
from wigwag.skeleton import LANDMARKS


def test_the_example_in_the_documentation_reads(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "clips.md").read_text(encoding="utf-8")
    example = re.search(r"```json\n(.*?)```", text, re.DOTALL)
    assert example is not None
    (tmp_path / "land.json").write_text(example[1])
    clip = load_clip(tmp_path / "land.json")
    assert (len(clip), clip.label, clip.subject) == (2, "land", "ann")


def test_the_table_of_columns_is_complete() -> None:
    assert LANDMARKS[0] == "nose" and LANDMARKS[-1] == "right_heel"
    assert text_of({"version": 1, "joints": [[[0.0, 1.0, 2.0]]]}).splitlines()[2:4] == [
        '  "joints": [',
        "    [[0.0, 1.0, 2.0]]",
    ]
