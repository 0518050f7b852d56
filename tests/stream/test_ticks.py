"""Poses become rows at a steady rate, and what is wrong with them is put right or left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.skeleton import MIRROR, Landmark, Pose
from wigwag.stream.ticks import RATE_HZ, TickConfig, Ticks

from .body import REST, Body

S = 10**9


def at(seconds: float, shift_m: float = 0.0) -> Pose:
    return Pose(REST + np.array([shift_m, 0, 0]), np.ones(13), round(seconds * S))


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 47.0, 60.0])
def test_a_second_has_thirty_rows_whatever_the_camera(rate_hz: float) -> None:
    ticks = Ticks()
    for i in range(round(3 * rate_hz) + 1):
        ticks.update(at(i / rate_hz, 0.1 * i / rate_hz))
    assert ticks.count == pytest.approx(3 * RATE_HZ + 1, abs=1)
    rows = ticks.window(0, ticks.count - 1)
    expected = 0.1 * np.arange(ticks.count) / RATE_HZ
    assert rows[:, 0, 0] - REST[0, 0] == pytest.approx(expected, abs=1e-6)


@given(st.lists(st.floats(0.001, 0.3), min_size=5, max_size=60))
def test_rows_lie_on_the_line_between_poses(steps: list[float]) -> None:
    ticks, now = Ticks(), 0.0
    ticks.update(at(0.0))
    for step in steps:
        now += step
        ticks.update(at(now, 0.2 * now))
    rows = ticks.window(0, ticks.count - 1)
    times = np.arange(ticks.count)[-len(rows) :] / RATE_HZ
    assert rows[:, 3, 0] - REST[3, 0] == pytest.approx(0.2 * times, abs=1e-6)


def test_memory_is_bounded_and_the_newest_is_kept() -> None:
    ticks = Ticks(TickConfig(memory_s=2.0))
    for i in range(5000):
        ticks.update(at(i / 30, 0.001 * i))
    assert len(ticks.window(0, ticks.count - 1)) <= 2 * 60
    newest = ticks.window(ticks.count - 60, ticks.count - 1)
    assert len(newest) == 60
    assert newest[-1, 0, 0] - newest[0, 0, 0] == pytest.approx(0.059, abs=1e-3)


def test_what_is_not_newer_is_ignored() -> None:
    ticks = Ticks()
    assert ticks.update(at(1.0)) == 1
    assert ticks.update(at(1.0)) == 0
    assert ticks.update(at(0.5)) == 0
    assert ticks.update(at(1.1)) == 3


def test_nan_is_ignored() -> None:
    ticks = Ticks()
    ticks.update(at(0.0))
    bad = at(0.1)
    bad.joints[4, 1] = np.nan
    assert ticks.update(bad) == 0
    assert ticks.update(at(0.2)) == 6
    assert np.isfinite(ticks.window(0, ticks.count - 1)).all()


def test_a_hole_begins_anew() -> None:
    ticks = Ticks()
    ticks.update(at(0.0))
    ticks.update(at(0.5))
    assert ticks.restarts == 0
    ticks.update(at(2.5))
    assert (ticks.restarts, ticks.count, ticks.began_ns) == (1, 1, round(2.5 * S))


def test_another_person_for_ten_frames_is_left_out_and_bridged() -> None:
    ticks = Ticks()
    for i in range(90):
        ticks.update(at(i / 30, 1.0 if 40 <= i < 50 else 0.0))
    assert ticks.restarts == 0
    assert ticks.count == 90
    assert np.abs(ticks.window(0, 89)[:, 0, 0]).max() < 0.01


def test_a_person_who_stays_elsewhere_is_believed() -> None:
    ticks = Ticks()
    for i in range(90):
        ticks.update(at(i / 30, 1.0 if i >= 40 else 0.0))
    assert ticks.restarts == 1
    assert ticks.window(0, ticks.count - 1)[:, 0, 0].min() == pytest.approx(1.0, abs=0.01)


def test_left_and_right_that_change_places_are_put_back() -> None:
    ticks, body = Ticks(), Body()
    poses = body.go(0, 1.0)
    poses[10:25] = [replace(p, joints=p.joints[list(MIRROR)]) for p in poses[10:25]]
    for pose in poses:
        ticks.update(pose)
    assert (ticks.window(0, ticks.count - 1)[:, Landmark.LEFT_SHOULDER, 0] > 0).all()


def test_sides_that_stay_changed_are_believed() -> None:
    ticks = Ticks()
    ticks.update(at(0.0))
    for i in range(1, 90):
        ticks.update(replace(at(i / 30), joints=REST[list(MIRROR)]))
    assert ticks.window(ticks.count - 1, ticks.count - 1)[0, Landmark.LEFT_SHOULDER, 0] < 0


def test_an_unseen_landmark_stays_with_the_hips_for_half_a_second() -> None:
    ticks = Ticks()
    ticks.update(at(0.0))
    hidden = np.ones(13)
    hidden[Landmark.LEFT_WRIST] = 0
    for i in range(1, 31):
        pose = replace(at(i / 30, 0.01 * i), visibility=hidden)
        pose.joints[Landmark.LEFT_WRIST] += 0.5
        ticks.update(pose)
    wrist = ticks.window(0, 30)[:, Landmark.LEFT_WRIST, 0] - ticks.window(0, 30)[:, Landmark.LEFT_HIP, 0]
    assert wrist[:14] == pytest.approx(np.full(14, wrist[0]), abs=1e-6)
    assert wrist[-1] == pytest.approx(wrist[0] + 0.5, abs=0.01)
