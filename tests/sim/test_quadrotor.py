import math

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.fly.operator import rotation
from wigwag.fly.values import Setpoint
from wigwag.sim.quadrotor import EstimateConfig, Quadrotor, QuadrotorConfig
from wigwag.sim.wind import Gusts, WindConfig

DT = 1 / 30


def calm(**changes):
    return QuadrotorConfig(wind=WindConfig(gust_m_s=0.0), estimate=EstimateConfig.exact(), **changes)


def fly(quad, setpoint, seconds):
    for _ in range(round(seconds / DT)):
        quad.step(setpoint, DT)


def level_velocity(state):
    """True velocity along heading, to the left of it, and up."""
    c, s = math.cos(state.heading_rad), math.sin(state.heading_rad)
    x, y, z = state.velocity_m_s
    return np.array([c * x + s * y, -s * x + c * y, z])


@pytest.mark.parametrize(
    "velocity",
    [(0.75, 0.0, 0.0), (-0.5, 0.0, 0.0), (0.0, 0.6, 0.0), (0.0, 0.0, 0.5), (1.5, 0.5, -0.2)],
)
def test_commanded_velocity_is_reached_within_5_percent(velocity):
    quad = Quadrotor(calm(heading_rad=1.0, position_m=(0.0, 0.0, 3.0)))
    fly(quad, Setpoint(velocity), 1.5)
    speed = np.linalg.norm(velocity)
    assert np.linalg.norm(level_velocity(quad.state) - velocity) < 0.05 * speed
    fly(quad, Setpoint(velocity), 1.5)
    assert np.linalg.norm(level_velocity(quad.state) - velocity) < 0.02 * speed
    assert quad.state.heading_rad == pytest.approx(1.0, abs=0.01)


def test_forward_moves_along_the_heading_and_left_to_the_left_of_it():
    for heading in (0.0, math.pi / 2, -2.0):
        ahead = np.array([math.cos(heading), math.sin(heading)])
        left = np.array([-ahead[1], ahead[0]])
        for setpoint, wanted in ((Setpoint((1.0, 0, 0)), ahead), (Setpoint((0, 1.0, 0)), left)):
            quad = Quadrotor(calm(heading_rad=heading))
            fly(quad, setpoint, 1.0)
            moved = quad.state.position_m[:2]
            assert moved @ wanted > 0.6
            assert abs(moved @ [-wanted[1], wanted[0]]) < 0.03


def test_positive_yaw_rate_turns_anticlockwise_at_the_rate_asked_for():
    quad = Quadrotor(calm())
    fly(quad, Setpoint((0, 0, 0), 0.8), 1.0)
    before = quad.state.heading_rad
    fly(quad, Setpoint((0, 0, 0), 0.8), 1.0)
    assert quad.state.heading_rad - before == pytest.approx(0.8, rel=0.02)
    assert 0.6 < before < 0.8
    assert np.linalg.norm(quad.state.position_m - [0, 0, 1.5]) < 0.02


def test_flying_forward_pitches_the_nose_down_and_left_lifts_the_right_side():
    quad = Quadrotor(calm(heading_rad=0.7))
    fly(quad, Setpoint((1.0, 0, 0)), 0.25)
    assert quad.state.pitch_rad > 0.05
    quad = Quadrotor(calm(heading_rad=0.7))
    fly(quad, Setpoint((0, 1.0, 0)), 0.25)
    assert quad.state.roll_rad < -0.05
    assert rotation(quad.state) == pytest.approx(quad.rotation, abs=1e-9)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_holds_within_30_cm_in_gusts_of_2_m_s(seed):
    quad = Quadrotor(QuadrotorConfig(), seed=seed)
    worst = 0.0
    for _ in range(300):
        quad.step(Setpoint(), DT)
        worst = max(worst, float(np.linalg.norm(quad.state.position_m - [0, 0, 1.5])))
    assert 0.01 < worst < 0.3


