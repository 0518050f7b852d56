"""The decoding of the landmark network's outputs."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.pose.landmarker import clarity, refine, sigmoid


def heat_with(*peaks: tuple[int, int, float]) -> np.ndarray:
    """A heat map a landmark: cold everywhere but in one cell (row, column, raw height)."""
    heat = np.full((64, 64, len(peaks)), -50.0)
    for i, (row, column, height) in enumerate(peaks):
        heat[row, column, i] = height
    return heat


def test_a_landmark_moves_to_the_heat_near_it() -> None:
    moved, peaks = refine(np.array([[0.5, 0.25]]), heat_with((18, 30, 9.0)))
    np.testing.assert_allclose(moved, [[30 / 64, 18 / 64]])
    assert peaks[0] == pytest.approx(1.0, abs=1e-3)


def test_heat_spread_over_cells_draws_to_its_centre_of_mass() -> None:
    heat = heat_with((16, 32, 0.0))
    heat[16, 33, 0] = np.log(3.0)  # sigmoid: 1/2 and 3/4
    moved, _ = refine(np.array([[0.5, 0.25]]), heat)
    np.testing.assert_allclose(moved, [[(32 * 0.5 + 33 * 0.75) / 1.25 / 64, 16 / 64]])


@pytest.mark.parametrize("peak", [(18, 40, 9.0), (18, 30, -1.0)])
def test_far_or_faint_heat_moves_nothing(peak: tuple[int, int, float]) -> None:
    start = np.array([[0.5, 0.25]])
    np.testing.assert_array_equal(refine(start, heat_with(peak))[0], start)


def test_landmarks_at_and_beyond_the_edge() -> None:
    points = np.array([[0.001, 0.999], [-0.1, 0.5], [1.2, 0.5]])
    moved, peaks = refine(points, heat_with((63, 1, 9.0), (32, 0, 9.0), (32, 63, 9.0)))
    np.testing.assert_allclose(moved[0], [1 / 64, 63 / 64])
    np.testing.assert_array_equal(moved[1:], points[1:])
    np.testing.assert_array_equal(peaks[1:], 0.0)


def test_clarity_asks_only_what_lies_in_the_picture() -> None:
    points = np.full((33, 2), 50.0)
    peaks = np.full(33, 0.9)
    points[23:, 1] = 200.0  # legs below the lower edge ...
    peaks[23:] = 0.0  # ... have no heat
    assert clarity(points, peaks, 100, 100) == pytest.approx(0.9)
    points[13:, 1] = 200.0  # head and shoulders alone are no body
    assert clarity(points, peaks, 100, 100) == 0.0


def test_sigmoid_does_not_overflow() -> None:
    np.testing.assert_allclose(sigmoid(np.array([-1e9, 0.0, 1e9])), [0, 0.5, 1], atol=1e-20)
