import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from wigwag.camera.frame import Intrinsics
from wigwag.fly.operator import Mount
from wigwag.sim.paint import HAIR, SKIN, Look
from wigwag.sim.raycast import FAR, hit_box, hit_capsule
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig
from wigwag.sim.shapes import Shapes, linear_rgb

from .people import AT, standing

SMALL = Intrinsics(fx=150.0, fy=150.0, cx=80.0, cy=60.0, width=160, height=120)
BARE = SceneConfig(clutter=0)
LEVEL = CameraPose.looking(np.array([0.0, 0.0, 1.5]), 0.0)
RED = np.array([[linear_rgb("#ff0000")] * 2])


@pytest.fixture(scope="module")
def small():
    return Renderer(SMALL, Scene(BARE, seed=0))


@pytest.fixture(scope="module")
def full():
    return Renderer(scene=Scene(BARE, seed=0))


def capsule(a, b, ra, rb):
    return Shapes.capsules(np.array([a]), np.array([b]), np.array([[ra, rb]]), RED)


def sphere_depth(k, centre, radius):
    """Depth in metres of a sphere (camera optical frame) at every pixel, infinite beside it."""
    v, u = np.mgrid[: k.height, : k.width]
    d = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)
    a, b = (d * d).sum(-1), d @ centre
    disc = b * b - a * (centre @ centre - radius**2)
    return np.where(disc > 0, (b - np.sqrt(np.maximum(disc, 0))) / a, np.inf)


def test_depth_of_a_sphere_is_the_analytic_one(full):
    centre = np.array([4.0, 0.3, 1.8])
    rgb, depth = full.render_shapes(LEVEL, [capsule(centre, centre, 0.4, 0.4)])
    want = sphere_depth(full.intrinsics, LEVEL.to_camera(centre), 0.4)
    on = np.isfinite(want)
    assert on.sum() > 8000
    assert np.abs(depth[on] - 1000 * want[on]).max() <= 1.0
    # Colour covers the same pixels as depth: red inside, none of it outside, but for one pixel of edge.
    red = (rgb[..., 0] > 60) & (rgb[..., 1] < 40)
    assert red[on].mean() > 0.97
    assert (red & ~on).sum() < 0.02 * on.sum()


def test_depth_of_a_capsule_across_the_view_is_the_analytic_one(full):
    shape = capsule((5.0, 1.0, 1.5), (5.0, -1.0, 1.5), 0.3, 0.3)
    _, depth = full.render_shapes(LEVEL, [shape])
    k = full.intrinsics
    rows = np.arange(k.height)
    y = (rows - k.cy) / k.fy
    # In the plane across the axis the capsule is a circle of 0.3 m at depth 5.
    disc = 25.0 - (1 + y * y) * (25.0 - 0.09)
    want = np.where(disc > 0, (5.0 - np.sqrt(np.maximum(disc, 0))) / (1 + y * y), np.nan)
    seen = depth[:, 320] / 1000.0
    on = np.isfinite(want)
    assert on.sum() > 70
    assert np.abs(seen[on] - want[on]).max() <= 0.0011


def test_a_tapered_capsule_touches_both_its_spheres():
    # Seen along the middle of its side, the surface is the line that touches both circles.
    a, b, ra, rb = np.array([0.0, -1.0, 5.0]), np.array([0.0, 1.0, 5.0]), 0.5, 0.2
    sine = (ra - rb) / 2.0
    t = hit_capsule.py_func(0.0, 0.0, 1.0, *a, 0.0, 1.0, 0.0, 2.0, ra, rb, sine, 1 - sine**2)
    assert t == pytest.approx(5.0 - (ra - sine * 1.0) / np.sqrt(1 - sine**2), abs=1e-9)
    # Beyond the ends it is the spheres themselves.
    y = 1.15 / 5.0
    t = hit_capsule.py_func(0.0, y, 1.0, *a, 0.0, 1.0, 0.0, 2.0, ra, rb, sine, 1 - sine**2)
    point = t * np.array([0.0, y, 1.0])
    assert np.linalg.norm(point - b) == pytest.approx(rb, abs=1e-9)


