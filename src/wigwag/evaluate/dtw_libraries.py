"""DTW libraries as their users would call them, one query against many references, each its fastest way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.distances import NearestSequences, PackedSequences
from wigwag.errors import MissingExtraError

Query = Float[np.ndarray, "frames features"]
Answer = Float[np.ndarray, " any"]


@dataclass(frozen=True, slots=True)
class Contender:
    """One way to compute a query's distances, prepared for its references."""

    library: str
    """Name and, for a peer, version."""
    call: Callable[[Query], Any]
    """What is timed."""
    squares: Callable[[Any], Answer]
    """Turns what ``call`` returned into sums of squared distances, to compare; not timed. Of a search for
    the nearest: one number."""


class References:
    """References of one length for all libraries, in one array whose first place is left for the query.

    Args:
        values: Float64.
    """

    def __init__(self, values: Float[np.ndarray, "references frames features"]) -> None:
        self.with_query = np.concatenate([values[:1], values])
        self.values = self.with_query[1:]


def ours(references: References, band: int | None, dtype: str) -> Contender:
    """All distances, by :class:`wigwag.distances.PackedSequences`."""
    packed = PackedSequences(list(references.values), dtype)

    def call(query: Query) -> Any:
        return packed.distances(query, band, "squared")

    return Contender(_our_name(dtype), call, lambda found: found)


def our_nearest(references: References, band: int | None, dtype: str, projected_from: int = 100) -> Contender:
    """Find the nearest alone; of many features (``projected_from``) by :class:`NearestSequences`."""
    sequences = list(references.values.astype(dtype, copy=False))
    if references.values.shape[2] < projected_from:
        packed = PackedSequences(sequences)

        def call(query: Query) -> Any:
            return packed.nearest(query, 1, band, "squared")

    else:
        index = NearestSequences(band=band, cost="squared").fit(sequences)

        def call(query: Query) -> Any:
            return index.nearest(query.astype(dtype, copy=False))

    return Contender(_our_name(dtype), call, lambda found: found[1])


def _our_name(dtype: str) -> str:
    return "wigwag" if dtype == "float32" else f"wigwag {dtype}"


def aeon(references: References, band: int | None) -> Contender:
    """Take aeon's pairwise distance on its usual arrays (cases, channels, time), as its users have them.

    Its local cost is the square, its window a share of the length.
    """
    return _aeon(np.ascontiguousarray(references.values.transpose(0, 2, 1)), band, "")


def aeon_view(references: References, band: int | None) -> Contender:
    """As :func:`aeon`, on a transposed view: what a frame consists of then lies together in memory.

    That serves aeon's loops much better, though nothing in its documentation says so.
    """
    return _aeon(references.values.transpose(0, 2, 1), band, "transposed view")


def _aeon(theirs: Float[np.ndarray, "references features frames"], band: int | None, what: str) -> Contender:
    try:
        from aeon.distances import dtw_pairwise_distance
    except ImportError as error:
        raise _missing("aeon") from error
    window = None if band is None else (band + 0.5) / theirs.shape[2]

    def call(query: Query) -> Any:
        return dtw_pairwise_distance(query.T[None], theirs, window=window, n_jobs=1)

    return Contender(_named("aeon", what), call, lambda found: np.asarray(found)[0])


def tslearn(references: References, band: int | None) -> Contender:
    """Take tslearn's pairwise distance. Its local cost is the square; it returns the root of the sum."""
    try:
        from tslearn.metrics import cdist_dtw
    except ImportError as error:
        raise _missing("tslearn") from error
    limit: dict[str, Any] = {}
    if band is not None:
        limit = {"global_constraint": "sakoe_chiba", "sakoe_chiba_radius": band}

    def call(query: Query) -> Any:
        return cdist_dtw(query[None], references.values, n_jobs=1, **limit)

    return Contender(_named("tslearn"), call, lambda found: np.asarray(found)[0] ** 2)


def dtaidistance(references: References, band: int | None) -> Contender:
    """Take dtaidistance's matrix in C, one row of it. As tslearn, the root of the sum of squares."""
    dtw_ndim = _dtaidistance()
    block = ((0, 1), (1, len(references.with_query)))
    window = None if band is None else band + 1

    def call(query: Query) -> Any:
        references.with_query[0] = query
        return dtw_ndim.distance_matrix_fast(
            references.with_query, window=window, block=block, parallel=False, only_triu=True
        )

    return Contender(_named("dtaidistance"), call, lambda found: np.asarray(found)[0, 1:] ** 2)


def dtaidistance_nearest(references: References, band: int | None) -> Contender:
    """Go through the references with dtaidistance's early abandoning: the best so far is its limit."""
    dtw_ndim = _dtaidistance()
    window = None if band is None else band + 1
    theirs = list(references.values)

    def call(query: Query) -> float:
        best = None
        for reference in theirs:
            distance = dtw_ndim.distance_fast(query, reference, window=window, max_dist=best)
            if best is None or distance < best:
                best = distance
        assert best is not None
        return float(best)

    name = _named("dtaidistance", "early abandoning")
    return Contender(name, call, lambda found: np.array([found**2]))


def _dtaidistance() -> Any:
    try:
        from dtaidistance import dtw_ndim
    except ImportError as error:
        raise _missing("dtaidistance") from error
    return dtw_ndim


def _named(library: str, what: str = "") -> str:
    return f"{library} {version(library)}" + (f", {what}" if what else "")


def _missing(library: str) -> MissingExtraError:
    return MissingExtraError(
        f"{library} is not installed and is left out. Install it with: pip install 'wigwag[benchmark]'"
    )


PEERS: tuple[Callable[[References, int | None], Contender], ...] = (aeon, aeon_view, dtaidistance, tslearn)
"""All distances."""

__all__ = [
    "PEERS", "Contender", "References", "aeon", "aeon_view", "dtaidistance", "dtaidistance_nearest",
    "our_nearest", "ours", "tslearn",
]  # fmt: skip
