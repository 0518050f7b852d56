from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.evaluate import utd_mhad
from wigwag.evaluate.metrics import t_interval, wilson_interval
from wigwag.evaluate.protocols import CLASS_SETS, Split
from wigwag.evaluate.recognizers import BASELINES, maker_of
from wigwag.evaluate.utd_mhad import Result, Row, Run, plan, run_row, warm_up
from wigwag.skeleton import Clip

SEEDS = range(3)


def clips() -> list[Clip]:
    """Six classes, eight people, two trials; the class can be read off the first coordinate."""
    made = []
    for number, label in enumerate(CLASS_SETS["6"]):
        for subject in range(1, 9):
            for trial in range(2):
                joints = np.zeros((3, 13, 3))
                joints[:, 0, 0] = number
                joints[:, 0, 1] = subject
                made.append(Clip.at_rate(joints, 20, label, f"s{subject}", f"{label}_s{subject}_t{trial}"))
    return made


class Reader:
    """Reads the class off the clip, but takes person 8 for the first class; notes what it is shown."""

    made: list["Reader"]

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.shown: list[Clip] = []
        self.learned: list[Clip] = []
        self.made.append(self)

    def fit(self, clips: Sequence[Clip]) -> "Reader":
        self.learned = list(clips)
        return self

    def predict(self, clips: Sequence[Clip]) -> list[str]:
        self.shown += clips
        return [
            CLASS_SETS["6"][0 if clip.joints[0, 0, 1] == 8 else int(clip.joints[0, 0, 0])] for clip in clips
        ]


@pytest.fixture(autouse=True)
def reader(monkeypatch: pytest.MonkeyPatch) -> Iterator[type[Reader]]:
    Reader.made = []
    monkeypatch.setitem(utd_mhad.RECOGNIZERS, "reader", Reader)
    yield Reader


def test_nobody_is_told_the_answer(reader: type[Reader]) -> None:
    run_row(clips(), Row("reader", "random", "6"), SEEDS)
    assert len(reader.made) == 3
    for made in reader.made:
        assert {clip.label for clip in made.shown} == {None}
        assert {clip.subject for clip in made.shown} == {None}
        assert {clip.name for clip in made.shown} == {"case"}
        learned = {clip.name for clip in made.learned}
        assert len(learned) == len(made.learned) == 76
        assert len(made.shown) == 20


def test_people_are_kept_apart(reader: type[Reader]) -> None:
    for protocol in ("cross-subject", "loso"):
        reader.made.clear()
        run_row(clips(), Row("reader", protocol, "6"), SEEDS)
        for made in reader.made:
            learned = {clip.joints[0, 0, 1] for clip in made.learned}
            assert not learned & {clip.joints[0, 0, 1] for clip in made.shown}


def test_plan_counts_runs() -> None:
    row = {p: Row("reader", p, "6") for p in ("random", "cross-subject", "loso")}
    assert [seed for _, seed in plan(clips(), row["random"], SEEDS)] == [0, 1, 2]
    assert [seed for _, seed in plan(clips(), row["cross-subject"], SEEDS)] == [0, 1, 2]
    assert [seed for _, seed in plan(clips(), row["loso"], SEEDS)] == [0] * 8
    assert len(plan(clips(), Row("heavy", "cross-subject", "6"), SEEDS)) == 1, "it has nothing to seed"


def test_record_of_people_kept_apart() -> None:
    """Of persons 2, 4, 6, 8 the last is right in one class of six."""
    record = run_row(clips(), Row("reader", "cross-subject", "6"), SEEDS).record(seed=0)
    assert record["accuracy_mean"] == pytest.approx((3 + 1 / 6) / 4)
    assert record["accuracy_std"] == pytest.approx(np.std([1, 1, 1, 1 / 6], ddof=1))
    assert record["ci95_method"] == "bootstrap of people"
    low, high = record["accuracy_ci95"]
    assert low < 0.5
    assert high == 1.0
    assert (record["n_train"], record["n_test"], record["cases"]) == (48, 48, 48)
    assert (record["seeds"], record["splits"]) == (3, 3)
    assert record["macro_f1_mean"] == pytest.approx((2 * 8 / (2 * 8 + 10) + 5 * (12 / 14)) / 6)


def test_record_of_leaving_one_out_pools_the_folds() -> None:
    result = run_row(clips(), Row("reader", "loso", "6"), SEEDS)
    record = result.record(seed=0)
    assert record["cases"] == 96
    assert record["accuracy_mean"] == pytest.approx((7 + 1 / 6) / 8)
    assert result.confusion().sum() == 96
    assert record["seeds"] == 1
    assert record["splits"] == 8