unit = st.floats(-1, 1, allow_nan=False)


@settings(max_examples=60, deadline=None)
@example((0.0, 0.375, 0.25), 0.125, 0.5, 0.0, 0.0)  # a ray along the cone: its quadratic is linear
@given(st.tuples(unit, unit, unit), st.floats(0.05, 0.5), st.floats(0.05, 0.5), unit, unit)
def test_hits_lie_on_the_hull_of_the_two_spheres(along, ra, rb, x, y):
    a, b = np.array([0.0, 0.0, 4.0]), np.array([0.0, 0.0, 4.0]) + along
    length = np.linalg.norm(b - a)
    if length < abs(ra - rb) + 1e-3:
        return
    n, sine = (b - a) / length, (ra - rb) / length
    d = np.array([0.3 * x, 0.3 * y, 1.0])
    t = hit_capsule(*d, *a, *n, length, ra, rb, sine, 1 - sine**2)
    # The distance from the hull of two spheres: the least over all spheres between them.
    s = np.linspace(0, 1, 4001)[:, None]
    centres, radii = a + s * (b - a), ra + s[:, 0] * (rb - ra)
    if t < FAR:
        assert np.min(np.linalg.norm(t * d - centres, axis=1) - radii) == pytest.approx(0, abs=2e-3)
    else:
        foot = np.clip(centres @ d / (d @ d), 0, None)[:, None] * d
        assert np.min(np.linalg.norm(foot - centres, axis=1) - radii) > -2e-3


def test_a_box_is_met_on_its_near_side():
    assert hit_box.py_func(0.0, 0.0, 1.0, 0.0, 0.0, 3.0) == pytest.approx(2.0)
    assert hit_box.py_func(0.5, 0.0, 1.0, 0.0, 0.0, 3.0) == pytest.approx(1e9)


def test_the_ground_lies_where_the_plane_is(full):
    pose = CameraPose.looking(np.array([2.0, -1.0, 1.2]), 0.4, tilt_down_rad=0.3)
    _, depth = full.render(pose, [])
    v, u = np.mgrid[:480, :640]
    points = pose.to_world(full.intrinsics.deproject(np.stack([u, v], -1).astype(float), depth / 1000.0))
    near = (depth > 0) & (depth < 10000)
    assert near.sum() > 100_000
    assert np.abs(points[near, 2]).max() < 0.01


@pytest.mark.parametrize("heading, tilt", [(0.0, 0.0), (0.5, 0.2), (-0.3, -0.1)])
def test_shapes_appear_where_the_intrinsics_project_them(full, heading, tilt):
    pose = CameraPose.looking(np.array([-0.5, 0.2, 1.4]), heading, tilt)
    for offset in ([0.0, 0.0, 5.0], [1.0, -0.6, 4.0], [-1.5, 0.2, 5.0]):
        world = pose.to_world(np.array(offset))
        _, with_ball = full.render_shapes(pose, [capsule(world, world, 0.05, 0.05)])
        _, without = full.render(pose, [])
        v, u = np.nonzero(with_ball != without)
        wanted = full.intrinsics.project(np.array(offset))
        assert np.abs(np.array([u.mean(), v.mean()]) - wanted).max() < 0.6


def test_joints_of_a_person_have_the_depth_of_their_surface(full):
    joints = standing("tee")
    _, depth = full.render(LEVEL, [(joints, Look())])
    camera = LEVEL.to_camera(joints)
    for name in ("left_elbow", "right_wrist", "left_knee", "right_hip", "spine", "head"):
        u, v = np.round(full.intrinsics.project(camera[AT[name]])).astype(int)
        behind = camera[AT[name], 2] - depth[v, u] / 1000
        assert 0.015 < behind < 0.16, name


