import numpy as np
import pytest
from scipy.integrate import solve_ivp

from wigwag.sim.kutta import Kutta3


def error(h):
    """Of x'' = -x with x(0) = 1 after one step of h."""
    y = solve_ivp(lambda t, y: np.array([y[1], -y[0]]), (0.0, h), [1.0, 0.0], method=Kutta3).y[:, -1]
    return np.linalg.norm(y - [np.cos(h), -np.sin(h)])


def test_it_is_of_third_order():
    # A rule of order 3 errs by h^4 in one step: half the step, a sixteenth of the error.
    assert error(0.2) / error(0.1) == pytest.approx(16, rel=0.1)


def test_time_enters_where_it_should():
    # Integrates polynomials up to t^3 exactly (it is Simpson's rule for a right side without y).
    end = solve_ivp(lambda t, y: np.array([4 * t**3]), (1.0, 2.0), [0.0], method=Kutta3).y[0, -1]
    assert end == pytest.approx(15.0)


def test_it_takes_three_evaluations():
    calls = []
    solve_ivp(lambda t, y: calls.append(t) or -y, (0.0, 0.01), [1.0], method=Kutta3)
    assert calls == pytest.approx([0.0, 0.005, 0.01])
