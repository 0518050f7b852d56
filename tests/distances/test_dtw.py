"""Dynamic time warping: the textbook recurrence and the laws of a distance."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.distances import dtw, dtw_pairwise
from wigwag.distances.dtw import dtw_by_product
from wigwag.errors import InputError


def brute(a, b, band=None, power=1):
    """The recurrence as the textbook has it, one cell at a time."""
    n, m = len(a), len(b)
    width = max(n, m) if band is None else max(band, abs(n - m))
    table = {(-1, -1): 0.0}
    for i in range(n):
        for j in range(m):
            if abs(i - j) <= width:
                before = [table.get(cell, np.inf) for cell in ((i - 1, j - 1), (i - 1, j), (i, j - 1))]
                table[i, j] = float(np.linalg.norm(a[i] - b[j])) ** power + min(before)
    return table[n - 1, m - 1]


def sequences(seed, count=2, features=3, longest=12, dtype="float64"):
    rng = np.random.default_rng(seed)
    return [
        rng.normal(size=(rng.integers(1, longest + 1), features)).cumsum(axis=0).astype(dtype)
        for _ in range(count)
    ]


@given(seed=st.integers(0, 2**31), band=st.none() | st.integers(0, 12))
@settings(max_examples=60, deadline=None)
def test_is_the_textbook_recurrence(seed, band):
    a, b = sequences(seed)
    assert dtw(a, b, band) == pytest.approx(brute(a, b, band), rel=1e-12)
    assert dtw(a, b, band, "squared") == pytest.approx(brute(a, b, band, power=2), rel=1e-12)


@given(seed=st.integers(0, 2**31), band=st.none() | st.integers(0, 12))
@settings(max_examples=40, deadline=None)
def test_symmetric_and_zero_on_itself(seed, band):
    a, b = sequences(seed)
    assert dtw(a, b, band) == pytest.approx(dtw(b, a, band), rel=1e-12)
    assert dtw(a, a, band) == 0


@given(seed=st.integers(0, 2**31))
@settings(max_examples=30, deadline=None)
def test_a_narrower_band_never_shortens_and_frame_repeats_cost_nothing(seed):
    a, b = sequences(seed)
    distances = [dtw(a, b, band) for band in (0, 2, 5, None)]
    assert all(x >= y - 1e-12 for x, y in pairwise(distances))
    assert dtw(a, np.repeat(a, 3, axis=0)) == 0


@given(
    seed=st.integers(0, 2**31),
    band=st.none() | st.integers(0, 12),
    dtype=st.sampled_from(["float32", "float64"]),
)
@settings(max_examples=20, deadline=None)
def test_pairwise_agrees_with_one_at_a_time(seed, band, dtype):
    a, b = sequences(seed, 3, dtype=dtype), sequences(seed + 1, 40, dtype=dtype)
    expected = np.array([[dtw(x, y, band) for y in b] for x in a])
    np.testing.assert_allclose(dtw_pairwise(a, b, band), expected, rtol=1e-3 if dtype == "float32" else 1e-9)
    itself = dtw_pairwise(a)
    np.testing.assert_allclose(itself, itself.T, rtol=1e-3, atol=0.02)


@given(
    seed=st.integers(0, 2**31),
    band=st.none() | st.integers(0, 12),
    cost=st.sampled_from(["euclidean", "squared"]),
)
@settings(max_examples=20, deadline=None)
def test_by_product_agrees(seed, band, cost):
    a, b = sequences(seed)
    assert dtw_by_product(a, b, band, cost) == pytest.approx(dtw(a, b, band, cost), rel=1e-9)


def test_one_value_worked_by_hand():
    # 0-0 costs 0, 3 is nearest to 4 (1), 4-4 costs 0, 1-0 costs 1.
    assert dtw(np.array([[0], [3], [4], [1]]), np.array([[0], [4], [0]])) == 2


@pytest.mark.parametrize(
    ("a", "b", "band", "message"),
    [
        (np.zeros((3, 2)), np.zeros((3, 4)), None, "same features, but got 2 and 4"),
        (np.zeros(3), np.zeros((3, 1)), None, r"a must have shape \(frames, features\), but got \(3,\)"),
        (np.zeros((3, 1)), np.zeros((0, 1)), None, "b must have shape"),
        (np.zeros((3, 1)), np.zeros((3, 1)), -1, "band must be 0 or more"),
    ],
)
def test_faults(a, b, band, message):
    with pytest.raises(InputError, match=message):
        dtw(a, b, band)
    with pytest.raises(InputError, match="'euclidean' or 'squared', but got 'cosine'"):
        dtw(np.zeros((3, 1)), np.zeros((3, 1)), cost="cosine")


def test_pairwise_faults():
    with pytest.raises(InputError, match="empty list"):
        dtw_pairwise([])
    with pytest.raises(InputError, match=r"Sequence 1 must have shape \(frames, 2\)"):
        dtw_pairwise([np.zeros((3, 2)), np.zeros((3, 3))])
    with pytest.raises(InputError, match=r"query must have shape \(frames, 2\)"):
        dtw_pairwise([np.zeros((3, 3))], [np.zeros((3, 2))])
    with pytest.raises(InputError, match="band"):
        dtw_pairwise([np.zeros((3, 3))], band=-2)
