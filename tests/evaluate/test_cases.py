import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.evaluate.cases import Cases, bare
from wigwag.evaluate.metrics import people_interval, wilson_interval
from wigwag.skeleton import Clip


def clip(name: str, person: str, label: str = "a") -> Clip:
    return Clip.at_rate(np.zeros((3, 13, 3)), 20, label, person, name)


SOME = [clip("1", "p"), clip("2", "p"), clip("3", "q")]


def test_runs_of_one_clip_are_one_case() -> None:
    cases = Cases()
    cases.add(SOME, ["a", "a", "b"])
    cases.add(SOME[1:], ["b", "b"])
    right, people = cases.by_case()
    assert right.tolist() == [1.0, 0.5, 0.0]
    assert people == ["p", "p", "q"]
    figures = cases.figures(0)
    assert figures["accuracy_mean"] == 0.5
    assert figures["accuracy_std"] == pytest.approx(np.std([0.75, 0.0], ddof=1))
    assert figures["accuracy_ci95"] == list(people_interval(right, people, 0))
    assert (figures["people"], figures["cases"]) == (2, 3)


def test_no_error_at_all_is_not_certainty() -> None:
    cases = Cases()
    cases.add(SOME, "aaa")
    figures = cases.figures(0)
    assert figures["accuracy_ci95"] == list(wilson_interval(3, 3))
    assert figures["ci95_method"] == "Wilson"


def test_one_person_has_no_spread() -> None:
    cases = Cases()
    cases.add(SOME[:2], "ab")
    assert cases.figures(0)["accuracy_std"] == 0.0


def test_nothing_judged_is_refused() -> None:
    with pytest.raises(InputError, match="Nothing was judged"):
        Cases().figures(0)


def test_bare_clips_say_nothing() -> None:
    for one, same in zip(bare(SOME), SOME, strict=True):
        assert (one.label, one.subject, one.name) == (None, None, "case")
        assert one.joints is same.joints