def test_the_gusts_blow_as_hard_as_configured():
    gusts = Gusts(WindConfig(gust_m_s=2.0, mean_m_s=(1.0, 0.0, 0.0)), seed=3)
    wind = np.array([gusts.update(0.05 * k, np.zeros(3)) for k in range(1, 40_000)])
    around = wind - [1.0, 0.0, 0.0]
    assert np.sqrt((around[:, :2] ** 2).sum(axis=1).mean()) == pytest.approx(2.0, rel=0.1)
    assert np.abs(wind.mean(axis=0) - [1, 0, 0]).max() < 0.2
    # After one gust time 1/e of it is left.
    lag = round(1.5 / 0.05)
    kept = (around[lag:, 0] * around[:-lag, 0]).mean() / (around[:, 0] ** 2).mean()
    assert kept == pytest.approx(math.exp(-1), abs=0.06)


def test_wind_tilts_the_drone():
    steady = WindConfig(gust_m_s=0.0, mean_m_s=(4.0, 0.0, 0.0))
    quad = Quadrotor(QuadrotorConfig(wind=steady, estimate=EstimateConfig.exact()))
    fly(quad, Setpoint(), 4.0)
    assert quad.state.pitch_rad < -0.05  # leans into wind that comes from behind
    assert np.linalg.norm(quad.state.velocity_m_s) < 0.03


def test_what_it_believes_strays_as_configured():
    ends, noise = [], []
    config = EstimateConfig(position_walk_m=0.05, velocity_noise_m_s=0.1, heading_noise_rad=0.01)
    for seed in range(25):
        quad = Quadrotor(QuadrotorConfig((0.0, 0.0, 0.0), wind=WindConfig(0.0), estimate=config), seed)
        for _ in range(120):
            quad.step(Setpoint(), DT)  # motors off: the truth stands still
            noise.append(quad.measured.velocity_m_s)
        ends.append(quad.measured.position_m)
    assert np.std(ends) == pytest.approx(0.05 * math.sqrt(4.0), rel=0.25)
    assert np.std(noise) == pytest.approx(0.1, rel=0.05)


def test_an_exact_estimate_is_the_truth_counted_from_home():
    quad = Quadrotor(calm(position_m=(3.0, -2.0, 1.0), heading_rad=0.4))
    fly(quad, Setpoint((0.5, 0, 0.2), 0.3), 1.0)
    assert quad.measured.position_m == pytest.approx(quad.state.position_m - [3.0, -2.0, 0.0])
    assert quad.measured.velocity_m_s == pytest.approx(quad.state.velocity_m_s)
    assert quad.measured.heading_rad == pytest.approx(quad.state.heading_rad)
    assert quad.measured.stamp_ns == quad.state.stamp_ns == round(1e9)


def test_the_same_seed_flies_the_same_way():
    paths = []
    for seed in (7, 7, 8):
        quad = Quadrotor(seed=seed)
        fly(quad, Setpoint((0.5, 0.1, 0), 0.2), 1.0)
        paths.append(quad.state.position_m)
    assert np.array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])


def test_it_stands_still_with_motors_off_and_falls_when_they_stop_in_the_air():
    quad = Quadrotor(QuadrotorConfig((0.0, 0.0, 0.0)))
    assert quad.on_ground
    assert not quad.state.armed
    fly(quad, Setpoint((1.0, 0, 1.0)), 0.5)
    assert quad.state.position_m == pytest.approx([0, 0, 0], abs=1e-12)
    quad = Quadrotor(calm())
    quad.set_motors(False)
    fly(quad, Setpoint(), 1.2)
    assert quad.on_ground


def test_bad_configuration_is_an_error():
    with pytest.raises(InputError, match="below the ground"):
        QuadrotorConfig((0.0, 0.0, -1.0))
    with pytest.raises(InputError, match="rate_hz"):
        QuadrotorConfig(rate_hz=50.0)
