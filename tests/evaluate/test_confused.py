"""Pictures of what is confused: the right pairs, and a picture only where there is something to show."""

from pathlib import Path

import cv2

from tests.recognise.people import clips
from wigwag.evaluate.confused import confused_pairs, draw_confused
from wigwag.evaluate.protocols import Split
from wigwag.evaluate.utd_mhad import Result, Row, Run

CLIPS = clips(("raise_left", "raise_right"), range(3), takes=2)
NAMES = {"raise_left": "left arm up", "raise_right": "right arm up"}


def run_of(predicted: list[str]) -> Run:
    mine = [clip for clip in CLIPS if clip.subject == "p0"]
    return Run(
        split=Split((), (), "p0"), seed=0, truth=[str(c.label) for c in mine], predicted=predicted,
        people=["p0"] * len(mine), names=[c.name for c in mine], fit_s=0.0, case_s=[0.0] * len(mine),
    )  # fmt: skip


def test_pairs_are_counted_over_runs() -> None:
    right = ["raise_left", "raise_left", "raise_right", "raise_right"]
    once = ["raise_left", "raise_right", "raise_right", "raise_right"]
    twice = ["raise_left", "raise_right", "raise_left", "raise_right"]
    result = Result(Row("kernel", "loso", "27"), [run_of(right), run_of(once), run_of(twice)])
    assert confused_pairs(result) == [
        ("raise_left", "raise_right", "raise_left_p0_t1", 2 / 3),
        ("raise_right", "raise_left", "raise_right_p0_t0", 1 / 3),
    ]
    assert len(confused_pairs(result, most=1)) == 1


def test_a_picture_where_there_is_something_to_show(tmp_path: Path) -> None:
    right = ["raise_left", "raise_left", "raise_right", "raise_right"]
    nothing, something = tmp_path / "nothing.png", tmp_path / "new" / "something.png"
    row = Row("kernel", "loso", "27")
    assert not draw_confused(Result(row, [run_of(right)]), CLIPS, NAMES, nothing)
    assert not nothing.exists()
    assert draw_confused(Result(row, [run_of(right[::-1])]), CLIPS, NAMES, something)
    picture = cv2.imread(str(something))
    assert picture is not None
    assert (picture != 255).any(axis=2).mean() > 0.005, "there is ink on it"
