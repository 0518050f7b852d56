"""Fences: what lies in which direction, and how far."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.fly.fence import Cylinder, Fence, Polygon

L_SHAPE = Polygon(((0, 0), (10, 0), (10, 4), (4, 4), (4, 10), (0, 10)))
near = st.floats(-15, 15)


def inside(fence: Fence, x: float, y: float) -> bool:
    return min(wall.distance_m for wall in fence.walls(x, y)) >= 0


@pytest.mark.parametrize(
    ("x", "y", "distance"),
    [(2, 2, 2), (9, 2, 1), (2, 9, 1), (3.5, 5, 0.5), (5, 5, -1), (-2, 5, -2), (12, 5, -math.hypot(2, 1))],
)
def test_distances_to_a_polygon(x: float, y: float, distance: float) -> None:
    assert min(wall.distance_m for wall in L_SHAPE.walls(x, y)) == pytest.approx(distance)


@pytest.mark.parametrize("fence", [L_SHAPE, Polygon(L_SHAPE.corners_m[::-1]), Cylinder(6.0, (1.0, -2.0))])
@given(x=near, y=near)
def test_walls_are_unit_vectors_that_lead_to_the_wall(fence: Fence, x: float, y: float) -> None:
    for wall in fence.walls(x, y):
        assert math.hypot(wall.east, wall.north) == pytest.approx(1.0)
        at = x + wall.east * wall.distance_m, y + wall.north * wall.distance_m
        assert min(abs(w.distance_m) for w in fence.walls(*at)) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("corners", [L_SHAPE.corners_m, L_SHAPE.corners_m[::-1]])
def test_on_the_wall_it_is_known_which_way_leads_out(corners: tuple[tuple[float, float], ...]) -> None:
    (wall,) = [w for w in Polygon(corners).walls(10.0, 2.0) if w.distance_m < 1e-9]
    assert (wall.east, wall.north) == pytest.approx((1.0, 0.0))


def test_in_the_middle_of_a_cylinder_any_way_leads_out() -> None:
    assert Cylinder(3.0).walls(0.0, 0.0)[0].distance_m == 3.0


@given(x=near, y=near)
def test_inside_is_inside(x: float, y: float) -> None:
    truly = 0 < x < 10 and 0 < y < 10 and not (x > 4 and y > 4)
    edge = min(abs(wall.distance_m) for wall in L_SHAPE.walls(x, y)) < 1e-6
    assert edge or inside(L_SHAPE, x, y) == truly


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Cylinder(0.0), "radius_m must be above 0"),
        (lambda: Cylinder(float("nan")), "radius_m must be above 0"),
        (lambda: Polygon(((0, 0), (1, 1))), "at least 3 finite corners"),
        (lambda: Polygon(((0, 0), (1, 1), (float("inf"), 0))), "at least 3 finite corners"),
        (lambda: Polygon(((0, 0), (4, 4), (4, 0), (0, 4))), "cross. Put them in order"),
    ],
)
def test_what_is_no_fence_is_an_error(make: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make()  # type: ignore[operator]
