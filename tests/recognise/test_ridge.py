"""Ridge regression that grows and shrinks: always what one fit of the same examples would be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.recognise.ridge import EmpiricalMapRidge, gram_matrix, solve


def problem(seed: int, examples: int = 30, features: int = 50, targets: int = 4):
    """Similarities as they come: all of one sign, strongly correlated, single precision."""
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(examples, 3))
    others = rng.normal(size=(features, 3))
    distances = np.linalg.norm(places[:, None] - others, axis=2)
    shown = rng.integers(0, targets, examples)
    return np.exp(-distances / 3).astype(np.float32), np.where(
        shown[:, None] == np.arange(targets), 1.0, -1.0
    )


def least_squares(features: np.ndarray, targets: np.ndarray, penalty: float) -> np.ndarray:
    """The same by numpy: rows of sqrt(penalty) I with targets 0 are what a penalty is."""
    width = features.shape[1]
    rows = np.vstack([features.astype(np.float64), np.sqrt(penalty) * np.eye(width)])
    wanted = np.vstack([targets, np.zeros((width, targets.shape[1]))])
    return np.linalg.lstsq(rows, wanted, rcond=None)[0]


@given(
    seed=st.integers(0, 1000),
    examples=st.integers(1, 40),
    features=st.integers(1, 60),
    ridge=st.sampled_from([1e-4, 3e-4, 1e-2, 1.0]),
)
def test_weights_are_the_penalised_least_squares(seed, examples, features, ridge):
    rows, targets = problem(seed, examples, features)
    found = EmpiricalMapRidge(ridge).fit(rows, targets).weights
    expected = least_squares(rows, targets, ridge * examples)
    assert found.shape == (features, 4)
    np.testing.assert_allclose(found, expected, atol=1e-7 * max(1.0, np.abs(expected).max()))


def test_the_penalty_can_be_that_of_another_number_of_examples():
    rows, targets = problem(0)
    found = EmpiricalMapRidge(1e-3).fit(rows, targets, penalised=100).weights
    np.testing.assert_allclose(found, least_squares(rows, targets, 0.1), atol=1e-8)


def test_solve_is_the_inverse_and_leaves_the_matrix_alone():
    rows, targets = problem(1)
    gram = gram_matrix(rows)
    kept = gram.copy()
    found = solve(gram, targets, 1e-2)
    np.testing.assert_array_equal(gram, kept)
    np.testing.assert_allclose((gram + 0.01 * 30 * np.eye(30)) @ found, targets, atol=1e-10)
    assert gram.dtype == np.float64


def grown(rows: np.ndarray, targets: np.ndarray, times: int, start: int, ridge: float) -> EmpiricalMapRidge:
    """Fit on the first examples; then one reference and two examples at a time, as enrolment does."""
    model = EmpiricalMapRidge(ridge).fit(rows[:start, : start * 7], targets[:start])
    examples, references = start, start
    for _ in range(times):
        model.add_features(rows[:examples, references * 7 : (references + 1) * 7])
        references += 1
        model.add_examples(rows[examples : examples + 2, : references * 7], targets[examples : examples + 2])
        examples += 2
    return model


@pytest.mark.parametrize("times", [1, 3, 27])
def test_grown_many_times_is_what_one_fit_is(times):
    """Bug: an inverse that was updated in place was wrong after three enrolments."""
    start, ridge = 40, 3e-4
    rows, targets = problem(2, start + 2 * 27, 7 * (start + 27))
    examples, references = start + 2 * times, start + times
    found = grown(rows, targets, times, start, ridge).weights
    expected = EmpiricalMapRidge(ridge).fit(
        rows[:examples, : 7 * references], targets[:examples], penalised=start
    )
    np.testing.assert_allclose(found, expected.weights, atol=1e-6)
    np.testing.assert_allclose(
        found, least_squares(rows[:examples, : 7 * references], targets[:examples], ridge * start), atol=1e-6
    )


def test_keep_is_what_a_fit_without_the_others_is():
    start, ridge = 20, 3e-4
    rows, targets = problem(3, start + 10, 7 * (start + 5))
    model = grown(rows, targets, 5, start, ridge)
    examples, features = targets[:, 2] < 0, np.repeat(np.arange(25) % 3 > 0, 7)
    model.keep(examples, features, 2)
    left = np.delete(targets[examples], 2, axis=1)
    expected = least_squares(rows[np.ix_(examples, features)], left, ridge * start)
    assert model.weights.shape == (features.sum(), 3)
    np.testing.assert_allclose(model.weights, expected, atol=1e-6)


def test_what_was_added_can_be_taken_away_again():
    rows, targets = problem(4, 22, 7 * 21)
    model = EmpiricalMapRidge(1e-3).fit(rows[:20, : 7 * 20], targets[:20])
    before = model.weights
    model.add_target(4)
    model.add_features(rows[:20, 7 * 20 :])
    model.add_examples(rows[20:], np.where(np.arange(5) == 4, 1.0, -1.0) * np.ones((2, 1)))
    assert model.weights.shape == (7 * 21, 5)
    assert np.abs(model.weights[:140, :4] - before).max() > 1e-4  # it was heard
    model.keep(np.arange(22) < 20, np.arange(147) < 140, 4)
    np.testing.assert_allclose(model.weights, before, atol=1e-10)


def test_a_new_target_is_what_no_example_so_far_has():
    rows, targets = problem(5)
    model = EmpiricalMapRidge(1e-3).fit(rows, targets)
    model.add_target(3)
    expected = least_squares(rows, np.insert(targets, 3, -1.0, axis=1), 1e-3 * 30)
    np.testing.assert_allclose(model.weights, expected, atol=1e-8)


def test_what_was_handed_in_is_left_alone():
    rows, targets = problem(6, 12, 14)
    kept = rows.copy(), targets.copy()
    model = EmpiricalMapRidge(1e-3).fit(rows[:10, :7], targets[:10])
    model.add_features(rows[:10, 7:])
    model.add_examples(rows[10:], targets[10:])
    np.testing.assert_array_equal(rows, kept[0])
    np.testing.assert_array_equal(targets, kept[1])


# -- each kernel by itself ---------------------------------------------------------------------------------


@given(seed=st.integers(0, 1000), kernels=st.integers(1, 4), references=st.integers(1, 12))
def test_weights_apart_are_the_mean_of_each_kernels_own_least_squares(seed, kernels, references):
    rows, targets = problem(seed, 30, kernels * references)
    found = EmpiricalMapRidge(1e-3, kernels).fit(rows, targets).weights_apart
    for k in range(kernels):
        alone = least_squares(rows[:, k::kernels], targets, 1e-3 * 30)
        np.testing.assert_allclose(
            kernels * found[k::kernels], alone, atol=1e-7 * max(1.0, np.abs(alone).max())
        )


def test_weights_apart_grow_and_shrink_as_one_fit():
    rows, targets = problem(5, 40, 36)
    grown = EmpiricalMapRidge(1e-3, 3).fit(rows[:30, :30], targets[:30], penalised=40)
    grown.add_features(rows[:30, 30:])
    grown.add_examples(rows[30:], targets[30:])
    whole = EmpiricalMapRidge(1e-3, 3).fit(rows, targets)
    np.testing.assert_allclose(grown.weights_apart, whole.weights_apart, atol=1e-6)
    kept = np.arange(40) % 4 != 0
    grown.keep(kept, np.arange(36) < 24, 3)
    less = EmpiricalMapRidge(1e-3, 3).fit(rows[kept, :24], targets[kept, :3], penalised=40)
    np.testing.assert_allclose(grown.weights_apart, less.weights_apart, atol=1e-6)
