"""Anchors, and the merging of detections that overlap."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from wigwag.pose.detector import anchors, merge_overlapping


def test_anchors_are_the_network_s() -> None:
    grid = anchors()
    assert grid.shape == (2254, 2)
    np.testing.assert_allclose(grid[0], 0.5 / 28)
    np.testing.assert_allclose(grid[0], grid[1])
    np.testing.assert_allclose(grid[2], [1.5 / 28, 0.5 / 28], rtol=1e-6)  # columns run before rows
    np.testing.assert_allclose(grid[2 * 28 * 28], 0.5 / 14)
    np.testing.assert_allclose(grid[-1], 6.5 / 7, rtol=1e-6)


def box(u: float, v: float, side: float) -> np.ndarray:
    return np.array([[u, v], [u + side, v + side], [u, v]])


def test_boxes_of_one_person_are_blended_by_score() -> None:
    rows = np.stack([box(0.0, 0.0, 1.0), box(0.2, 0.0, 1.0), box(5.0, 5.0, 1.0)])
    merged = merge_overlapping(np.array([0.6, 0.9, 0.7]), rows)
    assert [score for score, _ in merged] == [0.9, 0.7]
    np.testing.assert_allclose(merged[0][1], box(0.2 * 0.9 / 1.5, 0.0, 1.0))
    np.testing.assert_allclose(merged[1][1], rows[2])


def test_touching_boxes_are_two_people() -> None:
    rows = np.stack([box(0.0, 0.0, 1.0), box(1.0, 0.0, 1.0)])
    assert len(merge_overlapping(np.array([0.6, 0.9]), rows)) == 2


@given(
    st.lists(
        st.tuples(st.floats(0.5, 1), st.floats(0, 9), st.floats(0, 9), st.floats(0, 3)),
        min_size=1,
        max_size=12,
    )
)
def test_merging_ends_and_keeps_the_surest(raw: list[tuple[float, float, float, float]]) -> None:
    scores = np.array([item[0] for item in raw])
    merged = merge_overlapping(scores, np.stack([box(*item[1:]) for item in raw]))
    found = [score for score, _ in merged]
    assert 1 <= len(found) <= len(raw)
    assert found == sorted(found, reverse=True)
    assert found[0] == scores.max()
