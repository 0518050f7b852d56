"""Colours of clothes: the same in any light, another's differ, and nobody else's pixels count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wigwag.pose.appearance import Appearance, appearance_of
from wigwag.sim.exposure import Exposure, ExposureConfig

from .staged import BLUE, CAMERA, GREEN, RED, Player, Stage, body_of, standing, still


def picture(shirt: tuple[int, int, int], z_m: float = 4.0, trousers: tuple[int, int, int] = (40, 45, 70)):
    frame = Stage([Player(still(0.2, z_m), shirt=shirt, trousers=trousers)]).frame()
    return frame.rgb, frame.depth_mm, body_of(standing(0.2, z_m))


def looks(shirt: tuple[int, int, int], z_m: float = 4.0, light: float = 1.0, seed: int = 0) -> Appearance:
    rgb, depth, body = picture(shirt, z_m)
    if light < 1:
        rgb = Exposure(ExposureConfig(light=light), seed).apply(rgb)
    found = appearance_of(rgb, depth, body, z_m)
    assert found is not None
    return found


def test_the_same_clothes_look_alike_near_and_far_and_in_any_light() -> None:
    known = looks(RED)
    for z_m, light in ((3.0, 1.0), (8.0, 1.0), (4.0, 0.02), (8.0, 0.02), (5.0, 0.005)):
        assert known.difference(looks(RED, z_m, light)) < 1.5, (z_m, light)


@pytest.mark.parametrize("light", [1.0, 0.02, 0.005])
def test_other_clothes_do_not(light: float) -> None:
    for shirt in (BLUE, GREEN, (225, 225, 220), (25, 25, 28)):
        assert looks(RED, 5.0, light).difference(looks(shirt, 5.0, light)) > 2.5, shirt


def test_a_shirt_and_trousers_that_change_places_look_different() -> None:
    one = appearance_of(*picture(RED, trousers=BLUE), 4.0)
    other = appearance_of(*picture(BLUE, trousers=RED), 4.0)
    assert one is not None and other is not None
    assert one.difference(other) > 4.0


def test_shade_and_exposure_do_not_matter() -> None:
    rgb, depth, body = picture(GREEN)
    dim = np.round(255 * ((rgb / 255) ** 2.2 * 0.4) ** (1 / 2.2)).astype(np.uint8)
    bright, dark = appearance_of(rgb, depth, body, 4.0), appearance_of(dim, depth, body, 4.0)
    assert bright is not None and dark is not None
    assert bright.difference(dark) < 0.15, "but for the rounding of dark values"


def test_whoever_stands_before_does_not_lend_their_colours() -> None:
    rgb, depth, body = picture(RED)
    known = appearance_of(rgb, depth, body, 4.0)
    u = round(float(CAMERA.project(np.array([0.2, 0.0, 4.0]))[0]))
    rgb[:, u:], depth[:, u:] = (0, 0, 255), 3000
    half_hidden = appearance_of(rgb, depth, body, 4.0)
    assert known is not None and half_hidden is not None
    assert known.difference(half_hidden) < 0.1
    depth[:] = 3000
    assert appearance_of(rgb, depth, body, 4.0) is None, "wholly hidden"


def test_bare_arms_before_the_trunk_are_left_out() -> None:
    rgb, depth, body = picture(BLUE)
    points = body.points_px.copy()
    belly = (points[11] + points[24]) / 2
    for first, sign in ((0, 1), (1, -1)):
        points[13 + first], points[15 + first] = belly + np.array([[40 * sign, 20], [5 * sign, 8]])
        points[19 + first] = belly - np.array([20 * sign, -6])
    for k in np.linspace(0, 1, 60):
        for first in (0, 1):
            u, v = np.round(points[13 + first] + k * (points[19 + first] - points[13 + first])).astype(int)
            rgb[v - 5 : v + 5, u - 5 : u + 5] = (225, 180, 150)
    folded = appearance_of(rgb, depth, replace(body, points_px=points), 4.0)
    assert folded is not None
    assert looks(BLUE).difference(folded) < 1.0


def test_without_depth_all_pixels_count() -> None:
    rgb, _, body = picture(RED)
    found = appearance_of(rgb, None, body, 4.0)
    assert found is not None and found.difference(looks(RED)) < 0.2


def test_too_small_or_outside_is_not_known() -> None:
    rgb, depth, body = picture(RED)
    assert appearance_of(rgb, depth, replace(body, points_px=body.points_px + 5000.0), 4.0) is None
    tiny = body.points_px.mean(axis=0) + 0.01 * (body.points_px - body.points_px.mean(axis=0))
    assert appearance_of(rgb, depth, replace(body, points_px=tiny), 4.0) is None


def test_legs_below_the_picture_are_not_asked_about() -> None:
    rgb, depth, body = picture(RED)
    low = replace(body, points_px=body.points_px + np.array([0.0, 215.0]))
    shifted_rgb, shifted_depth = np.roll(rgb, 215, axis=0), np.roll(depth, 215, axis=0)
    found = appearance_of(shifted_rgb, shifted_depth, low, 4.0)
    assert found is not None and np.isnan(found.values[2]).all()
    assert found.difference(looks(RED)) < 0.5
    both = found.towards(looks(RED), 0.1)
    assert np.isfinite(both.values).all(), "what was not known is taken over"


def test_moving_towards_another_learns_slowly() -> None:
    red, blue = looks(RED), looks(BLUE)
    away = [red.difference(red.towards(blue, share)) for share in (0.0, 0.1, 0.5, 1.0)]
    assert away[0] == 0.0 and away == sorted(away)
    assert red.towards(blue, 1.0).difference(blue) == pytest.approx(0.0, abs=1e-9)


def test_people_of_whom_nothing_common_was_seen_may_be_the_same() -> None:
    nothing = Appearance(np.full((3, 4), np.nan))
    assert not nothing.known
    assert nothing.difference(looks(RED)) == 0.0
