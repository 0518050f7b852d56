import numpy as np
import pytest

from wigwag.sim.feet import Feet
from wigwag.sim.person import Person

DT = 1 / 60


def walk(velocity, seconds=6.0, heading=0.0, turn_rate=0.0):
    """Move a body evenly; return its feet (n, 2, 4) and its places (n, 2)."""
    root, feet = np.zeros(2), Feet(Person(), np.zeros(2), heading)
    rows, roots = [], []
    for _ in range(round(seconds / DT)):
        root = root + np.asarray(velocity) * DT
        heading += turn_rate * DT
        rows.append(feet.step(DT, root, np.asarray(velocity, float), heading, turn_rate))
        roots.append(root)
    return np.array(rows), np.array(roots)


def test_standing_feet_stay():
    rows, _ = walk((0, 0))
    assert np.ptp(rows, axis=0).max() == 0


@pytest.mark.parametrize("velocity", [(0.7, 0), (-0.7, 0), (0, 0.7), (0, -0.7), (0.4, 0.4), (0.15, 0)])
def test_feet_keep_up_with_the_body_and_do_not_slide(velocity):
    rows, roots = walk(velocity)
    middle = rows[..., :2].mean(axis=1)
    assert np.linalg.norm(middle - roots, axis=1).max() < 0.35
    rate = np.linalg.norm(np.diff(rows[..., :2], axis=0), axis=2) / DT
    planted = (rows[1:, :, 2] == 0) & (rows[:-1, :, 2] == 0)
    assert rate[planted].max() < 0.05, "a foot on the ground does not slide"
    assert planted.any(axis=1).all(), "one foot is always on the ground"
    assert rate.max() < 4.5
    assert 0.03 < rows[..., 2].max() < 0.12


@pytest.mark.parametrize("velocity", [(0.0, 0.7), (0.0, -0.7)])
def test_feet_do_not_cross_when_walking_sideways(velocity):
    rows, _ = walk(velocity)
    assert (rows[:, 0, 1] - rows[:, 1, 1]).min() > 0.05


def test_feet_turn_with_the_body():
    rows, _ = walk((0, 0), seconds=4.0, turn_rate=1.0)
    lag = rows[:, :, 3].mean(axis=1) - np.arange(1, len(rows) + 1) * DT
    assert np.abs(lag).max() < 0.7


def test_feet_end_up_below_the_body_once_it_stands():
    person, root = Person(), np.zeros(2)
    feet = Feet(person, root, 0.0)
    for i in range(300):
        velocity = np.array([0.6, 0.2]) if i < 120 else np.zeros(2)
        root = root + velocity * DT
        rows = feet.step(DT, root, velocity, 0.0, 0.0)
    assert rows[:, 2].max() == 0
    np.testing.assert_allclose(rows[:, :2].mean(axis=0), root, atol=0.07)
    assert rows[0, 1] - rows[1, 1] == pytest.approx(2 * person.stance_half_m, abs=0.08)


def test_placed_feet_are_where_they_were_put():
    feet = Feet(Person(), np.zeros(2), 0.0)
    feet.place(np.array([[1.0, 1.11], [1.0, 0.89]]))
    rows = feet.step(DT, np.array([1.0, 1.0]), np.zeros(2), 0.0, 0.0)
    np.testing.assert_allclose(rows[:, :2], [[1.0, 1.11], [1.0, 0.89]])
