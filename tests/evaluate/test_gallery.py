"""Time and recall against a growing gallery."""

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.evaluate import gallery as module
from wigwag.evaluate.gallery import draw_growth, growth, measure

usearch = pytest.importorskip("usearch", reason="needs usearch: pip install 'wigwag[benchmark]'")


class Walks:
    """Stands in for recordings."""

    def __init__(self, queries=12):
        rng = np.random.default_rng(0)
        self.kinds = rng.normal(size=(10, 24, 4)).cumsum(axis=1).astype(np.float32)
        self.sample = self._drawn(500, 1)
        self.queries = self._drawn(queries, 2)

    def _drawn(self, count, seed):
        rng = np.random.default_rng(seed)
        own = 0.3 * rng.normal(size=(count, 24, 4)).cumsum(axis=1)
        return (self.kinds[rng.integers(10, size=count)] + own).astype(np.float32)

    def batches(self, count):
        for start in range(0, count, 70):
            yield self._drawn(min(70, count - start), 100 + start)


def run(sizes=(50, 200, 600), shortlist=100, exact=8, **kwargs):
    from wigwag.distances import Gallery

    return list(measure(Walks(), Gallery(shortlist, directions=8), sizes, exact, **kwargs))


def test_sizes_are_those_asked_for_and_recall_is_counted():
    told = []
    rows = [m.row() for m in run(progress=lambda *a: told.append(a))]
    assert [row["size"] for row in rows] == [50, 200, 600]
    assert rows[0]["recall"] == 1, "a gallery no larger than its shortlist is searched whole"
    assert all(row["recall"] >= 0.75 and row["queries"] == 12 and row["queries_exact"] == 8 for row in rows)
    assert all(row["ms_per_query_median"] > 0 and row["ms_exact_median"] > 0 for row in rows)
    assert rows[0]["build_s"] <= rows[1]["build_s"] <= rows[2]["build_s"]
    assert ("enrolling", 600, 600) in told


def test_a_shortlist_of_one_misses():
    assert run(shortlist=1)[-1].row()["recall"] < 1


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"sizes": (10, 10)}, "must be positive and rise, but got 10, 10"),
        ({"sizes": ()}, "must be positive and rise"),
        ({"sizes": (0, 4)}, "must be positive and rise, but got 0, 4"),
        ({"exact": 0}, "must be 1 or more: 0"),
    ],
)
def test_faults(settings, message):
    with pytest.raises(InputError, match=message):
        run(**settings)


def test_growth_is_the_exponent():
    rows = [{"size": 10, "ms_per_query_median": 1.0}, {"size": 1000, "ms_per_query_median": 10.0}]
    assert growth(rows) == pytest.approx(0.5)
    with pytest.raises(InputError, match="two sizes"):
        growth(rows[:1])


def test_plot(tmp_path):
    rows = [
        {"size": s, "ms_per_query_median": m, "ms_exact_median": 3 * m, "recall": 1.0}
        for s, m in ((10, 1), (99, 2))
    ]
    draw_growth(rows, tmp_path / "new" / "plot.png")
    assert (tmp_path / "new" / "plot.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(InputError, match="the plot cannot be written"):
        draw_growth(rows, tmp_path)


def test_batches_are_cut_at_the_sizes():
    pieces = list(module._in_pieces(iter([np.zeros(7), np.zeros(7), np.zeros(6)]), [3, 10, 20]))
    assert [len(p) for p in pieces] == [3, 4, 3, 4, 6]
