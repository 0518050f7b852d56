from collections.abc import Sequence

import pytest

from tests.evaluate.readers import Reader, key, shelf
from wigwag.errors import InputError
from wigwag.evaluate import recognizers
from wigwag.evaluate.transfer import run_transfer
from wigwag.skeleton import Clip

CLIPS = shelf(("a01", "a02"), (1, 3, 5), takes=2)


class Third(Reader):
    """Takes person 5 for the first class."""

    def predict(self, clips: Sequence[Clip]) -> list[str]:
        right = super().predict(clips)
        return ["a01" if key(clip)[1] == 5 else label for clip, label in zip(clips, right, strict=True)]


@pytest.fixture(autouse=True)
def reader(monkeypatch: pytest.MonkeyPatch) -> None:
    Third.made = []
    monkeypatch.setitem(recognizers.RECOGNIZERS, "third", Third)


def test_every_person_is_left_out_once() -> None:
    result = run_transfer(CLIPS, "third", [7])
    assert len(result.runs) == len(Third.made) == 3
    for made in Third.made:
        assert made.seed == 7
        taught = {key(clip)[1] for clip in made.lessons[0]}
        shown = {key(clip)[1] for clip in made.shown}
        assert taught | shown == {1, 3, 5}
        assert not taught & shown
        assert len(shown) == 1


def test_record() -> None:
    record = run_transfer(CLIPS, "third", range(2)).record(0)
    assert record["accuracy_mean"] == pytest.approx(10 / 12)
    assert record["macro_f1_mean"] == pytest.approx((2 * 12 / (2 * 12 + 4) + 2 * 8 / (2 * 8 + 4)) / 2)
    assert (record["people"], record["cases"], record["seeds"], record["classes"]) == (3, 12, 2, 2)
    assert record["n_train"] == 8
    low, high = record["accuracy_ci95"]
    assert low <= record["accuracy_mean"] <= high
    assert record["ece"] is None
    assert record["ms_per_case_median"] <= record["ms_per_case_p95"]


def test_seedless_recognisers_run_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(recognizers.RECOGNIZERS, "heavy", Third)
    assert run_transfer(CLIPS, "heavy", range(4)).record(0)["seeds"] == 1


def test_progress_reaches_the_total() -> None:
    seen: list[tuple[int, int]] = []
    run_transfer(CLIPS, "third", range(2), lambda _, done, total: seen.append((done, total)))
    assert seen[-1] == (30, 30)


def test_faults() -> None:
    with pytest.raises(InputError, match="two people or more, but got s1"):
        run_transfer([clip for clip in CLIPS if clip.subject == "s1"], "third", [0])
    with pytest.raises(InputError, match="recognizer must be one of"):
        run_transfer(CLIPS, "nobody", [0])
