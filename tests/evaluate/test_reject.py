from collections.abc import Sequence

import numpy as np
import pytest

from tests.evaluate.readers import Reader, key, shelf, written
from wigwag.datasets.utd_mhad import ACTIONS
from wigwag.errors import InputError
from wigwag.evaluate import recognizers
from wigwag.evaluate.protocols import CLASS_SETS
from wigwag.evaluate.reject import SETTINGS, Rejection, Turn, known_classes, run_draw
from wigwag.gesture import Gesture
from wigwag.skeleton import Clip

CLIPS = shelf(tuple(ACTIONS), range(1, 9), takes=1)
NUMBER = {label: i for i, label in enumerate(ACTIONS)}


class Scoring(Reader):
    """Scores what it was taught 1, what it was taught as no gesture -1, anything else 0."""

    accept_threshold_ = 0.5

    def accept_score(self, clips: Sequence[Clip]) -> np.ndarray:
        none = {key(c)[0] for c in self.lessons[-1] if c.label is None}
        self.shown += clips
        return np.array([1.0 if key(c)[0] in self.known else -1.0 if key(c)[0] in none else 0 for c in clips])


class Deciding(Reader):
    """Has no score; says no to what it was not taught, and is 0.6 sure of the rest."""

    def recognise(self, clip: Clip) -> Gesture:
        label = self.known.get(key(clip)[0])
        return Gesture(label, 0.6 if label else 0.7)


@pytest.fixture(autouse=True)
def readers(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in (Scoring, Deciding):
        kind.made = []
        monkeypatch.setitem(recognizers.RECOGNIZERS, kind.__name__.lower(), kind)


@pytest.mark.parametrize("draw", range(5))
@pytest.mark.parametrize("setting", SETTINGS)
def test_who_and_what_is_taught(setting: tuple, draw: int) -> None:
    count, background = setting
    result = run_draw(CLIPS, "scoring", setting, draw)
    assert (len(result.known), len(result.unknown)) == (count, 27 - count)
    judged_once: list[int] = []
    for made in Scoring.made:
        (lesson,) = made.lessons
        assert {clip.subject for clip in lesson} == {"s1", "s3", "s5", "s7"}
        assert {key(clip)[1] for clip in made.shown} == {2, 4, 6, 8}
        taught = {key(clip)[0] for clip in lesson if clip.label is not None}
        none = {key(clip)[0] for clip in lesson if clip.label is None}
        assert taught == {NUMBER[label] for label in result.known}
        judged = {key(clip)[0] for clip in made.shown} - taught
        judged_once += judged
        if background == "other classes":
            assert none == judged == {NUMBER[label] for label in result.unknown}
        elif background == "no other classes":
            assert not none
        else:
            assert len(none) == 14
            assert not none & judged, "no class that is judged was taught"
    assert sorted(judged_once) == sorted(NUMBER[label] for label in result.unknown), "each is judged once"


def test_the_first_draw_is_the_papers_six() -> None:
    assert set(known_classes(6, 0)) == set(CLASS_SETS["6"])
    assert set(known_classes(21, 0)) == set(ACTIONS) - set(CLASS_SETS["6"])
    draws = {known_classes(6, draw) for draw in range(1, 6)}
    assert len(draws) == 5
    assert {frozenset(ACTIONS) - frozenset(known_classes(21, draw)) for draw in range(1, 6)} == {
        frozenset(known) for known in draws
    }
    assert known_classes(6, 1, seed=0) != known_classes(6, 1, seed=1)
    with pytest.raises(InputError, match="6 or 21 of the 27 classes"):
        known_classes(5, 0)


def test_another_set_joins_the_background() -> None:
    other = [written("punch", "s99", take, 50) for take in range(3)]
    result = run_draw(CLIPS, "scoring", (21, "no other classes"), 0, other)
    lesson = Scoring.made[0].lessons[0]
    assert sum(key(clip)[0] == 50 and clip.label is None for clip in lesson) == 3
    assert result.background == "no other classes + another set"


def test_figures_by_hand() -> None:
    """Of 20 known clips 19 score 5 and up; of 4 unknown ones one scores 6, one exactly 5."""
    known = np.array([1.0, 5.0, *range(6, 24)])
    right = np.ones(20)
    right[-1] = 0
    turn = Turn(known, np.array([0.0, 2.0, 5.0, 6.0]), 5.5, right)
    record = Rejection("x", ("a1",) * 6, ("a2",) * 21, "none", 0, [turn]).record()
    assert record["false_accept_at_95"] == 0.5
    assert record["true_accept_at_threshold"] == 0.9
    assert record["false_accept_at_threshold"] == 0.25
    assert record["right_at_threshold"] == pytest.approx(17 / 20)
    assert record["auroc"] == pytest.approx((1 * 1 + (2 + 0.5) + (3 + 0.5) + 4 * 17) / 80)
    assert set(record) >= {
        "known", "unknown", "draw", "auroc", "false_accept_at_95", "true_accept_at_threshold",
        "false_accept_at_threshold",
    }  # fmt: skip


def test_a_perfect_recogniser_lets_nobody_through() -> None:
    for setting in SETTINGS:
        record = run_draw(CLIPS, "scoring", setting, 1).record()
        assert (record["auroc"], record["false_accept_at_95"]) == (1.0, 0.0)
        assert (record["true_accept_at_threshold"], record["false_accept_at_threshold"]) == (1.0, 0.0)
        assert record["right_at_threshold"] == 1.0
        assert record["n_unknown"] == 4 * record["unknown"]


def test_without_a_score_the_decision_counts() -> None:
    """What is refused stays below what is accepted, however sure the refusal."""
    record = run_draw(CLIPS, "deciding", (6, "other classes"), 0).record()
    assert (record["auroc"], record["false_accept_at_threshold"]) == (1.0, 0.0)
    assert record["true_accept_at_threshold"] == 1.0


def test_faults() -> None:
    with pytest.raises(InputError, match="recognizer must be one of"):
        run_draw(CLIPS, "nobody", SETTINGS[0], 0)
    six = [clip for clip in CLIPS if clip.label in CLASS_SETS["6"]]
    with pytest.raises(InputError, match="show 24 clips of known and 0 of unknown classes"):
        run_draw(six, "scoring", SETTINGS[0], 0)
