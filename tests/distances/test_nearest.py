"""The search for the nearest is exact, and its bound is a bound."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.distances import NearestSequences, dtw
from wigwag.errors import InputError


def references(seed, count=50, features=20, dtype="float32", low_rank=True):
    """Sequences whose frames lie near a few directions, as an embedding's do, or anywhere."""
    rng = np.random.default_rng(seed)
    mix = rng.normal(size=(4, features))
    out = []
    for _ in range(count):
        frames = rng.integers(1, 15)
        if low_rank:
            path = rng.normal(size=(frames, 4)).cumsum(axis=0) @ mix + 0.2 * rng.normal(
                size=(frames, features)
            )
        else:
            path = rng.normal(size=(frames, features))
        out.append(path.astype(dtype))
    return out


@given(
    seed=st.integers(0, 2**31),
    k=st.integers(1, 6),
    directions=st.integers(1, 25),
    low_rank=st.booleans(),
    dtype=st.sampled_from(["float32", "float64"]),
    band=st.none() | st.integers(0, 8),
    cost=st.sampled_from(["euclidean", "squared"]),
)
@settings(max_examples=60, deadline=None)
def test_finds_what_brute_force_finds(*, seed, k, directions, low_rank, dtype, band, cost):
    *known, query = references(seed, 51, dtype=dtype, low_rank=low_rank)
    index = NearestSequences(directions, band=band, cost=cost).fit(known)
    found, distances = index.nearest(query, k)
    brute = np.array([dtw(query, s, band, cost) for s in known])
    np.testing.assert_allclose(distances, np.sort(brute)[:k], rtol=1e-6)
    np.testing.assert_allclose(brute[found], distances, rtol=1e-6)
    assert len(set(found.tolist())) == k


@given(seed=st.integers(0, 2**31), directions=st.integers(1, 25), low_rank=st.booleans())
@settings(max_examples=40, deadline=None)
def test_the_bound_never_exceeds_the_distance(seed, directions, low_rank):
    *known, query = references(seed, 31, low_rank=low_rank)
    bounds = NearestSequences(directions).fit(known).bounds(query)
    brute = np.array([dtw(query, s) for s in known])
    assert (bounds <= brute * (1 + 1e-4) + 1e-3).all()
    if directions >= 20:
        np.testing.assert_allclose(bounds, brute, rtol=1e-3)


def test_more_directions_bound_better_and_spare_true_distances(monkeypatch):
    *known, query = references(3, 201, features=40)
    computed = {}
    for directions in (1, 8):
        index = NearestSequences(directions).fit(known)
        calls = []
        original = index._distance
        monkeypatch.setattr(index, "_distance", lambda q, r, c=calls, o=original: (c.append(r), o(q, r))[1])
        index.nearest(query, 1)
        computed[directions] = len(calls)
    assert computed[8] < computed[1]
    assert computed[8] < 20


def test_duplicates_and_itself():
    known = references(5, 10)
    index = NearestSequences(4).fit([*known, known[3], known[3]])
    found, distances = index.nearest(known[3], 3)
    assert sorted(found.tolist()) == [3, 10, 11]
    np.testing.assert_array_equal(distances, 0)


def test_only_allowed_references_and_no_more_than_there_are():
    known = references(6, 10)
    allowed = np.zeros(10, dtype=bool)
    allowed[[2, 7]] = True
    found, _ = NearestSequences(4).fit(known).nearest(known[0], 5, allowed)
    assert sorted(found.tolist()) == [2, 7]


def test_projection_is_orthonormal():
    index = NearestSequences(6).fit(references(7))
    np.testing.assert_allclose(index.basis_.T @ index.basis_, np.eye(6), atol=1e-6)


def test_no_references():
    with pytest.raises(InputError, match="empty list"):
        NearestSequences().fit([])
