"""Whose turn it is to be looked at: a pure schedule, stepped frame by frame."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.pose.region import Region
from wigwag.pose.search import TILE_SHARES, Search, search_tiles

sizes = st.tuples(st.integers(1, 2000), st.integers(1, 1500))


def crops(width: int, height: int) -> set[Region]:
    tiles = {tile for share in TILE_SHARES for tile in search_tiles(width, height, share)}
    return tiles | {Region.whole(width, height)}


@pytest.mark.parametrize("share", TILE_SHARES)
@pytest.mark.parametrize(("width", "height"), [(640, 480), (480, 640), (1280, 720), (200, 200), (641, 479)])
def test_crops_cover_the_picture_and_overlap(width: int, height: int, share: float) -> None:
    tiles = search_tiles(width, height, share)
    assert (tiles[0].u, tiles[0].v) == (width / 2, height / 2)
    assert len(set(tiles)) == len(tiles)
    rng = np.random.default_rng(1)
    half = tiles[0].side / 2
    for u, v in rng.uniform((0, 0), (width, height), (200, 2)):
        assert any(abs(u - tile.u) <= half and abs(v - tile.v) <= half for tile in tiles)
    for axis in ("u", "v"):
        places = np.unique([getattr(tile, axis) for tile in tiles])
        assert np.diff(places).max(initial=0) <= half + 1e-9


@settings(max_examples=25, deadline=None)
@given(sizes, st.integers(1, 4))
def test_no_frame_looks_at_more_than_it_may_or_twice_at_one_crop(size: tuple[int, int], runs: int) -> None:
    search = Search(runs=runs)
    for frame in range(30):
        if frame == 10:
            search.found(Region(size[0] / 3, size[1] / 2, 90.0))
        planned = search.plan(*size)
        assert 1 <= len(planned) <= runs
        assert len(set(planned)) == len(planned)


@pytest.mark.parametrize(("width", "height"), [(640, 480), (1280, 720), (480, 640)])
def test_every_crop_gets_its_turn_again_and_again(width: int, height: int) -> None:
    search = Search()
    seen: dict[Region, list[int]] = defaultdict(lambda: [-1])
    frames = 700
    for frame in range(frames):
        for region in search.plan(width, height):
            seen[region].append(frame)
    assert set(seen) == crops(width, height)
    rounds = len(crops(width, height)) / 2
    for region, turns in seen.items():
        longest = max(np.diff([*turns, frames]))
        assert longest <= 2.6 * rounds, region
    assert max(np.diff(seen[Region.whole(width, height)])) <= 8


def test_the_first_frames_look_at_the_whole_and_spread_over_the_picture() -> None:
    """Coarse before fine, and neighbours that overlap not one after the other."""
    search = Search()
    first = [region for _ in range(12) for region in search.plan(640, 480)]
    assert first[0] == Region.whole(640, 480)
    assert first[1] == Region(320.0, 240.0, 320.0)
    looked = np.zeros((480, 640), bool)
    for region in first[1:]:
        if region.side < 640:
            half = region.side / 2
            u, v = int(region.u - half), int(region.v - half)
            looked[max(v, 0) : int(region.v + half), max(u, 0) : int(region.u + half)] = True
    assert looked.mean() > 0.95


def test_the_last_place_first_then_outwards() -> None:
    last = Region(500.0, 200.0, 110.0)
    search = Search()
    for _ in range(100):
        search.plan(640, 480)
    search.found(last)
    plans = [search.plan(640, 480) for _ in range(30)]
    for frame, plan in enumerate(plans):
        returned = any(
            (region.u, region.v) == (last.u, last.v) and region.side > last.side for region in plan
        )
        assert returned if frame < 10 else returned == (frame % 2 == 0)
    others = [
        r for plan in plans for r in plan if (r.u, r.v) != (last.u, last.v) and 110 / 1.2 < r.side < 250
    ]
    away = [math.hypot(r.u - last.u, r.v - last.v) for r in others]
    assert len(away) >= 12
    assert np.mean(away[:4]) < 90
    assert np.mean(away[:6]) < np.mean(away[6:])


def test_a_lost_person_is_forgotten_as_a_place_in_time() -> None:
    search = Search(memory_frames=6)
    last = Region(500.0, 200.0, 110.0)
    search.found(last)
    plans = [search.plan(640, 480) for _ in range(40)]
    assert any(region.u == last.u for region in plans[0])
    assert all(region in crops(640, 480) for plan in plans[6:] for region in plan)


def test_reset_begins_anew() -> None:
    search = Search()
    fresh = [search.plan(640, 480) for _ in range(20)]
    search.found(Region(100.0, 100.0, 90.0))
    search.plan(640, 480)
    search.reset()
    assert [search.plan(640, 480) for _ in range(20)] == fresh


def test_a_picture_of_another_size_is_laid_out_anew() -> None:
    search = Search()
    search.plan(640, 480)
    assert search.plan(320, 240)[0] == Region.whole(320, 240)


def test_one_run_a_frame_still_reaches_every_crop_after_a_person_was_lost() -> None:
    search = Search(runs=1)
    search.found(Region(320.0, 240.0, 100.0))
    seen = {region for _ in range(400) for region in search.plan(640, 480)}
    assert crops(640, 480) <= seen


def test_the_search_comes_to_a_person_of_any_size_and_place_in_time() -> None:
    """The detector sees who is 0.33 to 0.9 of a crop tall and stands in it whole: how long does that take?"""
    rng = np.random.default_rng(3)
    search = Search()
    plans = [search.plan(640, 480) for _ in range(900)]
    for person_px, mean, most in ((250, 4, 12), (136, 12, 60), (81, 12, 60), (64, 16, 70)):
        waits = []
        for _ in range(150):
            u = rng.uniform(0.15 * person_px, 640 - 0.15 * person_px)
            v = rng.uniform(0.5 * person_px, 480 - 0.5 * person_px)
            start = int(rng.integers(600))
            waits.append(
                next(
                    wait
                    for wait, plan in enumerate(plans[start:])
                    if any(
                        0.33 < person_px / r.side < 0.9
                        and abs(r.u - u) <= r.side / 2
                        and abs(r.v - v) <= r.side / 2 - 0.35 * person_px
                        for r in plan
                    )
                )
            )
        assert np.mean(waits) <= mean, person_px
        assert max(waits) <= most, person_px
