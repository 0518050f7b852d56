"""A person without pixels before a vehicle that lives elsewhere."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from wigwag.errors import CameraError
from wigwag.fly.operator import Mount
from wigwag.fly.values import VehicleState
from wigwag.sim.clips import SensorConfig
from wigwag.sim.stage import Arc, Stage, StageConfig

S = 10**9
CLEAN = SensorConfig(sideways_m=0.0, depth_per_m=0.0, glitch_share=0.0, bias=False, session_bias_m=0.0)
LEVEL = Mount(offset_m=(0.0, 0.0, 0.0))


class Carrier:
    """A vehicle that stands somewhere, on a clock turned by hand."""

    def __init__(self, **settings: object) -> None:
        at = np.array([7.0, -3.0, 1.2])
        self.state = VehicleState(at, np.zeros(3), math.radians(100), 50 * S)
        self.silent = False
        config = StageConfig(**{"distance_m": 4.5, "sensor": CLEAN, "mount": LEVEL, **settings})  # type: ignore[arg-type]
        self.now_ns = 50 * S
        self.stage = Stage(lambda: self.state, self.wait, lambda: self.now_ns, config)

    def wait(self, seconds: float) -> None:
        self.now_ns += max(round(seconds * 1e9), 1_000_000)
        if not self.silent:
            self.state = replace(self.state, stamp_ns=self.now_ns)

    def frames(self, count: int) -> list[int]:
        return [self.stage.read().stamp_ns for _ in range(count)]


def test_the_person_stands_ahead_of_the_nose_and_is_seen_there() -> None:
    carrier = Carrier()
    pose = carrier.stage(carrier.stage.read())
    assert pose is not None
    assert pose.hip_center == pytest.approx([0.0, 0.25, 4.5], abs=0.12)
    ahead = np.array([math.cos(math.radians(100)), math.sin(math.radians(100))])
    assert carrier.stage.place_m == pytest.approx(np.array([7.0, -3.0]) + 4.5 * ahead, abs=1e-6)
    carrier.state = replace(carrier.state, heading_rad=math.radians(90))
    pose = carrier.stage(carrier.stage.read())
    carrier.frames(3)
    pose = carrier.stage(carrier.stage.read())
    assert pose is not None and pose.hip_center[0] < -0.6, "turned to the right, they are to the left"


def test_pictures_come_late_and_as_often_as_asked() -> None:
    carrier = Carrier(delay_s=0.1)
    stamps = carrier.frames(10)
    assert np.diff(stamps) == pytest.approx(S / 30, rel=0.01)
    assert 0.1 * S <= carrier.now_ns - stamps[-1] < 0.14 * S


@pytest.mark.parametrize(
    ("turned_deg", "height_m", "seen"), [(0, 1.2, True), (60, 1.2, False), (0, 6.0, False)]
)
def test_nobody_is_found_outside_the_picture(turned_deg: float, height_m: float, seen: bool) -> None:
    carrier = Carrier()
    carrier.stage.read()
    heading = carrier.state.heading_rad + math.radians(turned_deg)
    carrier.state = replace(carrier.state, heading_rad=heading, position_m=np.array([7.0, -3.0, height_m]))
    carrier.frames(4)
    assert (carrier.stage(carrier.stage.read()) is not None) is seen


def test_a_walk_is_a_circle_at_an_even_speed() -> None:
    carrier = Carrier()
    carrier.stage.read()
    start = carrier.stage.place_m.copy()
    carrier.stage.walk(0.75, 3.0, 20.0)
    places = []
    for _ in range(19 * 30):
        carrier.stage.read()
        places.append(carrier.stage.place_m.copy())
    way = np.array(places)
    speed = np.linalg.norm(np.diff(way, axis=0), axis=1) * 30
    assert speed[30:] == pytest.approx(0.75, rel=0.01)
    away = (start - [7.0, -3.0]) / 4.5
    centre = start + 3.0 * np.array([-away[1], away[0]])
    assert np.linalg.norm(way - centre, axis=1) == pytest.approx(3.0, abs=0.3)
    arc = Arc(0.0, 4.0, 0.0, 1.0, bend_rad=math.pi)
    assert arc.velocity(2.0) == pytest.approx([0.0, 1.0], abs=1e-9)
    assert not arc.velocity(5.0).any()


def test_a_gesture_moves_the_arms_and_ends() -> None:
    carrier = Carrier()
    carrier.frames(5)
    lasts_s = carrier.stage.show("take_off", 1)
    heights = []
    for _ in range(round((lasts_s + 1.0) * 30)):
        pose = carrier.stage(carrier.stage.read())
        assert pose is not None
        heights.append(float(pose.joints[5:7, 1].min() - pose.joints[0, 1]))
    assert min(heights) < 0.0, "a wrist is above the head"
    assert heights[-1] > 0.3, "and down again"


def test_each_picture_has_noise_of_its_own() -> None:
    carrier = Carrier(sensor=SensorConfig())
    poses = [carrier.stage(carrier.stage.read()) for _ in range(3)]
    assert all(pose is not None for pose in poses)
    steps = [np.abs(a.joints - b.joints).max() for a, b in itertools.pairwise(poses)]  # type: ignore[union-attr]
    assert all(0.002 < step < 0.5 for step in steps)


def test_a_vehicle_that_falls_silent_is_an_error() -> None:
    carrier = Carrier()
    carrier.stage.read()
    carrier.silent = True
    with pytest.raises(CameraError, match="nothing new for two seconds"):
        carrier.frames(5)
