"""Left stays left: changes of sides that nobody can make are undone, those that somebody makes are not."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.pose.body import N_POINTS, Body, Point
from wigwag.pose.sides import SideKeeper, SidesConfig, other_side

PERIOD_NS = 33_333_333
ALL = tuple(Point)
LEGS = tuple(p for p in Point if p >= Point.LEFT_HIP)
SWAP = np.array([p if p is Point.NOSE else other_side(p) for p in Point])


def body(yaw_rad: float = 0.0, seed: int = 0, noise_px: float = 1.0) -> Body:
    """A standing person, turned by ``yaw_rad`` from facing the camera; every landmark has its own place."""
    random = np.random.default_rng(seed)
    points = np.zeros((N_POINTS, 2))
    for point in Point:
        side = 0.0 if point is Point.NOSE else 1.0 if "LEFT" in point.name else -1.0
        half_width = 15 if point < Point.LEFT_SHOULDER else 55 if point < Point.LEFT_HIP else 30
        points[point] = 320 + side * half_width * np.cos(yaw_rad), 100 + 9 * (point // 2)
    points += random.normal(0, noise_px, points.shape)
    order = np.arange(N_POINTS, dtype=float)
    return Body(points, 0.5 + order / 100, np.stack([order, order, order], axis=1), 1.0, 0.9)


def crossed(of: Body, points: Iterable[Point] = ALL) -> Body:
    """The same body as a network sees it that has mixed up left and right of these landmarks."""
    order = np.arange(N_POINTS)
    for point in points:
        order[point] = SWAP[point]
    return Body(of.points_px[order], of.visibility[order], of.world_m[order], of.score, of.clarity)


def same(one: Body, other: Body) -> bool:
    return (
        np.array_equal(one.points_px, other.points_px)
        and np.array_equal(one.visibility, other.visibility)
        and np.array_equal(one.world_m, other.world_m)
    )


def kept(bodies: Iterable[Body], config: SidesConfig | None = None) -> list[Body]:
    keeper = SideKeeper(config)
    return [keeper(seen, k * PERIOD_NS) for k, seen in enumerate(bodies)]


def test_other_side_is_its_own_inverse_and_the_nose_has_none() -> None:
    for point in Point:
        assert other_side(other_side(point)) is point
        assert (other_side(point) is point) == (point is Point.NOSE)


@pytest.mark.parametrize("mixed_up", [ALL, LEGS, tuple(p for p in ALL if p < Point.LEFT_HIP)])
@pytest.mark.parametrize("yaw_rad", [0.0, np.pi], ids=["front", "back"])
def test_a_moment_of_crossed_sides_is_put_right(mixed_up: tuple[Point, ...], yaw_rad: float) -> None:
    truth = [body(yaw_rad, seed) for seed in range(60)]
    seen = [crossed(b, mixed_up) if 20 <= k < 29 else b for k, b in enumerate(truth)]
    assert all(same(a, b) for a, b in zip(kept(seen), truth, strict=True))


def test_single_frames_again_and_again_are_put_right() -> None:
    truth = [body(seed=seed) for seed in range(300)]
    seen = [crossed(b) if k > 10 and k % 3 == 0 else b for k, b in enumerate(truth)]
    assert all(same(a, b) for a, b in zip(kept(seen), truth, strict=True))


def test_a_network_that_insists_is_believed_in_the_end() -> None:
    config = SidesConfig()
    truth = [body(seed=seed) for seed in range(150)]
    seen = [crossed(b) if k >= 30 else b for k, b in enumerate(truth)]
    out = kept(seen, config)
    gave_in = 30 + round(config.insist_s * 1e9 / PERIOD_NS)
    assert all(same(a, b) for a, b in zip(out[: gave_in - 2], truth, strict=False))
    assert all(same(a, b) for a, b in zip(out[gave_in + 2 :], seen[gave_in + 2 :], strict=True))


@pytest.mark.parametrize("seconds", [0.8, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("direction", [-1, 1])
def test_a_person_who_turns_round_is_left_alone(seconds: float, direction: int) -> None:
    """Front to back through profile, and on to the front again, in 0.8 s for half a turn and slower."""
    steps = round(seconds * 30)
    turning = np.concatenate([np.zeros(15), np.linspace(0, np.pi, steps), np.full(15, np.pi)])
    turning = np.concatenate([turning, np.linspace(np.pi, 2 * np.pi, steps), np.zeros(15)])
    seen = [body(direction * yaw, seed) for seed, yaw in enumerate(turning)]
    assert all(same(a, b) for a, b in zip(kept(seen), seen, strict=True))


def test_after_a_gap_and_after_a_reset_the_network_is_believed() -> None:
    keeper, config = SideKeeper(), SidesConfig()
    for k in range(30):
        keeper(body(seed=k), k * PERIOD_NS)
    back, now_ns = crossed(body(seed=50)), 30 * PERIOD_NS + int(config.forget_s * 1e9)
    assert same(keeper(back, now_ns), back)
    front = body(seed=51)
    assert not same(keeper(front, now_ns + PERIOD_NS), front), "what was believed is what is kept"
    keeper.reset()
    assert same(keeper(front, now_ns + 2 * PERIOD_NS), front)


@given(st.lists(st.booleans(), min_size=1, max_size=40), st.floats(-4, 4))
def test_landmarks_only_ever_change_places_with_their_other_side(flips: list[bool], yaw_rad: float) -> None:
    seen = [crossed(body(yaw_rad, k)) if flip else body(yaw_rad, k) for k, flip in enumerate(flips)]
    for before, after in zip(seen, kept(seen), strict=True):
        moved = (before.points_px != after.points_px).any(axis=1)
        assert np.array_equal(after.points_px[moved], before.points_px[SWAP][moved])
        assert np.array_equal(after.visibility[moved], before.visibility[SWAP][moved])
