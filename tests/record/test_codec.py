"""What is written as JSON comes back to the last bit."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import DataError
from wigwag.fly.fence import Polygon
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Situation
from wigwag.fly.values import Command, Setpoint, VehicleState
from wigwag.pilot import PilotConfig
from wigwag.pose.estimator import PoseConfig
from wigwag.record.codec import plain, revived, schema, text
from wigwag.skeleton import Pose


def again(kind: Any, value: Any) -> Any:
    return revived(kind, json.loads(text(value)))


@given(st.floats(), st.floats(width=32))
def test_every_number_comes_back(a: float, b: float) -> None:
    setpoint = Setpoint((a, b, 0.0), -0.0)
    back = again(Setpoint, setpoint)
    assert text(back) == text(setpoint)
    assert [v.hex() for v in back.velocity_m_s[:2] if math.isfinite(v)] == [
        float(v).hex() for v in (a, b) if math.isfinite(v)
    ]
    assert math.copysign(1.0, back.yaw_rate_rad_s) == -1.0


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_a_pose_comes_back_with_its_precision(kind: type) -> None:
    rng = np.random.default_rng(0)
    pose = Pose(
        rng.normal(size=(13, 3)).astype(kind), rng.uniform(size=13).astype(kind), 1 << 60, monocular=True
    )
    back = again(Pose, pose)
    assert back.joints.dtype == kind and back.visibility.dtype == kind
    np.testing.assert_array_equal(back.joints, pose.joints)
    assert (back.stamp_ns, back.monocular) == (1 << 60, True)


def test_settings_come_back_whatever_the_fence() -> None:
    assert again(PilotConfig, PilotConfig()) == PilotConfig()
    assert again(PoseConfig, PoseConfig()) == PoseConfig()
    assert again(PoseConfig | None, None) is None
    fence = Polygon(((-9.0, -9.0), (9.0, -9.0), (9.0, 9.0)))
    config = PilotConfig(supervisor=SupervisorConfig(fence=fence))
    assert again(PilotConfig, config) == config


def test_states_and_situations_come_back() -> None:
    state = VehicleState(np.arange(3.0), np.full(3, np.nan), 0.1, 5, battery=0.5, denied="no")
    back = again(VehicleState, state)
    assert text(back) == text(state) and np.isnan(back.velocity_m_s).all() and back.battery == 0.5
    situation = Situation(1, Craft.AIRBORNE, 2, 3, command=Command.UP, held_s=math.inf)
    assert again(Situation, situation) == situation
    assert again(dict[str, Command], {"a6": Command.STOP}) == {"a6": Command.STOP}


@pytest.mark.parametrize(
    ("kind", "value"),
    [(Command, "dance"), (Setpoint, {"velocity_m_s": [1.0]}), (float, None), (Command | None, 7), (int, "x")],
)
def test_what_cannot_be_is_told(kind: Any, value: Any) -> None:
    with pytest.raises(DataError, match="expected a "):
        revived(kind, value)


def test_what_a_newer_version_adds_is_passed_over() -> None:
    assert revived(Setpoint, {"yaw_rate_rad_s": 1.0, "roll": 3}) == Setpoint(yaw_rate_rad_s=1.0)


def test_viewers_are_told_what_can_be_plotted() -> None:
    described = schema(Situation)["properties"]
    assert described["now_ns"] == {"type": "integer"}
    assert described["distance_m"] == {"type": "number"}
    assert described["position_m"] == {"type": "array", "items": {"type": "number"}}
    assert described["craft"] == {"type": "string"}
    assert schema(Pose)["properties"]["visibility"]["items"] == {"type": "number"}
    assert "joints" not in schema(Pose)["properties"], "an array of arrays, which Foxglove refuses"
    json.dumps(schema(PilotConfig))
    assert plain({"a": np.bool_(True), "b": np.float32(0.5)}) == {"a": True, "b": 0.5}
