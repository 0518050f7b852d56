import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.camera.align import DepthAligner, Extrinsic
from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError, MissingExtraError
from wigwag.extras import load_realsense

from .software import COLOR, DEPTH, SIDEWAYS, SoftwareRealSense


def turned(axis, degrees):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k


TURNED = Extrinsic(turned((0.3, 1.0, 0.2), 2.0), np.array([0.05, -0.01, 0.02]))


def rays(i):
    v, u = np.mgrid[: i.height, : i.width]
    return np.stack([(u - i.cx) / i.fx, (v - i.cy) / i.fy, np.ones_like(u, float)], axis=-1)


def scene(i, to_world, box=True):
    """Depth in metres along the axis, of a slanted wall with a box before it; frames of the depth camera."""
    directions, origin = rays(i) @ to_world.rotation.T, to_world.translation_m
    normal, far = np.array([0.1, 0.15, 1.0]), 3.2
    z = (far - origin @ normal) / (directions @ normal)
    if box:
        t = (2.0 - origin[2]) / directions[..., 2]
        at = origin + directions * t[..., None]
        z = np.where((abs(at[..., 0]) < 0.25) & (abs(at[..., 1] - 0.1) < 0.5), t, z)
    return z


def millimetres(z):
    return np.rint(z * 1e3).astype(np.uint16)


@pytest.mark.parametrize(
    "extrinsic", [Extrinsic.identity(), SIDEWAYS, TURNED], ids=["same", "beside", "turned"]
)
@pytest.mark.parametrize("fine", [False, True], ids=["coarser", "finer"])
def test_what_both_cameras_see_is_where_it_is(extrinsic, fine):
    scale = 3 if fine else 0.6
    w, h = int(scale * 128), int(scale * 96)
    color = Intrinsics(scale * 120, scale * 119, w / 2 - 0.8, h / 2 + 0.3, w, h)
    aligned = DepthAligner(DEPTH, color, extrinsic)(millimetres(scene(DEPTH, Extrinsic.identity())))
    truth = scene(color, extrinsic.inverse()) * 1e3
    found = aligned > 0
    error = np.abs(aligned.astype(float) - truth)[found]
    edge = np.mean(error > 100)
    assert np.median(error) < 3.0
    assert np.percentile(error[error < 100], 99) < 16.0  # half a depth pixel of the slanted wall
    assert edge < 0.02  # the outline of the box, up to half a depth pixel
    assert np.mean(found) > (0.97 if extrinsic is not TURNED else 0.90)  # but for what is behind the box


def test_a_camera_aligned_to_itself_changes_nothing():
    depth = np.random.default_rng(1).integers(0, 6000, (96, 128)).astype(np.uint16)
    depth[depth < 800] = 0
    assert np.array_equal(DepthAligner(DEPTH, DEPTH, Extrinsic.identity())(depth), depth)


def test_a_hole_of_one_pixel_stays_a_hole_and_noise_makes_none():
    rng = np.random.default_rng(2)
    fine = Intrinsics(3 * DEPTH.fx, 3 * DEPTH.fy, 3 * DEPTH.cx + 1, 3 * DEPTH.cy + 1, 384, 288)
    depth = rng.normal(2000, 25, (96, 128)).astype(np.uint16)
    holes = rng.random(depth.shape) < 0.01
    aligned = DepthAligner(DEPTH, fine, Extrinsic(np.eye(3), np.array([0.05, 0.0, 0.0])))(
        np.where(holes, 0, depth).astype(np.uint16)
    )
    inside = aligned[:, 40:]  # to the left the depth camera does not see
    assert np.mean(inside == 0) == pytest.approx(holes.mean(), rel=0.25)
    whole = DepthAligner(DEPTH, fine, Extrinsic(np.eye(3), np.array([0.05, 0.0, 0.0])))(depth)
    assert np.mean(whole[:, 40:] == 0) < 1e-4


