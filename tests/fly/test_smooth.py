"""A velocity that changes smoothly."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from wigwag.fly.smooth import Smoother

DT = 1 / 30


@given(
    st.lists(st.tuples(*[st.floats(-3, 3)] * 3), min_size=1, max_size=6), st.floats(0.5, 3), st.floats(2, 20)
)
def test_acceleration_and_jerk_are_bounded(wishes: list, acceleration: float, jerk: float) -> None:  # type: ignore[type-arg]
    smooth, last, last_change = Smoother(acceleration, jerk), np.zeros(3), np.zeros(3)
    for wish in wishes:
        for _ in range(20):
            now = smooth(np.array(wish), DT)
            change = (now - last) / DT
            assert np.linalg.norm(change) <= acceleration * (1 + 1e-9)
            assert np.linalg.norm(change - last_change) / DT <= jerk * (1 + 1e-6)
            last, last_change = now, change


def test_it_arrives_and_hardly_overshoots() -> None:
    smooth, wish = Smoother(1.2, 10.0), np.array([1.0, -0.5, 0.2])
    way = np.array([smooth(wish, DT) for _ in range(90)])
    assert np.abs(way[-1] - wish).max() < 1e-3
    assert (way @ wish).max() / (wish @ wish) < 1.03


def test_no_time_no_change_and_a_reset_begins_from_standing() -> None:
    smooth = Smoother(1.0, 10.0)
    first = smooth(np.array([1.0, 0, 0]), 0.1)
    assert smooth(np.array([5.0, 0, 0]), 0.0) is first
    smooth.reset()
    assert not smooth(np.zeros(3), 0.1).any()
