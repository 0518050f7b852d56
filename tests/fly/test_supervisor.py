"""The supervisor is stepped by hand: every row states time, situation and what must come out."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from wigwag.fly.supervisor import Action, Mode, Situation, Supervisor, SupervisorConfig
from wigwag.fly.values import HOVER, Command, Setpoint

S = 10**9
WALK = Setpoint((0.5, 0.2, 0.1), 0.3)


def seen(now_s: float, **changes: object) -> Situation:
    now = int(now_s * S)
    base = Situation(now, now, now, 4.0, 0.0, flying=True, landed=False, wanted=WALK)
    return replace(base, **changes)  # type: ignore[arg-type]


def following(config: SupervisorConfig | None = None) -> Supervisor:
    supervisor = Supervisor(config)
    ground = seen(0.0, flying=False, landed=True, command=Command.TAKE_OFF)
    assert supervisor.step(ground).action is Action.TAKE_OFF
    assert supervisor.step(seen(0.1, flying=False)).mode is Mode.TAKING_OFF
    assert supervisor.step(seen(0.2)).mode is Mode.FOLLOWING
    return supervisor


def test_grounded_sends_nothing_and_takes_no_movement() -> None:
    supervisor = Supervisor()
    verdict = supervisor.step(seen(0, flying=False, landed=True, command=Command.LEFT))
    assert (verdict.mode, verdict.setpoint, verdict.accepted) == (Mode.GROUNDED, HOVER, None)


def test_no_take_off_without_an_operator_in_view() -> None:
    supervisor = Supervisor()
    blind = seen(5, pose_ns=None, distance_m=None, flying=False, landed=True, command=Command.TAKE_OFF)
    assert supervisor.step(blind).action is Action.NONE
    assert supervisor.step(replace(blind, pose_ns=4 * S, distance_m=4.0)).action is Action.NONE


def test_follows_and_lets_movements_through() -> None:
    supervisor = following()
    assert supervisor.step(seen(1)).setpoint == WALK
    assert supervisor.step(seen(2, command=Command.UP)).accepted is Command.UP


@pytest.mark.parametrize(
    "mode", [Mode.TAKING_OFF, Mode.FOLLOWING, Mode.HOLDING, Mode.LANDING, Mode.LOST_PERSON]
)
def test_stop_and_land_win_from_every_mode_in_the_air(mode: Mode) -> None:
    for command, action, after in (
        (Command.STOP, Action.HOLD, Mode.HOLDING),
        (Command.LAND, Action.LAND, Mode.LANDING),
    ):
        supervisor = following()
        supervisor.mode = mode
        # Stop and land count even when nothing is known of the operator or the vehicle any more.
        verdict = supervisor.step(
            seen(9, pose_ns=0, state_ns=0, distance_m=None, flying=mode is not Mode.LANDING, command=command)
        )
        assert (verdict.mode, verdict.action, verdict.setpoint) == (after, action, HOVER)


def test_stop_holds_until_the_next_command() -> None:
    supervisor = following()
    supervisor.step(seen(1, command=Command.STOP))
    for step in range(300):
        verdict = supervisor.step(seen(1 + step / 30))
        assert verdict.mode is Mode.HOLDING
        assert verdict.setpoint == Setpoint((0, 0, 0), WALK.yaw_rate_rad_s)
    assert supervisor.step(seen(12, command=Command.CLOSER)).mode is Mode.FOLLOWING


def test_lost_person_stops_then_follows_again_or_lands() -> None:
    supervisor = following(SupervisorConfig(land_when_lost_s=5.0))
    assert supervisor.step(seen(1.4, pose_ns=int(1.0 * S))).mode is Mode.FOLLOWING
    verdict = supervisor.step(seen(1.6, pose_ns=int(1.0 * S)))
    assert (verdict.mode, verdict.setpoint) == (Mode.LOST_PERSON, HOVER)
    assert supervisor.step(seen(2)).mode is Mode.FOLLOWING
    assert supervisor.step(seen(3, pose_ns=2 * S)).mode is Mode.LOST_PERSON
    assert supervisor.step(seen(7.9, pose_ns=2 * S)).mode is Mode.LOST_PERSON
    assert supervisor.step(seen(8.1, pose_ns=2 * S)).action is Action.LAND


def test_stale_vehicle_state_holds() -> None:
    verdict = following().step(seen(2, state_ns=1 * S))
    assert (verdict.action, verdict.setpoint) == (Action.HOLD, HOVER)


def test_landing_ends_grounded() -> None:
    supervisor = following()
    supervisor.step(seen(1, command=Command.LAND))
    assert supervisor.step(seen(2, flying=False)).mode is Mode.LANDING
    assert supervisor.step(seen(3, flying=False, landed=True)).mode is Mode.GROUNDED


@given(
    distance=st.floats(0.1, 1.99),
    bearing=st.floats(-1, 1),
    forward=st.floats(-5, 5),
    left=st.floats(-5, 5),
)
def test_too_close_always_retreats(distance: float, bearing: float, forward: float, left: float) -> None:
    config = SupervisorConfig(max_speed_m_s=20.0)
    wanted = Setpoint((forward, left, 0.0), 0.0)
    verdict = following(config).step(seen(1, distance_m=distance, bearing_rad=bearing, wanted=wanted))
    ahead = np.array([np.cos(bearing), np.sin(bearing)])
    assert np.array(verdict.setpoint.velocity_m_s[:2]) @ ahead <= -config.retreat_m_s + 1e-9


@given(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 4))
@example((1.3e308, 1.3e308, 0.0, 0.0))  # finite, but its speed is not
def test_no_setpoint_beyond_the_limits(values: tuple[float, float, float, float]) -> None:
    supervisor, config = Supervisor(), SupervisorConfig()
    limited = supervisor.limited(Setpoint(values[:3], values[3]))
    assert np.isfinite([*limited.velocity_m_s, limited.yaw_rate_rad_s]).all()
    assert np.hypot(*limited.velocity_m_s[:2]) <= config.max_speed_m_s * (1 + 1e-9)
    assert abs(limited.velocity_m_s[2]) <= config.max_climb_m_s
    assert abs(limited.yaw_rate_rad_s) <= config.max_yaw_rate_rad_s


def test_a_vehicle_that_hovers_already_is_taken_over() -> None:
    supervisor = Supervisor(mode=Mode.FOLLOWING)
    assert supervisor.step(seen(1)).setpoint == WALK
    blind = Supervisor(mode=Mode.FOLLOWING).step(seen(1, pose_ns=None, distance_m=None))
    assert (blind.mode, blind.setpoint) == (Mode.LOST_PERSON, HOVER)
    ashore = Supervisor(mode=Mode.FOLLOWING).step(seen(1, flying=False, landed=True))
    assert (ashore.mode, ashore.setpoint) == (Mode.GROUNDED, HOVER)
