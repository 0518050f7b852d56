"""Vehicles by how they answer."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint
from wigwag.sim.quadrotor import EstimateConfig
from wigwag.sim.response import Response, ResponseConfig, ardupilot_like, px4_like
from wigwag.sim.wind import WindConfig

DT = 0.01
AHEAD = Setpoint((1.0, 0.0, 0.0))
EXACT = EstimateConfig.exact()


def fly(airframe: Response, setpoint: Setpoint, seconds: float) -> np.ndarray:
    rows = []
    for _ in range(round(seconds / DT)):
        airframe.step(setpoint, DT)
        rows.append([*airframe.state.velocity_m_s, airframe.state.heading_rad])
    return np.array(rows)


@pytest.mark.parametrize(("make", "most"), [(px4_like, 1.25), (ardupilot_like, 1.12)])
def test_motion_sets_in_as_late_as_was_seen(make, most) -> None:
    speed = fly(Response(make(estimate=EXACT)), AHEAD, 4.0)[:, 0]
    begins_s = DT * int(np.argmax(speed > 0.1))
    assert 0.15 < begins_s < 0.35, "0.25 s on both autopilots"
    assert speed[-1] == pytest.approx(1.0, abs=0.02)
    assert speed.max() < most
    turned = fly(Response(make(estimate=EXACT)), Setpoint((0, 0, 0), 1.0), 1.0)[:, 3]
    assert 0.08 < DT * int(np.argmax(turned > 0.02)) < 0.25, "0.13 to 0.18 s"
    assert turned[-1] == pytest.approx(1.0 - 0.15, abs=0.05)


def test_px4_overshoots_and_ardupilot_does_not() -> None:
    peaks = [
        fly(Response(make(estimate=EXACT)), AHEAD, 4.0)[:, 0].max() for make in (px4_like, ardupilot_like)
    ]
    assert peaks[0] > 1.08 and peaks[0] > peaks[1]


def test_a_state_is_told_late_with_its_own_stamp() -> None:
    airframe = Response(ResponseConfig(telemetry_s=0.1, estimate=EXACT))
    fly(airframe, AHEAD, 1.0)
    told, true = airframe.measured, airframe.state
    assert 0.09e9 <= true.stamp_ns - told.stamp_ns <= 0.12e9
    assert told.position_m[0] < true.position_m[0] - 0.05


def test_the_same_seed_flies_the_same_and_wind_moves_it() -> None:
    wind = WindConfig(gust_m_s=3.0)
    places = [
        (fly(a := Response(px4_like(wind=wind), seed), AHEAD, 2.0), a.state.position_m)[1]
        for seed in (1, 1, 2)
    ]
    assert (places[0] == places[1]).all() and (places[0] != places[2]).any()
    pushed = Response(ResponseConfig(estimate=EXACT))
    pushed.push_m_s2 = np.array([0.0, 3.0, 0.0])
    assert fly(pushed, Setpoint(), 1.0)[-1, 1] > 0.2


def test_ground_and_motors() -> None:
    airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0), estimate=EXACT))
    fly(airframe, Setpoint((0.0, 0.0, 1.0)), 1.0)
    assert airframe.on_ground and not airframe.state.armed
    airframe.set_motors(True)
    fly(airframe, Setpoint((0.0, 0.0, 1.0)), 2.0)
    assert not airframe.on_ground
    airframe.set_motors(False)
    fly(airframe, Setpoint(), 2.0)
    assert airframe.on_ground and not airframe.state.velocity_m_s.any()


def test_accelerating_it_leans() -> None:
    airframe = Response(ResponseConfig(estimate=EXACT))
    fly(airframe, AHEAD, 0.3)
    assert airframe.state.pitch_rad > 0.02, "nose down"
    airframe = Response(ResponseConfig(estimate=EXACT))
    fly(airframe, Setpoint((0.0, 1.0, 0.0)), 0.3)
    assert airframe.state.roll_rad < -0.02, "left side down"


@pytest.mark.parametrize("change", [{"dead_time_s": -1.0}, {"damping": 0.0}, {"yaw_lag_s": 0.0}])
def test_what_would_be_unstable_is_an_error(change: dict) -> None:  # type: ignore[type-arg]
    with pytest.raises(InputError, match="ResponseConfig needs"):
        ResponseConfig(**change)
