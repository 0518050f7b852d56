"""A query against many references: the same as one at a time, and the nearest is the nearest."""

import platform
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from wigwag.distances import PackedSequences, dtw, kernels
from wigwag.errors import InputError

BANDS = st.none() | st.integers(0, 14)
COSTS = st.sampled_from(["euclidean", "squared"])
DTYPES = st.sampled_from(["float32", "float64"])


def walks(seed, count, features, longest=14, *, shortest=1, dtype="float64", offset=0.0):
    rng = np.random.default_rng(seed)
    return [
        (offset + rng.normal(size=(rng.integers(shortest, longest + 1), features)).cumsum(axis=0)).astype(
            dtype
        )
        for _ in range(count)
    ]


@given(
    seed=st.integers(0, 2**31),
    count=st.integers(1, 70),
    features=st.integers(1, 20),
    band=BANDS,
    cost=COSTS,
    dtype=DTYPES,
)
@settings(max_examples=60, deadline=None)
def test_distances_are_those_of_one_pair_at_a_time(*, seed, count, features, band, cost, dtype):
    query, *known = walks(seed, count + 1, features, dtype=dtype)
    expected = [dtw(query, s, band, cost) for s in known]
    found = PackedSequences(known).distances(query, band, cost)
    assert found.dtype == dtype
    np.testing.assert_allclose(found, expected, rtol=1e-5 if dtype == "float32" else 1e-12, atol=1e-5)


@pytest.mark.parametrize("features", [255, 256, 257, 600])
def test_many_features_are_summed_in_chunks(features):
    query, *known = walks(3, 20, features, shortest=5)
    for band in (2, None):
        expected = [dtw(query, s, band) for s in known]
        np.testing.assert_allclose(PackedSequences(known).distances(query, band), expected, rtol=1e-12)


@given(
    seed=st.integers(0, 2**31),
    features=st.integers(1, 12),
    band=BANDS,
    cost=COSTS,
    dtype=DTYPES,
    longest=st.integers(1, 40),
)
@settings(max_examples=60, deadline=None)
def test_a_bound_never_exceeds_the_distance(*, seed, features, band, cost, dtype, longest):
    query, *known = walks(seed, 40, features, longest, dtype=dtype)
    packed = PackedSequences(known)
    distances = np.array([dtw(query, s, band, cost) for s in known])
    bounds = packed.bounds(query, band, cost)
    assert (bounds <= distances).all()
    assert (bounds >= 0).all()


def test_bounds_tell_far_from_near():
    """Bounds of nothing but zeros would pass the law above."""
    classes = walks(0, 10, 6, 60, shortest=60)
    rng = np.random.default_rng(1)
    known = [classes[i % 10] + 0.2 * rng.normal(size=(60, 6)).cumsum(axis=0) for i in range(200)]
    query = classes[0] + 0.2 * rng.normal(size=(60, 6)).cumsum(axis=0)
    for band in (6, None):
        packed = PackedSequences(known)
        distances, bounds = packed.distances(query, band), packed.bounds(query, band)
        assert (bounds < distances.min()).mean() < 0.3
        assert np.median(bounds / distances) > 0.4


@given(
    seed=st.integers(0, 2**31),
    count=st.integers(1, 80),
    features=st.integers(1, 12),
    k=st.integers(1, 6),
    band=BANDS,
    cost=COSTS,
    dtype=DTYPES,
    offset=st.sampled_from([0.0, 1000.0]),
)
@settings(max_examples=80, deadline=None)
def test_the_nearest_are_the_nearest(*, seed, count, features, k, band, cost, dtype, offset):
    query, *known = walks(seed, count + 1, features, dtype=dtype, offset=offset)
    found, distances = PackedSequences(known).nearest(query, k, band, cost)
    every = np.array([dtw(query, s, band, cost) for s in known])
    # About an offset of 1000 float32 holds coordinates to 6e-5.
    close = {"rtol": 1e-5, "atol": 1e-4} if dtype == "float32" else {"rtol": 1e-9, "atol": 1e-9}
    np.testing.assert_allclose(distances, np.sort(every)[:k], **close)
    np.testing.assert_allclose(every[found], distances, **close)
    assert len(set(found.tolist())) == min(k, count)
    assert (np.diff(distances) >= 0).all()