def test_left_is_left(full):
    look = Look(shirt="#ffffff", skin="#d29b73")
    joints = standing("left side")
    _, depth = full.render(LEVEL, [(joints, look)])
    _, empty = full.render(LEVEL, [])
    u = np.nonzero(depth != empty)[1]
    # Facing the camera, the person's left arm reaches to the right of the picture.
    assert u.max() - 320 > 1.5 * (320 - u.min())


def test_a_body_does_not_depend_on_where_it_stands(small):
    # The same person, met from the same side elsewhere, gives the same depth up to the sub-millimetre.
    one = small.render(LEVEL, [(standing("vee"), Look())])[1].astype(int)
    turn = CameraPose.looking(np.array([7.0, -3.0, 1.5]), 1.1)
    c, s = np.cos(1.1), np.sin(1.1)
    moved = standing("vee") @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (7.0, -3.0, 0.0)
    two = small.render(turn, [(moved, Look())])[1].astype(int)
    ground_far = (one > 20000) | (two > 20000)
    assert (np.abs(one - two)[~ground_far] > 2).mean() < 0.001


def test_the_nearer_of_two_people_hides_the_other(small):
    near, far = standing("down", at=(3.0, 0.0)), standing("down", at=(5.0, 0.0))
    alone = small.render(LEVEL, [(near, Look())])[1]
    both = small.render(LEVEL, [(far, Look()), (near, Look())])[1]
    on = (alone > 0) & (alone < 3300)
    assert on.sum() > 300
    assert np.array_equal(both[on], alone[on])


def test_a_picture_is_the_same_for_the_same_seed_and_differs_for_another():
    pictures = [Renderer(SMALL, Scene(seed=s)).render(LEVEL, [(standing(), Look())])[0] for s in (4, 4, 5)]
    assert np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[0], pictures[2])


def test_nothing_breaks_when_a_shape_surrounds_the_camera_or_stands_behind_it(small):
    behind = standing(at=(-3.0, 0.0))
    rgb, depth = small.render(LEVEL, [(behind, Look())])
    empty = small.render(LEVEL, [])
    assert np.array_equal(depth, empty[1])
    around = capsule((0.0, 0.0, 1.5), (0.0, 0.0, 1.5), 0.5, 0.5)
    small.render_shapes(LEVEL, [around])
    close = standing("ahead", at=(0.5, 0.0))
    rgb, depth = small.render(LEVEL, [(close, Look())])
    assert depth.min() >= 0
    assert rgb.std() > 5


def test_camera_rides_on_the_body_as_the_mount_says():
    mount = Mount(pitch_down_rad=0.3, offset_m=(0.1, 0.02, -0.05))
    pose = CameraPose.on_body(np.zeros(3), np.eye(3), mount.offset_m, mount.pitch_down_rad)
    for point in np.random.default_rng(0).normal(size=(20, 3)):
        assert pose.to_camera(mount.to_body(point)) == pytest.approx(point, abs=1e-12)
        assert pose.to_world(pose.to_camera(point)) == pytest.approx(point, abs=1e-12)


@given(st.integers(0, 10_000))
@settings(max_examples=50, deadline=None)
def test_every_look_has_a_face_and_bare_forearms(seed):
    look = Look.from_seed(seed)
    assert look.skin in SKIN
    assert look.hair in HAIR
    assert look.sleeve < 0.9
    assert look == Look.from_seed(seed)
    assert max(abs(a - b) for a, b in zip(linear_rgb(look.skin), linear_rgb(look.hair), strict=True)) > 0.09


def test_the_clear_ground_stays_clear():
    for seed in range(4):
        clear = np.array([[0.0, 0.0], [4.0, 1.0]])
        shapes = Scene(SceneConfig(clutter=12), seed, clear=clear).shapes
        ends = np.concatenate([shapes.a, shapes.b])
        reach = np.linalg.norm(ends[:, None, :2] - clear, axis=2).min()
        assert reach > 4.5
