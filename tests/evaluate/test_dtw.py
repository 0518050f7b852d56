"""Libraries for DTW are timed on the same inputs and must agree."""

import sys
from pathlib import Path

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.evaluate import dtw as module
from wigwag.evaluate.dtw import AGREEMENT, CASES, Case, Comparison, Recordings, Timing, compare, rounds, walks
from wigwag.evaluate.dtw_libraries import PEERS, References, dtaidistance_nearest

DATA = Path(__file__).parents[2].parent / "shared" / "data" / "utd_mhad"

with_recordings = pytest.mark.skipif(
    not (DATA / "Skeleton.zip").exists(), reason="needs shared/data/utd_mhad/Skeleton.zip beside the checkout"
)


def inputs(features=5, frames=20):
    references, queries = walks(features, 3, seed=1)
    return references[:40, :frames], queries[:, :frames]


def peers_here():
    found = []
    for peer in PEERS:
        try:
            found.append(peer(References(inputs()[0]), 3))
        except ImportError:
            continue
    return found


@pytest.mark.parametrize("band", [3, None])
def test_every_library_that_is_there_finds_the_same(band):
    comparison = compare(Case(16, band), *inputs())
    assert comparison.agrees
    libraries = [t.library.split()[0] for t in comparison.timings if not t.nearest]
    assert libraries.count("wigwag") == 2
    assert len(libraries) == 2 + len(peers_here())
    assert all((t.seconds > 0).all() and t.seconds.shape == (3,) for t in comparison.timings)


def test_early_abandoning_finds_the_nearest():
    pytest.importorskip("dtaidistance")
    references, queries = inputs()
    contender = dtaidistance_nearest(References(references), None)
    expected = module._truth(references, queries[0], None).min()
    assert contender.squares(contender.call(queries[0]))[0] == pytest.approx(expected)


def test_a_missing_peer_is_left_out_and_its_extra_named(monkeypatch):
    for name in ("aeon.distances", "dtaidistance", "tslearn.metrics"):
        monkeypatch.setitem(sys.modules, name, None)
    comparison = compare(Case(16, 3), *inputs())
    assert {t.library for t in comparison.timings} == {"wigwag", "wigwag float64"}
    assert len(comparison.left_out) == 3
    assert all("pip install 'wigwag[benchmark]'" in message for message in comparison.left_out)


def test_a_library_that_computes_something_else_is_found_out(monkeypatch):
    honest = module.ours

    def wrong(references, band, dtype):
        contender = honest(references, band, dtype)
        return module.Contender("wrong", contender.call, lambda found: found * (1 + 3 * AGREEMENT))

    monkeypatch.setattr(module, "PEERS", (lambda references, band: wrong(references, band, "float64"),))
    assert not compare(Case(16, 3), *inputs()).agrees


def test_rows_compare_with_ours_and_give_a_search_the_time_of_all_distances():
    def timing(library, ms, nearest=False):
        return Timing(library, nearest, np.array([ms, ms, 9 * ms]) / 1e3, 0.0)

    rows = Comparison(
        Case(16, 6),
        [
            timing("wigwag", 2.0),
            timing("wigwag", 0.5, nearest=True),
            timing("wigwag float64", 4.0),
            timing("wigwag float64", 1.0, nearest=True),
            timing("peer 1.0", 10.0),
        ],
        [],
    ).rows()
    found = {(r["case"], r["library"]): (r["ms_per_query_median"], r["times_ours"]) for r in rows}
    assert found == {
        ("D=16, band 6", "wigwag"): (2.0, 1.0),
        ("D=16, band 6", "wigwag float64"): (4.0, 2.0),
        ("D=16, band 6", "peer 1.0"): (10.0, 5.0),
        ("D=16, band 6, nearest only", "wigwag"): (0.5, 1.0),
        ("D=16, band 6, nearest only", "wigwag float64"): (1.0, 2.0),
        ("D=16, band 6, nearest only", "peer 1.0"): (10.0, 20.0),
    }


def test_cases_and_rounds():
    assert [str(case) for case in CASES] == [
        "D=16, band 6", "D=16, unconstrained", "D=1821, band 6", "D=1821, unconstrained",
    ]  # fmt: skip
    assert [rounds(case, 40) for case in CASES] == [40, 40, 4, 4]
    assert rounds(CASES[2], 1) == 3


def test_walks_are_seeded_and_fall_into_classes():
    a, b = walks(4, 5, 3), walks(4, 5, 3)
    np.testing.assert_array_equal(a[0], b[0])
    assert a[0].shape == (688, 64, 4) and a[1].shape == (5, 64, 4)
    assert not np.array_equal(walks(4, 5, 4)[0], a[0])
    ends = a[0][:, -1]
    gaps = np.linalg.norm(ends[:, None] - ends[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    assert gaps.min(axis=1).mean() < 0.3 * np.median(gaps)


@with_recordings
def test_recordings_give_both_sizes(monkeypatch):
    monkeypatch.setattr(module, "REFERENCES", 60)
    recordings = Recordings(DATA, 0)
    references, queries = recordings.arrays(16, 7)
    assert references.shape == (60, 64, 16) and queries.shape == (7, 64, 16)
    spread = references.reshape(-1, 16).var(axis=0)
    assert (np.diff(spread) <= 1e-9).all()  # principal components, largest first
    references, queries = recordings.arrays(1821, 3)
    assert references.shape == (60, 64, 1821) and queries.shape == (3, 64, 1821)
    assert np.abs(references).max() <= 1 + 1e-5  # scaled by the references
    assert not any((references[:, 0] == query[0]).all(axis=1).any() for query in queries)


@with_recordings
def test_too_few_recordings(monkeypatch):
    monkeypatch.setattr(module, "REFERENCES", 5000)
    with pytest.raises(InputError, match="5000 clips to learn from are needed, got 688"):
        Recordings(DATA, 0)
