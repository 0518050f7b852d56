"""One step of a Runge-Kutta rule, in the form that SciPy's ``solve_ivp`` takes for a method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.integrate import OdeSolver


class Kutta3(OdeSolver):  # type: ignore[misc]  # scipy is untyped
    """Kutta's third-order rule across the whole span at once, without error control.

    For short fixed steps it takes three evaluations where SciPy's RK23, which checks itself, takes four.
    Stable for modes slower than 2.5 / step: RotorPy's motors (5 ms) allow steps up to 12 ms.
    """

    t: float
    y: Float[np.ndarray, " n"]

    def __init__(
        self,
        fun: Callable[[float, Float[np.ndarray, " n"]], Float[np.ndarray, " n"]],
        t0: float,
        y0: Float[np.ndarray, " n"],
        t_bound: float,
        vectorized: bool = False,
        **_: Any,
    ) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)

    def _step_impl(self) -> tuple[bool, None]:
        h = self.t_bound - self.t
        k1 = self.fun(self.t, self.y)
        k2 = self.fun(self.t + h / 2, self.y + h / 2 * k1)
        k3 = self.fun(self.t_bound, self.y + h * (2 * k2 - k1))
        self.y = self.y + h / 6 * (k1 + 4 * k2 + k3)
        self.t = self.t_bound
        return True, None
