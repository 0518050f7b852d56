import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.fly.operator import rotation
from wigwag.fly.values import VehicleState
from wigwag.vehicles.mavlink.frames import attitude_of, body_to_ned, flip, heading_of, ned_to_body, ned_to_enu

angles = st.floats(-math.pi, math.pi)
tilts = st.floats(-1.4, 1.4)
speeds = st.floats(-20, 20)
velocities = st.tuples(speeds, speeds, speeds)


def aerospace(roll, pitch, yaw):
    """FRD to NED, turns about z, then y, then x, written out (MAVLink's ATTITUDE)."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return np.array([
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp, sr * cp, cr * cp],
    ])  # fmt: skip


@given(velocities, angles)
def test_there_and_back(velocity, heading):
    assert ned_to_body(body_to_ned(velocity, heading), heading) == pytest.approx(velocity, abs=1e-9)


@given(velocities, angles)
def test_speed_and_climb_are_kept(velocity, heading):
    ned = body_to_ned(velocity, heading)
    assert math.hypot(*ned[:2]) == pytest.approx(math.hypot(*velocity[:2]), abs=1e-9)
    assert ned[2] == -velocity[2]


@given(velocities, angles)
def test_agrees_with_the_rotation_that_the_follow_law_uses(velocity, heading):
    level = VehicleState(np.zeros(3), np.zeros(3), heading, 0)
    assert ned_to_enu(*body_to_ned(velocity, heading)) == pytest.approx(
        rotation(level) @ np.array(velocity), abs=1e-9
    )


@given(tilts, tilts, angles, velocities)
def test_a_tilted_body_points_the_same_way_in_both_worlds(roll, pitch, yaw, vector):
    """wigwag's roll, pitch, heading (FLU to ENU) turn a vector where MAVLink's own (FRD to NED) do."""
    roll_flu, pitch_flu, heading = attitude_of(roll, pitch, yaw)
    state = VehicleState(np.zeros(3), np.zeros(3), heading, 0, roll_flu, pitch_flu)
    by_mavlink = ned_to_enu(*(aerospace(roll, pitch, yaw) @ np.array(flip(*vector))))
    assert rotation(state) @ np.array(vector) == pytest.approx(by_mavlink, abs=1e-9)


@given(angles)
def test_a_heading_and_a_yaw_are_each_others_mirror(angle):
    back = heading_of(heading_of(angle))
    assert math.cos(back - angle) == pytest.approx(1.0)
    assert -math.pi <= back <= math.pi


def test_the_compass():
    assert heading_of(0.0) == pytest.approx(math.pi / 2)  # north
    assert heading_of(math.pi / 2) == pytest.approx(0.0)  # east
    assert heading_of(math.pi) == pytest.approx(-math.pi / 2)  # south
    assert body_to_ned((1, 0, 0), heading_of(0.0)) == pytest.approx((1, 0, 0), abs=1e-12)
    assert body_to_ned((0, 1, 0), heading_of(0.0)) == pytest.approx((0, -1, 0), abs=1e-12)  # left is west
