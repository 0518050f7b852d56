from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.evaluate.readers import Reader, key, shelf
from wigwag.errors import InputError
from wigwag.evaluate import recognizers
from wigwag.evaluate.few_shot import SETTINGS, draw, folds, run_setting
from wigwag.skeleton import Clip

CLASSES = ("a1", "a2", "a3")
CLIPS = shelf(CLASSES, range(1, 9))


class Noting(Reader):
    pass


class Enrolling(Reader):
    """Also takes single gestures; a copy keeps notes of its own."""

    def enrol(self, label: str, clips: Sequence[Clip]) -> None:
        assert {clip.label for clip in clips} == {label}
        self.lessons = [*self.lessons, list(clips)]

    def __deepcopy__(self, memo: dict) -> "Enrolling":
        other = Enrolling(self.seed)
        other.lessons, other.known = list(self.lessons), dict(self.known)
        return other


@pytest.fixture(autouse=True)
def readers(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in (Noting, Enrolling):
        kind.made = []
        monkeypatch.setitem(recognizers.RECOGNIZERS, kind.__name__.lower(), kind)


@given(st.integers(1, 6), st.integers(0, 50))
def test_draws_take_so_many_a_class_from_as_many_people_as_possible(examples: int, seed: int) -> None:
    clips = shelf(CLASSES, (1, 3, 5))
    chosen = [clips[i] for i in draw(clips, examples, seed)]
    for label in CLASSES:
        people = Counter(clip.subject for clip in chosen if clip.label == label)
        assert people.total() == examples
        assert len(people) == min(examples, 3)
        assert max(people.values()) - min(people.values()) <= 1 or len(people) < 3
    assert draw(clips, examples, seed) == sorted(set(draw(clips, examples, seed)))


def test_draws_differ_by_seed_and_repeat() -> None:
    clips = shelf(CLASSES, (1, 3, 5))
    assert draw(clips, 1, 0) == draw(clips, 1, 0)
    assert len({tuple(draw(clips, 1, seed)) for seed in range(10)}) > 5


def test_a_class_with_few_clips_gives_what_it_has() -> None:
    clips = shelf(CLASSES, (1,), takes=2)
    assert len(draw(clips, 4, 0)) == 6


def run(name: str, setting: tuple, protocol: str = "cross-subject", draws: Sequence[int] = range(3)):
    return run_setting(CLIPS, name, setting, draws, folds(CLIPS, protocol))


@pytest.mark.parametrize("protocol", ["cross-subject", "loso"])
@pytest.mark.parametrize("setting", SETTINGS)
def test_nobody_is_shown_what_was_taught(setting: tuple, protocol: str) -> None:
    run("noting", setting, protocol)
    who, examples = setting
    for made in Noting.made:
        if not made.shown:
            continue
        taught = {key(clip) for lesson in made.lessons for clip in lesson}
        shown = [key(clip) for clip in made.shown]
        assert not taught & set(shown)
        testers = {person for _, person, _ in shown}
        own = [k for k in taught if k[1] in testers]
        assert len(own) == (0 if who == "others" else examples * len(CLASSES))
        others = len(taught) - len(own)
        everybody = 7 if protocol == "loso" else 4
        assert others == {"others": examples * 3, "own+others": everybody * 12, "own": 0}[who]


def test_every_clip_of_every_test_person_is_judged() -> None:
    assert len(run("noting", ("others", 1)).cases.right) == 4 * 12
    assert len(run("noting", ("others", 1), "loso").cases.right) == 8 * 12
    result = run("noting", ("own", 2), draws=range(8))
    assert len(result.cases.right) == 4 * 12, "over several draws"
    assert sum(map(len, result.cases.right.values())) == 8 * 4 * 6


def test_people_who_share_teachers_share_the_fit() -> None:
    run("noting", ("others", 1))
    assert sum(bool(made.lessons) for made in Noting.made) == 3, "a fit a draw, not one a person"


def test_own_examples_are_enrolled_where_that_is_possible() -> None:
    result = run("enrolling", ("own+others", 1))
    assert len(result.enrol_s) == 3 * 4 * 3
    base = [made for made in Enrolling.made if len(made.lessons) == 1]
    assert len(base) == 1, "other people teach once"
    assert not base[0].shown, "and the fitted one is left as it was"
    assert result.record(0)["enrol_ms_median"] >= 0
    assert result.record(0)["n_train"] == 48 + 3
    assert run("noting", ("own+others", 1)).record(0)["enrol_ms_median"] is None


def test_record_has_every_key_of_the_issue() -> None:
    record = run("noting", ("own", 1)).record(0)
    assert set(record) >= {"setting", "examples", "accuracy_mean", "accuracy_ci95"}
    assert record["accuracy_mean"] == 1.0
    assert record["n_train"] == 3
    low, high = record["accuracy_ci95"]
    assert 0.8 < low < high == 1.0


def test_errors_count(monkeypatch: pytest.MonkeyPatch) -> None:
    class Wrong(Noting):
        def predict(self, clips: Sequence[Clip]) -> list[str]:
            return ["a1"] * len(clips)

    monkeypatch.setitem(recognizers.RECOGNIZERS, "wrong", Wrong)
    assert run("wrong", ("others", 2)).record(0)["accuracy_mean"] == pytest.approx(1 / 3)


def test_progress_reaches_the_total() -> None:
    seen: list[tuple[int, int]] = []
    run_setting(
        CLIPS, "noting", ("own", 1), range(2), folds(CLIPS, "loso"),
        progress=lambda _, done, total: seen.append((done, total)),
    )  # fmt: skip
    assert seen[-1] == (16, 16)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_faults() -> None:
    with pytest.raises(InputError, match=r"recognizer must be one of .*noting"):
        run("nobody", ("own", 1))
    few = [clip for clip in CLIPS if clip.name.endswith("t0")]
    with pytest.raises(InputError, match="Nothing was judged"):
        run_setting(few, "noting", ("own", 1), [0], folds(few, "loso")).record(0)
    assert np.isfinite(run("noting", ("others", 8)).record(0)["accuracy_mean"])
