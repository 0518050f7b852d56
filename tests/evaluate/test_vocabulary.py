"""A vocabulary with a twin in it, one that everyday life is full of, and one that is fine."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from tests.evaluate.stream.people import swing
from tests.evaluate.stream.test_run import Arms
from wigwag.errors import InputError
from wigwag.evaluate.showings import between_rests, left_out
from wigwag.evaluate.stream import systems
from wigwag.evaluate.stream.moves import movement
from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.evaluate.vocabulary import Rules, check_vocabulary
from wigwag.evaluate.vocabulary_pictures import corresponding, draw_report, say
from wigwag.skeleton import Clip

GOOD = [swing(p, label, trial=t) for label in ("a1", "a2") for p in ("s1", "s2", "s3") for t in (1, 2)]


def again(clips: list[Clip], label: str, name: str) -> list[Clip]:
    """The same movements once more, by another name."""
    more = [swing(str(c.subject), label, trial=int(c.name[-1]) + 5) for c in clips if c.label == label]
    return [replace(c, label=name, name=f"{name}_{c.name}") for c in more]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(systems.SYSTEMS, "arms", lambda _: Arms(("a2", "a1")))
    few = {"teach": simulated_everyday(1, "teach"), "test": simulated_everyday(1, "test")}
    monkeypatch.setattr(
        "wigwag.evaluate.vocabulary.simulated_everyday", lambda n, purpose, seed: few[purpose]
    )


def test_a_twin_is_found_and_drawn(tmp_path: Path) -> None:
    clips = GOOD + again(GOOD, "a1", "twin")
    report = check_vocabulary(clips, system="arms")
    assert report.protocol == "people left out, 3 in 3 turns"
    assert [(p.first, p.second) for p in report.too_alike] == [("a1", "twin")]
    worst = report.pairs[0]
    assert (worst.first, worst.second) == ("a1", "twin")
    assert worst.confused is not None and worst.confused > 0.1
    assert say(worst).startswith("too alike, ")
    written = draw_report(report, clips, tmp_path / "new")
    assert "too_alike-a1-twin.png" in [path.name for path in written]
    for path in written:
        picture = cv2.imread(str(path))
        assert picture.shape[0] > 300 and (picture < 100).any()


def test_a_good_vocabulary_is_left_alone() -> None:
    report = check_vocabulary(GOOD, system="arms")
    assert report.too_alike == []
    assert [p.verdict for p in report.pairs] == ["apart"]
    for gesture in report.gestures:
        assert (gesture.examples, gesture.people, gesture.showings) == (6, 3, 6)
        assert gesture.found == gesture.early == 1.0
        assert 0 < (gesture.seen or 0) < 0.8


def test_what_everyday_life_is_full_of_is_said_and_shown(tmp_path: Path) -> None:
    report = check_vocabulary(GOOD, system="arms")
    flagged = [g for g in report.gestures if "looks like everyday movement" in g.verdicts]
    assert flagged, "people raise an arm for other reasons"
    assert flagged[0].everyday_per_hour > 1 and flagged[0].everyday_of
    assert set(report.lookalikes) == {g.label for g in flagged}
    names = [path.name for path in draw_report(report, GOOD, tmp_path)]
    assert f"everyday-{flagged[0].label}.png" in names
    patient = check_vocabulary(GOOD, system="arms", rules=Rules(everyday_per_hour=1e9))
    assert not patient.lookalikes


class Late(Arms):
    """Hears the right arm alone, and speaks when it is down again."""

    def update(self, pose: Any) -> Any:
        said = super().update(pose)
        if said is not None:
            self.held = said
        if self.up_since is None and getattr(self, "held", None) is not None:
            held, self.held = self.held, None
            return None if held.label == "a2" else replace(held, decided_ns=pose.stamp_ns + 10**9)
        return None


def test_missed_and_late_gestures_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(systems.SYSTEMS, "arms", lambda _: Late(("a2", "a1")))
    verdicts = {g.label: g.verdicts for g in check_vocabulary(GOOD, system="arms").gestures}
    assert "is never decided early" in verdicts["a1"]
    assert "is often missed" in verdicts["a2"]


def test_what_is_left_out_depends_on_the_examples() -> None:
    said, folds = left_out(GOOD)
    assert (said, len(folds)) == ("people left out, 3 in 3 turns", 3)
    for train, test in folds:
        assert not {c.subject for c in train} & {c.subject for c in test}
        assert len(train) + len(test) == len(GOOD)
    alone = [replace(c, subject="s1", name=f"{c.subject}_{c.name}") for c in GOOD]
    said, folds = left_out(alone)
    assert (said, len(folds)) == ("every fourth showing left out in turn", 4)
    assert all({c.label for c in train} == {"a1", "a2"} for train, _ in folds)
    said, folds = left_out(alone[:2] + alone[6:9])
    assert (said, len(folds)) == ("every second showing left out in turn", 2)
    said, ((train, test),) = left_out([alone[0], alone[6]])
    assert "varied copies" in said and len(train) == 2 and len(test) == 8
    assert not any(np.array_equal(c.joints, train[0].joints) for c in test)
    unknown = [replace(c, subject=None) for c in GOOD]
    assert left_out(unknown)[0].startswith("every fourth")


def test_a_showing_stands_between_two_rests() -> None:
    clip = GOOD[0]
    recording = between_rests(clip)
    onset, end = movement(clip)
    (mark,) = recording.marks
    assert mark.onset_ns * 1e-9 == pytest.approx(2 + onset, abs=1e-6)
    assert mark.end_ns * 1e-9 == pytest.approx(2 + end, abs=1e-6)
    assert recording.stream.duration_s == pytest.approx(4 + clip.duration_s, abs=0.1)
    held = Clip.at_rate(np.repeat(clip.joints[:1], 30, axis=0), 30, "stand", "s1", "held")
    assert between_rests(held).marks[0].duration_s == pytest.approx(held.duration_s), "a posture is all shown"


def test_frames_correspond_by_warping() -> None:
    clip = GOOD[0].joints
    slow = np.repeat(clip, 2, axis=0)
    partners = corresponding(clip, slow)
    assert partners[0] <= 1 and partners[-1] >= len(slow) - 2
    assert (np.diff(partners) >= 0).all()
    np.testing.assert_allclose(partners, 2 * np.arange(len(clip)) + 0.5, atol=4)


def test_faults() -> None:
    with pytest.raises(InputError, match=r"two gestures or more, but got \['a1'\]"):
        check_vocabulary(GOOD[:6])
    with pytest.raises(InputError, match="has no label"):
        check_vocabulary([*GOOD, replace(GOOD[0], label=None)])
