"""The path has the distance that is computed elsewhere, and goes from end to end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.distances import dtw, dtw_path
from wigwag.errors import InputError


@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(1, 12), st.sampled_from([None, 0, 2, 5]))
def test_a_path_costs_what_dtw_says(seed: int, n: int, m: int, band: int | None) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(n, 3)), rng.normal(size=(m, 3))
    distance, path = dtw_path(a, b, band)
    assert distance == pytest.approx(dtw(a, b, band), rel=1e-9)
    assert np.linalg.norm(a[path[:, 0]] - b[path[:, 1]], axis=1).sum() == pytest.approx(distance)
    assert path[0].tolist() == [0, 0] and path[-1].tolist() == [n - 1, m - 1]
    steps = np.diff(path, axis=0)
    assert ((steps >= 0) & (steps <= 1)).all() and (steps.sum(axis=1) > 0).all()
    if band is not None:
        assert (np.abs(path[:, 0] - path[:, 1]) <= max(band, abs(n - m))).all()


@pytest.mark.parametrize("b", [np.zeros(3), np.zeros((0, 2)), np.zeros((4, 3))])
def test_what_cannot_be_compared_is_told(b: np.ndarray) -> None:
    with pytest.raises(InputError, match="dtw_path needs two arrays"):
        dtw_path(np.zeros((3, 2)), b)
