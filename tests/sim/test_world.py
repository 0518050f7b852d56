import dataclasses
import math

import numpy as np
import pytest

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import Setpoint
from wigwag.sim.exposure import ExposureConfig
from wigwag.sim.paint import Look
from wigwag.sim.quadrotor import EstimateConfig, QuadrotorConfig
from wigwag.sim.scene import SceneConfig
from wigwag.sim.wind import WindConfig
from wigwag.sim.world import World, WorldConfig
from wigwag.vehicles import FlightMode

from .people import standing

SMALL = Intrinsics(fx=150.0, fy=150.0, cx=80.0, cy=60.0, width=160, height=120)
CALM = QuadrotorConfig(wind=WindConfig(gust_m_s=0.0), estimate=EstimateConfig.exact())


class Statue:
    """Stands where it is told and notes what it is told."""

    def __init__(self, at=(4.0, 0.0)):
        self.at, self.heard = at, []

    def step(self, t_s, dt_s, drone_position_m):
        self.heard.append((t_s, dt_s, drone_position_m.copy()))
        return standing("tee", at=self.at)


class Walker(Statue):
    def step(self, t_s, dt_s, drone_position_m):
        return standing("down", at=(4.0, 0.75 * t_s))


def world(operator=None, seed=1, **changes):
    changes = {
        "intrinsics": SMALL,
        "scene": SceneConfig(clutter=0),
        "quadrotor": CALM,
        "noise": None,
        **changes,
    }
    return World(WorldConfig(**changes), seed, operator or Statue())


def test_frames_come_at_the_rate_of_the_camera_and_late():
    w = world(delay_frames=1)
    stamps = [w.step().stamp_ns for _ in range(10)]
    assert np.abs(np.diff(stamps) - 1e9 / 30).max() <= 1
    assert w.now_ns - stamps[-1] == pytest.approx(1e9 / 30, abs=1)
    assert w.truth.stamp_ns == stamps[-1]
    assert w.truth_now.stamp_ns == w.now_ns
    prompt = world(delay_frames=0)
    assert prompt.step().stamp_ns == prompt.now_ns
    late = world(delay_frames=3)
    stamps = [late.step().stamp_ns for _ in range(6)]
    assert (np.diff(stamps) > 0).all()
    assert late.now_ns - stamps[-1] == pytest.approx(1e8, abs=2)


def test_the_picture_shows_what_was_when_it_was_taken():
    late, prompt = world(Walker(), delay_frames=2), world(Walker(), delay_frames=0)
    seen = {}
    for _ in range(8):
        frame = prompt.step()
        seen[frame.stamp_ns] = frame
    for _ in range(8):
        frame = late.step()
        if frame.stamp_ns > 0:
            assert np.array_equal(frame.rgb, seen[frame.stamp_ns].rgb)
            assert late.truth.hip_center_m[1] == pytest.approx(0.75 * frame.stamp_ns * 1e-9, abs=1e-6)


def test_the_true_hips_are_where_the_picture_shows_a_body():
    tilted = Mount(pitch_down_rad=0.15, offset_m=(0.1, 0.0, 0.05))
    w = world(Statue((4.0, 0.8)), quadrotor=dataclasses.replace(CALM, heading_rad=0.25), mount=tilted)
    for _ in range(5):
        frame = w.step(Setpoint((0.6, 0.3, 0.1), 0.2))
    hips = w.truth.hip_center_camera_m
    u, v = np.round(SMALL.project(hips)).astype(int)
    assert 0.03 < hips[2] - frame.depth_mm[v, u] / 1000 < 0.2
    assert np.linalg.norm(w.truth.camera.to_world(hips) - w.truth.hip_center_m) < 1e-9


def test_truth_and_mount_agree_with_the_rooms_above():
    w = world()
    for _ in range(15):
        w.step(Setpoint((0.8, -0.4, 0.2), 0.5))
    truth, mount = w.truth_now, w.config.mount
    body = mount.to_body(truth.camera.to_camera(truth.hip_center_m))
    assert rotation(truth.drone) @ body + truth.drone.position_m == pytest.approx(
        truth.hip_center_m, abs=1e-9
    )


def test_bearing_is_positive_to_the_left_and_distance_is_level():
    w = world(Statue((3.0, 1.0)))
    assert w.truth_now.bearing_rad == pytest.approx(math.atan2(1.0, 3.0), abs=1e-3)
    assert w.truth_now.distance_m == pytest.approx(math.hypot(3.0, 1.0), abs=1e-3)
    behind = world(Statue((-3.0, -1e-3)), quadrotor=dataclasses.replace(CALM, heading_rad=3.0))
    assert abs(behind.truth_now.bearing_rad - (math.pi - 3.0)) < 0.01