def test_record_has_every_key_of_the_issue() -> None:
    record = run_row(clips(), Row("reader", "random", "6"), SEEDS).record(seed=0)
    assert set(record) >= {
        "recognizer", "protocol", "classes", "n_train", "n_test", "accuracy_mean", "accuracy_std",
        "accuracy_ci95", "macro_f1_mean", "fit_s", "ms_per_case_median", "ms_per_case_p95", "total_s",
        "seeds",
    }  # fmt: skip
    assert record["classes"] == 6
    assert record["ms_per_case_median"] <= record["ms_per_case_p95"]


def run_of(right: int, cases: int, seed: int) -> Run:
    truth = ["a1"] * cases
    predicted = ["a1"] * right + ["a6"] * (cases - right)
    names = [f"{seed}-{i}" for i in range(cases)]
    split = Split((), tuple(range(cases)), f"seed {seed}")
    return Run(split, seed, truth, predicted, ["s1"] * cases, names, 2.0, [0.01] * cases)


def test_intervals_over_random_splits() -> None:
    row = Row("reader", "random", "6")
    record = Result(row, [run_of(8, 10, 0), run_of(10, 10, 1)]).record(0)
    assert record["accuracy_ci95"] == list(t_interval([0.8, 1.0]))
    assert record["accuracy_std"] == pytest.approx(np.std([0.8, 1.0], ddof=1))
    assert Result(row, [run_of(8, 10, 0)]).record(0)["accuracy_ci95"] == list(wilson_interval(8, 10))


def test_no_error_at_all_is_not_certainty() -> None:
    """Ten perfect splits leave no spread; the interval must not shrink to a point."""
    record = Result(Row("reader", "random", "6"), [run_of(10, 10, seed) for seed in range(10)]).record(0)
    assert record["accuracy_mean"] == 1.0
    assert record["accuracy_ci95"] == list(wilson_interval(100, 100))


def test_times_are_of_a_case() -> None:
    record = Result(Row("reader", "random", "6"), [run_of(8, 10, 0)]).record(0)
    assert record["ms_per_case_median"] == pytest.approx(10.0)
    assert record["total_s"] == pytest.approx(0.1)
    assert record["fit_s"] == 2.0


def test_progress_reaches_the_total() -> None:
    seen: list[tuple[int, int]] = []
    run_row(clips(), Row("reader", "random", "6"), SEEDS, lambda _, done, total: seen.append((done, total)))
    assert seen[-1] == (63, 63)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_warm_up_uses_few_clips(reader: type[Reader]) -> None:
    warm_up(clips(), "reader")
    assert len(reader.made[0].learned) <= 12


def test_calibration_is_of_all_cases_and_costs_no_case_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sure of everything by 0.9, right in three people and a sixth of four."""

    class Sure(Reader):
        classes_ = np.array(CLASS_SETS["6"])

        def predict_proba(self, clips: Sequence[Clip]) -> np.ndarray:
            assert all(clip.label is None and clip.subject is None for clip in clips)
            decided = [CLASS_SETS["6"].index(label) for label in self.predict(clips)]
            return np.where(np.arange(6) == np.array(decided)[:, None], 0.9, 0.02)

    monkeypatch.setitem(utd_mhad.RECOGNIZERS, "sure", Sure)
    result = run_row(clips(), Row("sure", "cross-subject", "6"), range(2))
    assert [len(run.case_s) for run in result.runs] == [48, 48]
    record = result.record(0)
    assert record["ece"] == pytest.approx(abs(record["accuracy_mean"] - 0.9))
    assert record["ece_adaptive"] >= record["ece"]


def test_without_probabilities_there_is_no_calibration() -> None:
    record = run_row(clips(), Row("reader", "cross-subject", "6"), SEEDS).record(seed=0)
    assert record["ece"] is None
    assert record["ece_adaptive"] is None


def test_baselines_are_known_by_name() -> None:
    assert set(BASELINES) == {"classical", "schneider", "celebi", "rwigema", "aeon-dtw", "multirocket"}
    for name in BASELINES:
        maker_of(name)(3)


def test_faults() -> None:
    with pytest.raises(InputError, match=r"recognizer must be one of .*heavy, encoded"):
        run_row(clips(), Row("other", "random", "6"), SEEDS)
    with pytest.raises(InputError, match="needs clips of s1, s3, s5, s7 and of others"):
        run_row([c for c in clips() if c.subject == "s1"], Row("reader", "cross-subject", "6"), SEEDS)