def test_the_nearest_surface_wins_in_any_order():
    wide = Extrinsic(np.eye(3), np.array([0.4, 0.0, 0.0]))
    depth = np.full((96, 128), 4000, np.uint16)
    depth[:, 60:70] = 1000  # a pole; from 0.4 m to the side, it hides another part of the wall
    for extrinsic in (wide, wide.inverse()):
        aligned = DepthAligner(DEPTH, DEPTH, extrinsic)(depth)
        shift = round(np.sign(extrinsic.translation_m[0]) * 0.4 * DEPTH.fx / 1.0)
        pole = np.unique(np.nonzero(aligned == 1000)[1])
        assert pole.tolist() == pytest.approx(list(range(60 + shift, 70 + shift)), abs=1)
        assert (aligned[:, pole] == 1000).all()


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.2, 0.2), st.floats(-10, 10))
def test_there_and_back_no_depth_is_invented(x, y, z, degrees):
    extrinsic = Extrinsic(turned((1, 2, 0.1), degrees), np.array([x, y, z]))
    depth = millimetres(scene(DEPTH, Extrinsic.identity()))
    aligned = DepthAligner(DEPTH, COLOR, extrinsic)(depth)
    points = (
        rays(DEPTH) * depth[..., None].astype(float) @ extrinsic.rotation.T + 1e3 * extrinsic.translation_m
    )
    if (aligned > 0).any():
        assert aligned[aligned > 0].min() >= points[..., 2].min() - 1
        assert aligned.max() <= points[..., 2].max() + 1
    back = extrinsic.then(extrinsic.inverse())
    assert np.allclose(back.rotation, np.eye(3))
    assert np.allclose(back.translation_m, 0)


def test_a_camera_upside_down():
    upside = Extrinsic(np.diag([-1.0, -1.0, 1.0]), np.zeros(3))
    i = Intrinsics(96.0, 96.0, 63.5, 47.5, 128, 96)
    depth = np.random.default_rng(3).integers(500, 6000, (96, 128)).astype(np.uint16)
    aligned = DepthAligner(i, i, upside)(depth)
    assert np.mean(aligned == depth[::-1, ::-1]) > 0.95  # up to pixels whose edges round the other way


def test_without_any_depth_there_is_none_and_what_is_behind_the_camera_is_gone():
    assert not DepthAligner(DEPTH, COLOR, SIDEWAYS)(np.zeros((96, 128), np.uint16)).any()
    behind = Extrinsic(np.eye(3), np.array([0.0, 0.0, -5.0]))
    assert not DepthAligner(DEPTH, COLOR, behind)(np.full((96, 128), 3000, np.uint16)).any()
    beyond = Extrinsic(np.eye(3), np.array([0.0, 0.0, 3.0]))
    assert not DepthAligner(DEPTH, COLOR, beyond)(np.full((96, 128), 65000, np.uint16)).any()


def test_as_librealsense_aligns():
    try:
        rs = load_realsense("this test")
    except MissingExtraError as error:
        pytest.skip(str(error))
    depth = millimetres(scene(DEPTH, Extrinsic.identity()))
    software = SoftwareRealSense(rs)
    frames = software.pair(depth, np.zeros((120, 160, 3), np.uint8))
    theirs = np.array(rs.align(rs.stream.color).process(frames).get_depth_frame().get_data())
    software.stop()
    ours = DepthAligner(DEPTH, COLOR, SIDEWAYS)(depth)
    both = (ours > 0) & (theirs > 0)
    difference = ours[both].astype(int) - theirs[both]
    # Theirs reaches a pixel farther right and down and takes the nearest there: never farther than ours,
    # but for rounding, and nearer by the wall's slant over one depth pixel.
    assert difference.min() >= -1
    assert np.median(difference) <= 3
    slant = np.median(np.abs(depth[1:, 1:].astype(int) - depth[:-1, :-1]))
    assert np.percentile(difference, 97) <= slant + 1
    assert np.mean(difference > 100) < 0.02  # the outline of the box, a pixel wider in theirs
    assert np.mean((ours > 0) & (theirs == 0)) < 0.001
    assert np.mean((theirs > 0) & (ours == 0)) < 0.02  # the strip behind the box and at the rim
    truth = scene(COLOR, SIDEWAYS.inverse()) * 1e3
    assert np.median(np.abs(ours - truth)[both]) < np.median(np.abs(theirs - truth)[both])


@pytest.mark.parametrize(
    "rotation",
    [np.eye(3) * 2, np.diag([1.0, 1.0, -1.0]), np.zeros((3, 3)), np.full((3, 3), np.nan), np.eye(2)],
)
def test_a_matrix_that_is_no_rotation_is_refused(rotation):
    with pytest.raises(InputError, match="rotation"):
        Extrinsic(rotation, np.zeros(3))


def test_a_translation_that_is_none_is_refused():
    with pytest.raises(InputError, match="translation"):
        Extrinsic(np.eye(3), np.array([0.0, np.inf, 0.0]))


@pytest.mark.parametrize("depth", [np.zeros((48, 64), np.uint16), np.zeros((96, 128), np.float32)])
def test_depth_of_another_size_or_type_is_refused(depth):
    with pytest.raises(InputError, match=r"\(96, 128\)"):
        DepthAligner(DEPTH, COLOR, SIDEWAYS)(depth)