def test_the_nearest_costs_few_distances(monkeypatch):
    from wigwag.distances import packed as module

    classes = walks(0, 10, 6, 60, shortest=60)
    rng = np.random.default_rng(1)
    known = [classes[i % 10] + 0.2 * rng.normal(size=(60, 6)).cumsum(axis=0) for i in range(500)]
    computed, inner = [], module.nearest
    monkeypatch.setattr(module, "nearest", lambda *a: (computed.append(inner(*a)), computed[-1])[1])
    PackedSequences(known).nearest(known[7] + 0.01, 1)
    assert len(computed[0]) < 100


def test_itself_and_duplicates():
    known = walks(5, 40, 3)
    packed = PackedSequences([*known, known[3], known[3]])
    found, distances = packed.nearest(known[3], 3)
    assert sorted(found.tolist()) == [3, 40, 41]
    np.testing.assert_array_equal(distances, 0)
    assert packed.distances(known[3])[[3, 40, 41]].tolist() == [0, 0, 0]


def test_only_allowed_ones_and_none():
    known = walks(6, 20, 3)
    allowed = np.zeros(20, dtype=bool)
    packed = PackedSequences(known)
    assert [len(x) for x in packed.nearest(known[0], 2, allowed=allowed)] == [0, 0]
    allowed[[4, 9]] = True
    assert sorted(packed.nearest(known[0], 5, allowed=allowed)[0].tolist()) == [4, 9]


def test_references_that_never_move_have_a_bound_too():
    packed = PackedSequences([np.ones((4, 2)), np.ones((6, 2))])
    found, distances = packed.nearest(np.zeros((5, 2)))
    assert found.tolist() in ([0], [1])
    assert distances[0] == pytest.approx(min(dtw(np.zeros((5, 2)), np.ones((n, 2))) for n in (4, 6)))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: p.distances(np.zeros((3, 4))), r"query must have shape \(frames, 2\), but got \(3, 4\)"),
        (lambda p: p.distances(np.full((3, 2), np.nan)), "query holds NaN or infinity"),
        (lambda p: p.distances(np.zeros((3, 2)), band=-1), "band must be 0 or more"),
        (
            lambda p: p.bounds(np.zeros((3, 2)), cost="manhattan"),
            "'euclidean' or 'squared', but got 'manhattan'",
        ),
        (lambda p: p.nearest(np.zeros((3, 2)), 0), "k must be 1 or more, but got 0"),
    ],
)
def test_faults(call, message):
    with pytest.raises(InputError, match=message):
        call(PackedSequences(walks(0, 3, 2)))


def test_a_reference_with_a_nan_is_named():
    bad = np.zeros((3, 2))
    bad[1, 1] = np.nan
    with pytest.raises(InputError, match="Sequence 1 holds NaN or infinity, first in frame 1"):
        PackedSequences([np.zeros((3, 2)), bad])


@pytest.mark.skipif(platform.machine() != "x86_64", reason="names of x86-64 instructions")
@pytest.mark.parametrize(("dtype", "suffix"), [("float32", "ps"), ("float64", "pd")])
def test_the_inner_loop_is_compiled_to_vector_instructions(dtype, suffix):
    compiled = njit(fastmath=True, error_model="numpy")(kernels._warp.py_func)
    lanes = kernels.lanes_of(dtype)
    row = np.zeros((3, lanes), dtype)
    block = np.zeros((2, 4, lanes), dtype)
    query = np.zeros((3, 4), dtype)
    compiled(query, block, np.full(lanes, 2), 1, False, np.zeros((2, 3, lanes), dtype), row, row[0])
    code = next(iter(compiled.inspect_asm().values()))
    assert re.search(rf"v?(mul|fmadd\d+){suffix}", code)
    assert re.search(rf"v?min{suffix}", code)
