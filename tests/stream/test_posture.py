"""A body in its own frame: where a person stands, how tall they are and where they look does not matter."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.stream.posture import Postures

BODY = np.random.default_rng(3).normal(0, 0.3, (13, 3))
BODY[[1, 2, 7, 8]] = [[0.2, -0.5, 0.0], [-0.2, -0.5, 0.0], [0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]]


def followed(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    postures = Postures()
    placed, moved = zip(*(postures.update(row) for row in rows), strict=True)
    return np.array(placed), np.array(moved)


def moving() -> np.ndarray:
    rows = np.tile(BODY, (60, 1, 1))
    rows[:, 5, 1] -= np.sin(np.linspace(0, 3, 60))
    return rows


@pytest.mark.parametrize("turn_rad", [-1.2, 0.0, 0.4])
@pytest.mark.parametrize("size", [0.7, 1.0, 1.3])
def test_place_size_and_direction_do_not_matter(turn_rad: float, size: float) -> None:
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    other = size * moving() @ turn.T + [0.4, -0.2, 3.0]
    np.testing.assert_allclose(followed(other)[0], followed(moving())[0], atol=1e-9)


def test_the_hips_speed_is_said_in_torsos_a_second() -> None:
    rows = moving() + np.arange(60)[:, None, None] / 30 * [0.0, 0.25, 0.0]
    moved = followed(rows)[1]
    assert (moved[:3] == 0).all()
    np.testing.assert_allclose(moved[5:], np.tile([0.0, 0.5, 0.0], (55, 1)), atol=1e-9)


def test_a_body_in_one_point_stays_finite() -> None:
    placed, moved = followed(np.zeros((5, 13, 3)))
    assert np.isfinite(placed).all() and np.isfinite(moved).all()


def test_forgetting_begins_anew() -> None:
    postures = Postures()
    first = [postures.update(row)[0] for row in moving()]
    postures.reset()
    again = [postures.update(row)[0] for row in moving()]
    np.testing.assert_array_equal(first, again)
