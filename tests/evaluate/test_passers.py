"""Sessions with passers-by: who walks where."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.evaluate.passers import CONDITIONS, stage


@pytest.mark.parametrize(
    "name", ["clutter", "stops beside, shows commands", "stops before", "takes the place"]
)
@pytest.mark.parametrize("seed", [814, 2])
def test_nobody_walks_through_the_operator(name: str, seed: int) -> None:
    """With seed 814 they once did, when changing sides after a stop; nobody can say whose pose that was."""
    staged = stage(next(c for c in CONDITIONS if c.name == name), 4.0, 3, seed)
    operator, *others = [staged.world._operator, *(body for body, _ in staged.world._others)]
    nearest_m, drone = np.inf, np.array([0.0, 0.0, 1.3])
    for k in range(1, int(10 * staged.duration_s)):
        for body in (operator, *others):
            body.step(k / 10, 0.1, drone)
        nearest_m = min(nearest_m, *(float(np.hypot(*(body.root_xy - operator.root_xy))) for body in others))
    assert 0.6 < nearest_m < 1.5, "near enough to be hard, and clear of the operator's body"
