from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.metrics import accuracy_score, confusion_matrix, f1_score

from wigwag.errors import InputError
from wigwag.evaluate.metrics import (
    accuracy,
    auroc,
    calibration_error,
    confusion,
    draw_confusion,
    false_accept_at,
    macro_f1,
    people_interval,
    t_interval,
    wilson_interval,
)

LABELS = ("a", "b", "c", "d")
CASES = st.lists(st.tuples(st.sampled_from(LABELS), st.sampled_from(LABELS)), min_size=1, max_size=80)


@settings(max_examples=100, deadline=None)
@given(cases=CASES)
def test_agrees_with_scikit_learn(cases: list[tuple[str, str]]) -> None:
    truth, predicted = zip(*cases, strict=True)
    counts = confusion(truth, predicted, LABELS)
    np.testing.assert_array_equal(counts, confusion_matrix(truth, predicted, labels=list(LABELS)))
    assert accuracy(truth, predicted) == pytest.approx(accuracy_score(truth, predicted))
    assert macro_f1(counts) == pytest.approx(f1_score(truth, predicted, average="macro"))


def test_t_interval_reference() -> None:
    """Mean 0.96, s = 0.01, n = 4: half width 3.18245 x 0.01 / 2."""
    values = [0.95, 0.95, 0.97, 0.97]
    spread = np.std(values, ddof=1)
    low, high = t_interval(values)
    assert (low, high) == pytest.approx((0.96 - 3.18245 * spread / 2, 0.96 + 3.18245 * spread / 2), abs=1e-5)
    assert t_interval([1.0, 0.9])[1] == 1.0, "no share above one"


def test_wilson_reference() -> None:
    """Newcombe 1998, table I: 81 of 263 and 15 of 148 and 0 of 20 and 1 of 29."""
    for right, cases, low, high in (
        (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718),
    ):  # fmt: skip
        assert wilson_interval(right, cases) == pytest.approx((low, high), abs=1e-4)


def test_people_interval_is_wider_than_of_independent_cases() -> None:
    """Four people of whom one fails always: cases say 0.75 +- 0.04, people know far less."""
    people = [person for person in "abcd" for _ in range(100)]
    right = np.array([person != "d" for person in people], dtype=float)
    low, high = people_interval(right, people, seed=0)
    assert low <= 0.35
    assert high == 1.0


def test_people_interval_of_one_kind_of_people_is_that_of_cases() -> None:
    rng = np.random.default_rng(1)
    people = [f"p{i}" for i in range(40) for _ in range(25)]
    right = (rng.random(1000) < 0.9).astype(float)
    low, high = people_interval(right, people, seed=0)
    share = right.mean()
    half = 1.96 * np.sqrt(share * (1 - share) / 1000)
    assert low < share < high
    assert 0.8 * half < (high - low) / 2 < 1.8 * half


def test_people_interval_is_reproducible() -> None:
    right, people = np.array([1.0, 0.0, 0.5, 1.0]), ["a", "a", "b", "b"]
    assert people_interval(right, people, 3) == people_interval(right, people, 3)


def test_faults() -> None:
    with pytest.raises(InputError, match="2 or more, but got 1"):
        t_interval([0.5])
    with pytest.raises(InputError, match="but got 3 of 2"):
        wilson_interval(3, 2)
    with pytest.raises(InputError, match="cases > 0"):
        wilson_interval(0, 0)
    with pytest.raises(InputError, match=r"Labels \['x'\] are not among"):
        confusion(["x"], ["a"], LABELS)
    with pytest.raises(InputError, match="as many of one as of the other"):
        accuracy(["a"], [])
    with pytest.raises(InputError, match="confusion matrix is empty"):
        macro_f1(np.zeros((3, 3), dtype=int))


def test_picture_shows_the_matrix(tmp_path: Path) -> None:
    path = tmp_path / "new" / "confusion.png"
    counts = np.array([[8, 2, 0], [0, 10, 0], [0, 0, 0]])
    draw_confusion(counts, ["swipe left", "wave", "never shown"], "title", path)
    picture = cv2.imread(str(path))
    assert picture is not None
    assert min(picture.shape[:2]) > 300
    blue = (picture[..., 0].astype(int) - picture[..., 2]) > 60
    assert blue.sum() > 1000, "the diagonal is dark blue"


def test_calibration_error_by_hand() -> None:
    """Two bins: 4 cases at 0.9 of which 3 are right, 6 at 0.5 of which 6 are."""
    confidence, right = [0.9] * 4 + [0.5] * 6, [True] * 3 + [False] + [True] * 6
    assert calibration_error(confidence, right) == pytest.approx(0.4 * 0.15 + 0.6 * 0.5)
    assert calibration_error([1.0, 0.0], [True, False]) == 0.0
    # 15 bins of equally many of 30 cases: each mixes two neighbours
    sure = np.linspace(0.5, 1.0, 30)
    assert calibration_error(sure, [True] * 30, adaptive=True) == pytest.approx(1 - sure.mean())


@given(st.integers(0, 99))
def test_honest_confidences_are_calibrated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sure = rng.uniform(0, 1, 20_000)
    right = rng.random(20_000) < sure
    for adaptive in (False, True):
        assert calibration_error(sure, right, adaptive) < 0.03
        assert calibration_error(np.sqrt(sure), right, adaptive) > 0.1, "and boastful ones are not"


def test_calibration_error_faults() -> None:
    with pytest.raises(InputError, match=r"within 0 to 1, but range from 0\.5 to 1\.5"):
        calibration_error([0.5, 1.5], [True, False])
    with pytest.raises(InputError, match="at least 1"):
        calibration_error([], [])


@given(st.lists(st.integers(0, 5), min_size=1), st.lists(st.integers(0, 5), min_size=1))
def test_auroc_is_the_share_of_pairs_in_order(known: list[int], unknown: list[int]) -> None:
    pairs = [(k > u) + 0.5 * (k == u) for k in known for u in unknown]
    assert auroc(known, unknown) == pytest.approx(np.mean(pairs))
    assert auroc(known, unknown) + auroc(unknown, known) == pytest.approx(1)


def test_false_accepts_at_a_share() -> None:
    known, unknown = np.arange(100.0), np.array([3.0, 4.0, 4.5, 5.0, 60.0])
    assert false_accept_at(0.95, known, unknown) == pytest.approx(2 / 5), "threshold 5: 95 of 100 pass"
    assert false_accept_at(1.0, known, unknown) == 1.0
    assert false_accept_at(0.5, known, unknown) == pytest.approx(1 / 5)
    for bad in (([], [1.0]), ([1.0], [])):
        with pytest.raises(InputError, match="cases of both kinds"):
            false_accept_at(0.95, *bad)
        with pytest.raises(InputError, match="cases of both kinds"):
            auroc(*bad)
