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
    confusion,
    draw_confusion,
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