def test_the_operator_hears_time_run_forward_and_where_the_drone_is():
    operator = Statue()
    w = world(operator)
    for _ in range(5):
        w.step(Setpoint((0.5, 0.0, 0.0)))
    times = np.array([t for t, _, _ in operator.heard])
    assert (np.diff(times) > 0).all()
    assert all(dt == pytest.approx(1 / 30) for _, dt, _ in operator.heard)
    assert operator.heard[-1][2] == pytest.approx(w.truth_now.drone.position_m)


def test_time_does_not_drift():
    w = world(rate_hz=60.0)
    for k in range(1, 61):
        w.step()
        assert w.now_ns == round(k * 1e9 / 60)


def test_starts_on_the_ground_if_so_configured():
    w = world(quadrotor=dataclasses.replace(CALM, position_m=(0.0, 0.0, 0.0)))
    w.step(Setpoint((1.0, 0, 0)))
    assert w.vehicle.mode is FlightMode.DISARMED
    assert w.truth_now.drone.position_m[2] == 0.0
    w.vehicle.arm()
    w.vehicle.take_off(1.2)
    for _ in range(120):
        w.step()
    assert w.vehicle.mode is FlightMode.HOLDING
    assert w.truth_now.drone.position_m[2] == pytest.approx(1.2, abs=0.1)


def test_the_same_seed_makes_the_same_world():
    frames = []
    for seed in (3, 3, 4):
        w = World(WorldConfig(intrinsics=SMALL), seed, Statue())
        for _ in range(4):
            frame = w.step(Setpoint((0.3, 0.1, 0.0), 0.1))
        frames.append(frame)
    assert np.array_equal(frames[0].rgb, frames[1].rgb)
    assert np.array_equal(frames[0].depth_mm, frames[1].depth_mm)
    assert not np.array_equal(frames[0].depth_mm, frames[2].depth_mm)


def test_the_time_each_part_takes_is_counted():
    ticks = iter(range(10_000))
    w = World(
        WorldConfig(intrinsics=SMALL, scene=SceneConfig(clutter=0)),
        1,
        Statue(),
        clock=lambda: next(ticks) * 1e-3,
    )
    w.step()
    spent = w.spent
    assert (spent.physics_ms, spent.operator_ms, spent.render_ms, spent.noise_ms) == pytest.approx(
        (1, 1, 1, 1)
    )


def test_bad_configuration_is_an_error():
    with pytest.raises(InputError, match="rate_hz"):
        WorldConfig(rate_hz=0.0)
    with pytest.raises(InputError, match="delay_frames"):
        WorldConfig(delay_frames=-1)


def test_a_late_camera_brings_the_pictures_of_a_prompt_one():
    late, prompt = world(Walker(), delay_frames=3), world(Walker(), delay_frames=0)
    late_by_stamp = {frame.stamp_ns: frame for frame in (late.step() for _ in range(12))}
    for _ in range(9):
        frame = prompt.step()
        assert np.array_equal(frame.depth_mm, late_by_stamp[frame.stamp_ns].depth_mm)


def test_others_are_in_the_picture_in_the_depth_and_in_the_truth():
    beside, before = Statue((4.0, 1.2)), Statue((2.5, -0.1))
    w = World(
        WorldConfig(intrinsics=SMALL, scene=SceneConfig(clutter=0), quadrotor=CALM, noise=None), 1, Statue(),
        others=[(beside, Look.from_seed(7)), (before, Look.from_seed(8))],
    )  # fmt: skip
    frame, truth = w.step(), w.truth
    assert truth.hip_center_m[:2] == pytest.approx((4.0, 0.0), abs=0.05)
    assert truth.other_hip_centers_m[:, :2] == pytest.approx(np.array([beside.at, before.at]), abs=0.05)
    for hips, metres in zip(truth.other_hip_centers_m, (4.0, 2.5), strict=True):
        u, v = np.round(SMALL.project(truth.camera.to_camera(hips))).astype(int)
        assert frame.depth_mm[v, u] / 1000 == pytest.approx(metres - 0.2, abs=0.25)
    assert len(beside.heard) == len(before.heard) == 2, "everybody lives on the same clock"


def test_alone_there_are_no_others():
    assert world().truth.other_hip_centers_m.shape == (0, 3)


def test_in_the_dark_pictures_are_darker_and_depth_is_as_it_was():
    light, dark = world(), world(exposure=ExposureConfig(light=0.005))
    one, other = light.step(), dark.step()
    assert other.rgb.mean() < 0.5 * one.rgb.mean()
    assert np.array_equal(one.depth_mm, other.depth_mm)
