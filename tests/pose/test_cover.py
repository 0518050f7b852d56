"""By depth alone: is the place hidden, held or empty?"""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.pose.cover import cover_at

from .staged import Player, Stage, still

HIPS = np.array([0.0, 0.1, 4.0])


def frame_with(*places: tuple[float, float]) -> Frame:
    return Stage([Player(still(x, z)) for x, z in places]).frame()


def test_a_person_at_their_place() -> None:
    cover = cover_at(frame_with((0.0, 4.0)), HIPS)
    assert (cover.nearer, cover.own, cover.farther, cover.range_m) == (0.0, 1.0, 0.0, None)


def test_somebody_before_them() -> None:
    cover = cover_at(frame_with((0.0, 4.0), (0.0, 3.0)), HIPS)
    assert cover.nearer == 1.0
    assert cover.range_m == pytest.approx(3.0, abs=0.02)
    half = cover_at(frame_with((0.0, 4.0), (0.24, 3.0)), HIPS)
    assert 0.25 < half.nearer < 0.75
    assert half.nearer + half.own + half.farther == pytest.approx(1.0)


def test_who_leans_forward_is_not_before_themselves() -> None:
    frame = frame_with((0.0, 3.4))
    assert cover_at(frame, HIPS).nearer == 1.0
    leaning = cover_at(frame, HIPS, lean_m=0.4)
    assert (leaning.nearer, leaning.own) == (0.0, 1.0)
    assert leaning.lean_m == pytest.approx(0.6, abs=0.01)
    assert cover_at(frame_with((0.0, 2.9)), HIPS, lean_m=5.0).nearer == 1.0, "nobody leans that far"


def test_nobody_there_and_somebody_behind() -> None:
    for frame in (frame_with(), frame_with((0.0, 5.2))):
        assert cover_at(frame, HIPS).farther == 1.0


def test_an_arm_that_reaches_out_hides_little() -> None:
    frame = frame_with((0.0, 4.0))
    assert frame.depth_mm is not None
    frame.depth_mm[190:215, 310:335] = 3400
    assert 0.0 < cover_at(frame, HIPS).nearer < 0.3


def test_holes_and_no_depth_tell_nothing() -> None:
    frame = frame_with((0.0, 4.0))
    holes = Frame(frame.rgb, np.zeros_like(frame.depth_mm), frame.intrinsics, 0)
    blind = Frame(frame.rgb, None, frame.intrinsics, 0)
    for nothing in (cover_at(holes, HIPS), cover_at(blind, HIPS)):
        assert (nothing.nearer, nothing.own, nothing.farther, nothing.outside) == (0.0, 0.0, 0.0, False)


@pytest.mark.parametrize("x_m", [-3.0, 3.0])
def test_out_of_the_picture(x_m: float) -> None:
    assert cover_at(frame_with(), np.array([x_m, 0.1, 4.0])).outside


def test_at_the_edge_what_is_in_the_picture_counts() -> None:
    x_m = 1.95
    cover = cover_at(frame_with((x_m, 4.0), (x_m * 0.75, 3.0)), np.array([x_m, 0.1, 4.0]))
    assert not cover.outside and cover.nearer == 1.0
    assert cover.range_m == pytest.approx(3.0 * np.hypot(1.0, x_m / 4.0), abs=0.05)


def test_a_picture_of_another_size() -> None:
    small = Intrinsics(fx=150.0, fy=150.0, cx=80.0, cy=60.0, width=160, height=120)
    frame = Frame(np.zeros((120, 160, 3), np.uint8), np.full((120, 160), 2000, np.uint16), small, 0)
    assert cover_at(frame, HIPS).nearer == 1.0
