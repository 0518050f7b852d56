"""A gallery finds the nearest, forgets what is removed, and says what is wrong."""

import importlib.util
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.distances import Gallery, dtw
from wigwag.errors import InputError, MissingExtraError, NotFittedError

needs_index = pytest.mark.skipif(
    importlib.util.find_spec("usearch") is None, reason="needs usearch: pip install 'wigwag[benchmark]'"
)


def walks(seed, count, frames=12, features=3, dtype="float64"):
    """Sequences of ten kinds."""
    rng = np.random.default_rng(seed)
    kinds = np.random.default_rng(99).normal(size=(10, frames, features)).cumsum(axis=1)
    own = 0.3 * rng.normal(size=(count, frames, features)).cumsum(axis=1)
    return (kinds[rng.integers(10, size=count)] + own).astype(dtype)


@needs_index
@given(
    seed=st.integers(0, 2**31),
    count=st.integers(1, 100),
    k=st.integers(1, 5),
    band=st.none() | st.integers(0, 12),
    cost=st.sampled_from(["euclidean", "squared"]),
)
@settings(max_examples=30, deadline=None)
def test_one_no_larger_than_its_shortlist_is_exact(*, seed, count, k, band, cost):
    known, query = walks(seed, count), walks(seed + 1, 1)[0]
    gallery = Gallery(shortlist=100, band=band, cost=cost, directions=4).fit(known)
    np.testing.assert_array_equal(gallery.add(known), np.arange(count))
    keys, distances = gallery.nearest(query, k)
    every = np.array([dtw(query, s, band, cost) for s in known])
    np.testing.assert_allclose(distances, np.sort(every)[:k], rtol=1e-4)
    np.testing.assert_allclose(every[keys], distances, rtol=1e-4)


@needs_index
def test_a_shortlist_finds_nearly_all_nearest_and_ones_own():
    known, queries = walks(1, 3000), walks(2, 100)
    gallery = Gallery(shortlist=200, directions=12).fit(known)
    gallery.add(known)
    found = [gallery.nearest(query)[1][0] for query in queries]
    exact = [gallery.exact(query)[1][0] for query in queries]
    assert np.mean(np.isclose(found, exact, rtol=1e-5)) >= 0.97
    assert all(gallery.nearest(known[i], 3)[0][0] == i for i in range(0, 3000, 100))


@needs_index
def test_dtw_is_run_on_the_shortlist_alone(monkeypatch):
    from wigwag.distances import gallery as module

    known = walks(1, 3000)
    gallery = Gallery(shortlist=64).fit(known)
    gallery.add(known)
    compared, inner = [], module.warp_chosen
    monkeypatch.setattr(module, "warp_chosen", lambda *a: (compared.append(len(a[2])), inner(*a))[1])
    gallery.nearest(known[5])
    assert compared == [64]


@needs_index
def test_what_is_removed_is_found_no_more_and_keys_are_not_given_twice():
    known = walks(3, 500)
    gallery = Gallery(shortlist=50).fit(known)
    gallery.add(known[:300])
    gallery.remove([7, 8, 8])
    assert len(gallery) == 298
    for way in (gallery.nearest, gallery.exact):
        assert way(known[7])[0][0] != 7
        assert way(known[9])[0][0] == 9
    assert gallery.add(known[7:8]).tolist() == [300]
    assert gallery.nearest(known[7])[0][0] == 300
    gallery.add(known[300:])  # room is made; what was there stays
    assert len(gallery) == 499
    assert gallery.nearest(known[9])[0][0] == 9
    with pytest.raises(InputError, match="holds no sequence of key 7"):
        gallery.remove([9, 7])
    assert gallery.nearest(known[9])[0][0] == 9, "none is taken out if one is not there"


@needs_index
def test_fit_empties_and_an_empty_one_finds_nothing():
    gallery = Gallery().fit(walks(4, 50))
    gallery.add(walks(4, 50))
    gallery.fit(walks(5, 50))
    assert len(gallery) == 0
    assert [len(x) for x in gallery.nearest(walks(4, 1)[0])] == [0, 0]
    gallery.add([walks(4, 1)[0]])
    gallery.remove([0])
    assert [len(x) for x in gallery.nearest(walks(4, 1)[0])] == [0, 0]


@needs_index
def test_a_query_of_another_length_is_welcome():
    known = walks(6, 400)
    gallery = Gallery(shortlist=40, band=3).fit(known)
    gallery.add(known)
    slow = np.repeat(known[11], 2, axis=0)
    keys, distances = gallery.nearest(slow)
    assert keys.tolist() == [11] and distances[0] == pytest.approx(0, abs=1e-4)
    assert len(gallery.nearest(known[11][:1])[0]) == 1


@needs_index
def test_faults():
    gallery = Gallery().fit(walks(7, 20))
    gallery.add(walks(7, 20))
    with pytest.raises(InputError, match=r"must all have shape \(12, 3\), but got lengths 5 to 12"):
        gallery.add([np.zeros((12, 3)), np.zeros((5, 3))])
    with pytest.raises(InputError, match=r"must all have shape \(12, 3\).* and 4 features"):
        gallery.add(np.zeros((2, 12, 4)))
    with pytest.raises(InputError, match="Sequence 1 holds NaN"):
        gallery.add(np.stack([np.zeros((12, 3)), np.full((12, 3), np.nan)]))
    with pytest.raises(InputError, match="empty list"):
        gallery.add([])
    with pytest.raises(InputError, match=r"query must have shape \(frames, 3\), but got \(12, 2\)"):
        gallery.nearest(np.zeros((12, 2)))
    with pytest.raises(InputError, match="query holds NaN"):
        gallery.nearest(np.full((12, 3), np.inf))
    with pytest.raises(InputError, match="k must be 1 or more"):
        gallery.nearest(np.zeros((12, 3)), 0)
    with pytest.raises(InputError, match="holds no sequence of key -1"):
        gallery.remove([-1])
    assert len(gallery) == 20


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"shortlist": 0}, "1 or more, but got 0 and 32"),
        ({"directions": 0}, "1 or more, but got 1500 and 0"),
        ({"smooth": float("nan")}, "smooth must be 0 or more"),
        ({"band": -1}, "band must be 0 or more"),
        ({"cost": "cosine"}, "'euclidean' or 'squared'"),
    ],
)
def test_settings_out_of_range(settings, message):
    with pytest.raises(InputError, match=message):
        Gallery(**settings)


def test_before_fit():
    for call in (
        lambda g: g.add([np.zeros((2, 2))]),
        lambda g: g.nearest(np.zeros((2, 2))),
        lambda g: g.remove([]),
    ):
        with pytest.raises(NotFittedError, match="Call fit"):
            call(Gallery())
    assert len(Gallery()) == 0


def test_without_usearch_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "usearch.index", None)
    with pytest.raises(MissingExtraError, match=r"needs usearch.*pip install 'wigwag\[benchmark\]'"):
        Gallery().fit(walks(8, 10))


def test_the_index_is_imported_only_when_used():
    code = "import sys, wigwag.distances; print('usearch' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
