"""Drawings: in place, in the right colours, and never with an error."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.pose.body import Body
from wigwag.skeleton import Landmark
from wigwag.view.draw import LEFT, MIDDLE, RIGHT, draw_banner, draw_body, draw_skeleton


def blank(height: int = 480, width: int = 640) -> np.ndarray:
    return np.zeros((height, width, 3), np.uint8)


def person() -> np.ndarray:
    """Thirteen landmarks of a person who faces the camera: their left is the picture's right."""
    points = np.zeros((13, 2))
    points[Landmark.NOSE] = (320, 100)
    for left, u, v in (
        (1, 360, 150),
        (3, 380, 210),
        (5, 390, 270),
        (7, 345, 280),
        (9, 345, 350),
        (11, 345, 420),
    ):
        points[left], points[left + 1] = (u, v), (640 - u, v)
    return points


def test_left_and_right_have_their_colours() -> None:
    picture = blank()
    draw_skeleton(picture, person())
    assert tuple(picture[315, 345]) == LEFT
    assert tuple(picture[315, 295]) == RIGHT
    assert tuple(picture[280, 320]) == MIDDLE


def test_what_is_hardly_visible_is_faint() -> None:
    clear, faint = blank(), blank()
    draw_skeleton(clear, person(), np.ones(13))
    draw_skeleton(faint, person(), np.zeros(13))
    assert 0 < faint[315, 345].sum() < 0.5 * clear[315, 345].sum()


def test_a_landmark_that_is_no_number_is_left_out() -> None:
    points = person()
    points[Landmark.LEFT_HIP] = np.nan
    points[Landmark.LEFT_WRIST] = (1e12, -np.inf)
    picture = blank()
    draw_skeleton(picture, points)
    assert not picture[315, 345].any(), "no bone ends there"
    assert tuple(picture[315, 295]) == RIGHT


def test_large_pictures_get_thick_lines() -> None:
    small, large = blank(), blank(1920, 2560)
    draw_skeleton(small, person())
    draw_skeleton(large, person() * 4)
    ratio = large.any(axis=2).mean() / small.any(axis=2).mean()
    assert 0.6 < ratio < 1.6, "a line covers about the same share of the picture"


@settings(max_examples=25, deadline=None)
@given(
    st.lists(
        st.sampled_from([-1e300, -1e6, -3.0, 0.0, 7.5, 30.0, 1e6, np.nan, np.inf, -np.inf]),
        min_size=66,
        max_size=66,
    ),
    st.integers(1, 60),
    st.integers(1, 60),
)
def test_no_body_breaks_the_drawing(values: list[float], height: int, width: int) -> None:
    body = Body(np.reshape(values, (33, 2)), np.linspace(0, 1, 33), np.zeros((33, 3)), 1.0, 1.0)
    picture = blank(height, width)
    draw_body(picture, body, names=True)
    draw_banner(picture, "take off", "4.0 m")
    assert picture.shape == (height, width, 3)


def test_a_banner_covers_the_upper_edge_only() -> None:
    picture = np.full((480, 640, 3), 200, np.uint8)
    draw_banner(picture, "stop", "4.2 m")
    assert (picture[2, :100] < 120).all()
    assert (picture[40:] == 200).all()
    assert (picture[:30] == MIDDLE).all(axis=2).any(), "the text stands in its colour"
