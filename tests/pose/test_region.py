"""The way from a crop to the picture and back."""

from __future__ import annotations

import math

import cv2
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from wigwag.pose.region import Region

regions = st.builds(
    Region,
    st.floats(-500, 1500),
    st.floats(-500, 1500),
    st.floats(5, 3000),
    st.floats(-math.pi, math.pi),
)
points = st.lists(st.tuples(st.floats(-2, 3), st.floats(-2, 3)), min_size=1, max_size=9).map(np.array)


@given(regions, points)
def test_to_the_picture_and_back(region: Region, crop: np.ndarray) -> None:
    np.testing.assert_allclose(region.to_crop(region.to_picture(crop)), crop, atol=1e-9)


@given(regions, points)
def test_the_warp_goes_where_the_points_go(region: Region, crop: np.ndarray) -> None:
    indices = crop * 256 - 0.5  # a pixel's middle lies half a pixel beyond its index
    by_matrix = np.column_stack([indices, np.ones(len(indices))]) @ region.matrix(256).T
    np.testing.assert_allclose(by_matrix, region.to_picture(crop), atol=1e-6)


def test_around_holds_hips_in_the_middle_and_turns_the_head_up() -> None:
    hips = np.array([100.0, 200.0])
    for degrees in (-170, -90, -20, 0, 35, 90):
        angle = math.radians(degrees)
        above = hips + 80 * np.array([math.sin(angle), -math.cos(angle)])
        region = Region.around(hips, above)
        assert math.isclose(region.side, 2 * 1.25 * 80)
        assert math.isclose(region.angle_rad, angle, abs_tol=1e-12)
        np.testing.assert_allclose(region.to_crop(hips), [0.5, 0.5])
        np.testing.assert_allclose(region.to_crop(above), [0.5, 0.5 - 0.4], atol=1e-12)


def test_whole_picture_fits() -> None:
    region = Region.whole(640, 480)
    corners = region.to_crop(np.array([[0.0, 0.0], [640.0, 480.0]]))
    assert (corners >= 0).all()
    assert (corners <= 1).all()


def test_a_crop_shows_what_stands_there() -> None:
    picture = np.zeros((300, 400), np.uint8)
    spot = (260, 90)
    cv2.circle(picture, spot, 4, 255, -1)
    region = Region(220.0, 120.0, 200.0, 0.5)
    crop = cv2.warpAffine(picture, region.matrix(256), (256, 256), flags=cv2.WARP_INVERSE_MAP)
    v, u = (crop.astype(float) * (np.indices(crop.shape) + 0.5)).sum(axis=(1, 2)) / crop.sum()
    # Half a pixel of the crop is 0.39 of the picture's: this tells the two apart.
    np.testing.assert_allclose(region.to_picture(np.array([u, v]), 256), spot, atol=0.15)


def test_unusable_regions() -> None:
    limit = math.radians(60)
    assert Region(0, 0, 100.0, 0.9).usable(limit)
    assert not Region(0, 0, 100.0, 1.1).usable(limit)
    assert not Region(0, 0, math.nan).usable(limit)
    assert not Region(0, 0, math.inf).usable(limit)
    assert not Region(0, 0, 1.0).usable(limit)


def test_the_same_place_seen_in_two_crops() -> None:
    region = Region(100.0, 100.0, 50.0)
    assert region.resembles(Region(104.0, 95.0, 55.0))
    assert not region.resembles(Region(115.0, 100.0, 50.0))
    assert not region.resembles(Region(100.0, 100.0, 80.0))
