from pathlib import Path

import numpy as np
import pytest

from tests.datasets.trees import UTD, needs_utd, tree
from wigwag.errors import InputError
from wigwag.evaluate.smooth import FILTERS, SmoothConfig, lag_ms, measure_smooth, overshoot


def swing(seconds: float = 3.0, rate_hz: float = 30.0) -> np.ndarray:
    t = np.arange(0, seconds, 1 / rate_hz)
    return (
        np.stack([np.sin(5 * t), 0.3 * np.sin(9 * t), 0.0 * t], axis=1) * np.exp(-((t - 1.5) ** 2))[:, None]
    )


@pytest.mark.parametrize("frames", [0, 1, 3])
def test_lag_is_how_much_later(frames: int) -> None:
    true = swing()
    found = np.concatenate([np.repeat(true[:1], frames, axis=0), true])[: len(true)]
    assert lag_ms(true, found, 30.0) == pytest.approx(frames * 1000 / 30, abs=2.0)


def test_lag_is_told_between_the_frames() -> None:
    fine = swing(rate_hz=240.0)
    true, found = fine[8::8], fine[4:-4:8]  # found is half a frame, 16.7 ms, late
    assert lag_ms(true, found[: len(true)], 30.0) == pytest.approx(16.7, abs=1.5)


def test_overshoot_is_a_share_of_the_range() -> None:
    true = swing()
    assert overshoot(true, true) == 0.0
    assert overshoot(true, 0.9 * true) == 0.0
    assert overshoot(true, 1.2 * true) == pytest.approx(0.1, abs=0.03)


def test_every_filter_is_measured_at_every_rate(tmp_path: Path) -> None:
    root = tree(tmp_path, actions=(1, 2), subjects=(2,), trials=(1,))
    config = SmoothConfig(labels=("a1", "a2"), rates_hz=(18.0, 30.0))
    rows = measure_smooth(root, config)
    assert [(row["filter"], row["rate_hz"]) for row in rows] == [
        (name, rate) for rate in (18.0, 30.0) for name in FILTERS
    ]
    for row in rows:
        assert row["clips"] == 2
        assert all(np.isfinite(value) for value in row.values() if not isinstance(value, str))
    assert {row["lag_ms_max"] for row in rows if row["filter"] == "none"} <= {
        row["lag_ms_max"] for row in rows if row["filter"] == "by visibility"
    }
    assert measure_smooth(root, config) == rows, "the seed decides"


@pytest.mark.parametrize("fields", [{"distance_m": 0.0}, {"rates_hz": (30.0, -1.0)}])
def test_faults(fields: dict) -> None:
    with pytest.raises(InputError, match="distance_m and rates_hz above 0"):
        SmoothConfig(**fields)


@needs_utd
def test_the_published_swings() -> None:
    """The issue's bounds, on one of the people on whom nothing was chosen."""
    rows = {row["filter"]: row for row in measure_smooth(UTD, SmoothConfig(subjects=("s2",)))}
    mine, none = rows["PoseFilter"], rows["none"]
    assert mine["lag_ms_max"] <= 50.0
    assert mine["overshoot_max"] <= 0.01
    assert mine["rms_mm"] < none["rms_mm"]
    assert mine["rest_jitter_mm"] < 0.7 * none["rest_jitter_mm"]
