import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.datasets.lost import bridged, seen
from wigwag.errors import DataError

RAMP = np.arange(1.0, 21.0)[:, None, None] * np.ones((1, 20, 3))


def test_zero_and_infinite_frames_show_nobody() -> None:
    joints = RAMP.copy()
    joints[3] = 0
    joints[5, 7, 1] = np.nan
    joints[6, 0] = 0  # one joint at the origin is a place like any other
    assert np.flatnonzero(~seen(joints)).tolist() == [3, 5]


@given(st.sets(st.integers(1, 18), max_size=9))
def test_a_steady_movement_is_restored_exactly(lost: set[int]) -> None:
    joints = RAMP.copy()
    joints[sorted(lost)] = 0
    filled, said = bridged(joints, 15)
    np.testing.assert_allclose(filled, RAMP)
    assert said == (f"{len(lost)} frames without a person filled in" if lost else "")


def test_ends_are_cut_off_not_invented() -> None:
    joints = RAMP.copy()
    joints[:3], joints[-2:], joints[8] = 0, 0, 0
    filled, said = bridged(joints, 15)
    np.testing.assert_allclose(filled, RAMP[3:-2])
    assert said == "5 frames without a person cut off the ends, 1 frames without a person filled in"


def test_too_little_is_refused() -> None:
    nobody = np.zeros_like(RAMP)
    with pytest.raises(DataError, match="nobody is seen"):
        bridged(nobody, 15)
    glimpse = nobody.copy()
    glimpse[4:7] = 1
    with pytest.raises(DataError, match="seen in 3 of 20 frames only"):
        bridged(glimpse, 15)
    assert len(bridged(glimpse, 10)[0]) == 3, "at 10 Hz three frames are 0.3 s"
    holes = nobody.copy()
    holes[[0, 3, 6, 9, 12, 15, 18]] = 1
    with pytest.raises(DataError, match="lost in 12 of 19 frames"):
        bridged(holes, 15)
