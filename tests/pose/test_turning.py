"""How the picture moves when the camera turns, whatever people do in it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from wigwag.camera.frame import Intrinsics
from wigwag.pose.turning import PictureShift, turned
from wigwag.sim.exposure import Exposure, ExposureConfig
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig

K = Intrinsics()


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer(scene=Scene(SceneConfig(near=6), seed=4, clear=np.array([[5.0, 0.0], [0.0, 0.0]])))


def seen(renderer: Renderer, heading_deg: float, down_deg: float) -> np.ndarray:
    camera = CameraPose.looking(np.array([0.0, 0.0, 1.3]), np.radians(heading_deg), np.radians(down_deg))
    return renderer.render(camera, [])[0]


@pytest.mark.parametrize(("heading_deg", "down_deg"), [(0.6, 0.0), (0.0, 0.7), (-1.0, -1.2), (1.5, 0.5)])
@pytest.mark.parametrize("light", [1.0, 0.005])
def test_a_turn_moves_the_picture(
    renderer: Renderer, heading_deg: float, down_deg: float, light: float
) -> None:
    shift = PictureShift()
    frames = [seen(renderer, 0.0, 0.0), seen(renderer, heading_deg, down_deg)]
    if light < 1:
        dark = Exposure(ExposureConfig(light=light))
        frames = [dark.apply(frame) for frame in frames]
    assert shift(frames[0]) == (0.0, 0.0)
    want = np.radians([heading_deg, -down_deg]) * (K.fx, K.fy)  # to the left turns the picture to the right
    assert np.abs(np.array(shift(frames[1])) - want).max() < 2.0


@pytest.mark.parametrize("down_deg", [-12.0, -9.0, 6.0, 9.0])
def test_a_jerk_moves_the_picture(renderer: Renderer, down_deg: float) -> None:
    """A drone that brakes pitches by up to 9 degrees a frame; corners are not always found again."""
    shift = PictureShift()
    shift(seen(renderer, 0.0, 0.0))
    _, down_px = shift(seen(renderer, 0.0, down_deg))
    assert down_px == pytest.approx(-np.tan(np.radians(down_deg)) * K.fy, abs=5.0)


def test_people_who_walk_through_do_not_turn_the_camera(renderer: Renderer) -> None:
    one, other = seen(renderer, 0.0, 0.0), seen(renderer, 0.0, 0.0)
    figure = cv2.GaussianBlur(
        np.random.default_rng(1).integers(0, 255, (300, 130, 3), dtype=np.uint8), (0, 0), 3
    )
    one[150:450, 200:330], other[150:450, 212:342] = figure, figure
    shift = PictureShift()
    shift(one)
    assert np.abs(shift(other)).max() < 1.0


def test_who_moves_before_a_blank_wall_does_not_turn_the_camera() -> None:
    figure = cv2.GaussianBlur(
        np.random.default_rng(1).integers(0, 255, (300, 130, 3), dtype=np.uint8), (0, 0), 3
    )
    shift, frames = PictureShift(), np.full((2, 480, 640, 3), 120, np.uint8)
    for frame, left in zip(frames, (200, 360), strict=True):
        frame[150:450, left : left + 130] = figure
    shift(frames[0])
    assert shift(frames[1]) == (0.0, 0.0)


def test_what_tells_nothing_moves_nothing() -> None:
    shift, random = PictureShift(), np.random.default_rng(0)
    black, grey = np.zeros((480, 640, 3), np.uint8), np.full((480, 640, 3), 128, np.uint8)
    for frame in (black, grey, black, np.zeros((240, 320, 3), np.uint8)):
        assert shift(frame) == (0.0, 0.0)
    shift(random.integers(0, 255, (480, 640, 3), dtype=np.uint8))
    assert shift(grey) == (0.0, 0.0), "a cut"
    first, second = (
        cv2.GaussianBlur(random.integers(0, 255, (480, 640, 3), dtype=np.uint8), (0, 0), 9.0)
        for _ in range(2)
    )
    shift(first)
    assert shift(second) == (0.0, 0.0), "a cut to something else"
    shift.reset()
    assert shift(grey) == (0.0, 0.0)


def test_turning_and_projecting_agree() -> None:
    points = np.array([[0.0, 0.0, 4.0], [0.8, -0.3, 6.0]])
    moved = turned(points, (40.0, -25.0), K)
    assert np.linalg.norm(moved, axis=1) == pytest.approx(np.linalg.norm(points, axis=1))
    assert K.project(moved) - K.project(points) == pytest.approx(np.tile((40.0, -25.0), (2, 1)), abs=4.0)
    assert turned(points, (0.0, 0.0), K) == pytest.approx(points)
