import numpy as np
import pytest

from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig
from wigwag.sim.shapes import linear_rgb

OPERATOR, DRONE = np.array([4.0, 0.0]), np.array([0.0, 0.0])
CLEAR = np.stack([OPERATOR, DRONE])
LEVEL = CameraPose.looking(np.array([0.0, 0.0, 1.3]), 0.0)


def test_what_stands_near_leaves_the_ways_of_passers_by_free():
    for seed in range(12):
        near = Scene(SceneConfig(clutter=0, near=10), seed, clear=CLEAR).shapes
        assert len(near) > 8
        off = np.concatenate([near.a, near.b])[:, :2] - OPERATOR
        assert np.abs(off).max() < 3.2
        behind, beside = off[:, 0], np.abs(off[:, 1])
        on_a_way = (np.abs(behind) > 0.75) & (np.abs(behind) < 1.55)
        assert not on_a_way.any()
        assert (np.hypot(behind, beside) > 0.5).all(), "and the operator has room"


def test_near_things_turn_with_the_line_of_sight():
    one = Scene(SceneConfig(clutter=0, near=6), 3, clear=CLEAR).shapes.a[:, :2] - OPERATOR
    turned = Scene(SceneConfig(clutter=0, near=6), 3, clear=CLEAR[:, ::-1]).shapes.a[:, :2] - OPERATOR[::-1]
    c, s = np.cos(np.pi / 2), np.sin(np.pi / 2)
    centres = one @ np.array([[c, s], [-s, c]])
    assert np.abs(centres - turned).max() < 0.5, "but for parts that chance turns in the world's frame"


def test_a_wall_fills_the_picture_behind_the_operator_in_its_colour():
    paint = "#1d7f86"
    scene = Scene(SceneConfig(clutter=0, wall=paint, sun_azimuth_deg=180.0), 1, clear=CLEAR)
    rgb, depth = Renderer(scene=scene).render(LEVEL, [])
    middle = depth[200:260]
    assert (middle > 6000).all() and (middle < 7500).all()
    assert np.median(middle[:, 320]) == pytest.approx(1000 * (4.0 + 2.6 - 0.1), abs=30)
    seen = rgb[200:260].reshape(-1, 3).mean(axis=0)
    want = np.array(linear_rgb(paint))
    assert np.argsort(seen).tolist() == np.argsort(want).tolist()


def test_what_is_added_leaves_the_rest_of_the_scene_as_it_was():
    plain, more = (Scene(SceneConfig(near=n), 5, clear=CLEAR) for n in (0, 5))
    assert np.array_equal(plain.shapes.a, more.shapes.a[: len(plain.shapes)])
    assert np.array_equal(plain.sun, more.sun)
