"""The views of a movement: what each one holds, and what each one does not see."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.recognise.people import clip
from wigwag.features.canonical import Canonical, CanonicalForm
from wigwag.features.views import VIEWS, views
from wigwag.skeleton import MIRROR, mirrored

WIDTHS = {
    "positions": 39, "velocities": 39, "directions": 39, "accelerations": 39,
    "bones": 30, "distances": 78, "hands": 6, "trunk": 6,
}  # fmt: skip
FRAMES, SECONDS = 20, 2.0
SHARE = FRAMES / 5
REAL = SHARE * 2.5 / SECONDS


def movement(seed: int = 0, frames: int = FRAMES, seconds: float = SECONDS) -> Canonical:
    rng = np.random.default_rng(seed)
    joints = rng.normal(0, 1, (13, 3)) + rng.normal(0, 0.1, (frames, 13, 3)).cumsum(axis=0)
    trunk = rng.normal(0, 0.1, (frames, 2, 3)).cumsum(axis=0)
    return Canonical(joints.astype(np.float32), trunk.astype(np.float32), seconds)


def turned(before: Canonical, seed: int) -> Canonical:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    return Canonical(
        (before.joints @ turn.T).astype(np.float32),
        (before.trunk @ turn.T).astype(np.float32),
        before.duration_s,
    )


def gradient(values: np.ndarray) -> np.ndarray:
    return np.gradient(values.reshape(len(values), -1).astype(np.float64), axis=0)


def test_every_view_has_its_width_and_single_precision():
    seen = views(movement())
    assert tuple(seen) == VIEWS
    assert {kind: array.shape for kind, array in seen.items()} == {
        kind: (FRAMES, width) for kind, width in WIDTHS.items()
    }
    assert {array.dtype for array in seen.values()} == {np.dtype(np.float32)}


@pytest.mark.parametrize("frames", [4, 16, 24])
def test_a_movement_is_not_changed_by_looking(frames):
    before = movement(frames=frames)
    joints, trunk = before.joints.copy(), before.trunk.copy()
    seen = views(before)
    seen["positions"][:] = 0
    np.testing.assert_array_equal(before.joints, joints)
    np.testing.assert_array_equal(before.trunk, trunk)


def test_finite_differences_are_numpys():
    before = movement(1)
    seen, joints = views(before), before.joints.astype(np.float64)
    speed = gradient(joints)
    np.testing.assert_allclose(seen["positions"], joints.reshape(FRAMES, -1))
    np.testing.assert_allclose(seen["velocities"], REAL * speed, atol=1e-5)
    np.testing.assert_allclose(seen["accelerations"], SHARE**2 * gradient(speed), atol=1e-4)
    np.testing.assert_allclose(seen["trunk"], REAL * gradient(before.trunk), atol=1e-5)

    apart = [np.linalg.norm(joints[:, a] - joints[:, b], axis=1) for a, b in combinations(range(13), 2)]
    np.testing.assert_allclose(seen["distances"], REAL * gradient(np.stack(apart, axis=1)), atol=1e-5)

    hands = joints[:, 5] - joints[:, 6]
    np.testing.assert_allclose(seen["hands"][:, :3], hands, atol=1e-6)
    np.testing.assert_allclose(seen["hands"][:, 3:], SHARE * gradient(hands), atol=1e-5)

    limbs = [(1, 3), (3, 5), (2, 4), (4, 6), (7, 9), (9, 11), (8, 10), (10, 12), (2, 1)]
    ways = [joints[:, b] - joints[:, a] for a, b in limbs]
    ways.append((joints[:, 1] + joints[:, 2] - joints[:, 7] - joints[:, 8]) / 2)
    units = np.stack([way / np.linalg.norm(way, axis=1, keepdims=True) for way in ways], axis=1)
    np.testing.assert_allclose(seen["bones"], REAL * gradient(units), atol=1e-5)


def test_directions_are_compressed_by_the_root_of_the_speed():
    before = movement(2)
    speed = SHARE * gradient(before.joints).reshape(FRAMES, 13, 3)
    length = np.linalg.norm(speed, axis=2, keepdims=True)
    found = views(before)["directions"].reshape(FRAMES, 13, 3)
    np.testing.assert_allclose(np.cross(found, speed), 0, atol=1e-4)  # it points the same way
    assert ((found * speed).sum(axis=2) > 0).all()
    quick = length[..., 0] > 0.1
    np.testing.assert_allclose(
        np.linalg.norm(found, axis=2)[quick], np.sqrt(length[..., 0])[quick], rtol=0.01
    )


@given(seed=st.integers(0, 1000), turn=st.integers(0, 1000))
def test_distances_alone_do_not_see_which_way_the_person_is_turned(seed, turn):
    before = movement(seed)
    plain, other = views(before), views(turned(before, turn))
    np.testing.assert_allclose(other["distances"], plain["distances"], atol=1e-4)
    for kind in set(VIEWS) - {"distances"}:
        assert np.abs(other[kind] - plain[kind]).max() > 1e-3, kind


def test_only_positions_see_where_the_person_stands():
    before = movement(3)
    other = views(Canonical(before.joints + np.float32(1.5), before.trunk + np.float32(1.5), SECONDS))
    for kind, array in views(before).items():
        if kind == "positions":
            np.testing.assert_allclose(other[kind], array + 1.5, atol=1e-5)
        else:
            np.testing.assert_allclose(other[kind], array, atol=2e-4, err_msg=kind)


def test_bones_do_not_see_how_large_the_person_is():
    before = movement(4)
    plain, other = views(before), views(Canonical(2 * before.joints, before.trunk, SECONDS))
    np.testing.assert_allclose(other["bones"], plain["bones"], atol=1e-5)
    np.testing.assert_allclose(other["distances"], 2 * plain["distances"], atol=1e-5)


def test_what_is_in_real_time_slows_down_with_the_movement_and_nothing_else_does():
    plain, slow = views(movement(5, seconds=1.0)), views(movement(5, seconds=3.0))
    for kind in VIEWS:
        factor = 1 / 3 if kind in ("velocities", "bones", "distances", "trunk") else 1
        np.testing.assert_allclose(slow[kind], factor * plain[kind], atol=1e-5, err_msg=kind)


def test_speeds_do_not_depend_on_how_many_frames_a_movement_has():
    """A straight line at a steady speed: so much a fifth of the movement, in 16 frames or in 24."""
    found = []
    for frames in (16, 24):
        line = np.linspace(0, 1, frames + 1)[:-1, None, None] * np.ones((1, 13, 3))
        before = Canonical(line.astype(np.float32), line[:, :2].astype(np.float32), 2.5)
        found.append(views(before)["velocities"])
    np.testing.assert_allclose(found[0][0], found[1][0], rtol=1e-4)
    np.testing.assert_allclose(found[0], 0.2, rtol=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_in_a_mirror_left_and_right_change_places(seed):
    form, shown = CanonicalForm(), clip("circle_left", seed, 0)
    plain, other = views(form.apply(shown)), views(form.apply(mirrored(shown)))
    flip, mirror = np.array([-1.0, 1, 1]), list(MIRROR)

    def joints(values: np.ndarray) -> np.ndarray:
        return (values.reshape(len(values), 13, 3)[:, mirror] * flip).reshape(len(values), -1)

    for kind in ("positions", "velocities", "directions", "accelerations"):
        np.testing.assert_allclose(other[kind], joints(plain[kind]), atol=0.02, err_msg=kind)
    np.testing.assert_allclose(other["trunk"], plain["trunk"] * np.tile(flip, 2), atol=1e-3)
    # One hand from the other: the mirror changes both, which leaves the sideways part as it is.
    np.testing.assert_allclose(other["hands"], plain["hands"] * np.tile(-flip, 2), atol=1e-3)
    pairs = list(combinations(range(13), 2))
    swapped = [pairs.index(tuple(sorted((mirror[a], mirror[b])))) for a, b in pairs]
    np.testing.assert_allclose(other["distances"], plain["distances"][:, swapped], atol=1e-3)
    bones = plain["bones"].reshape(-1, 10, 3)[:, [2, 3, 0, 1, 6, 7, 4, 5, 8, 9]] * flip
    bones[:, 8] *= -1  # across the shoulders: from the other side
    np.testing.assert_allclose(other["bones"], bones.reshape(-1, 30), atol=1e-3)


@pytest.mark.filterwarnings("error")
def test_bodies_without_extent_and_movements_without_duration_stay_finite():
    point = Canonical(np.zeros((4, 13, 3), np.float32), np.zeros((4, 2, 3), np.float32), 1e-9)
    for kind, array in views(point).items():
        np.testing.assert_array_equal(array, 0, err_msg=kind)
    for array in views(movement(6, seconds=0.0)).values():
        assert np.isfinite(array).all()
