"""How the time to find the nearest grows with the number of enrolled clips."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.distances import Gallery
from wigwag.errors import InputError
from wigwag.evaluate.threads import one_thread
from wigwag.evaluate.variations import Variations

SIZES: tuple[int, ...] = (1_000, 10_000, 100_000, 1_000_000)
"""Enrolled clips."""

FRAMES, FEATURES = 24, 16
"""Frames of an enrolled clip, and principal components of its 39 coordinates."""

_RECORDED_FRAMES = 64
"""Frames of a recorded clip before its variations are drawn."""

_LEARN_FROM = 5000
"""Variations from which the components and the gallery's directions are learned."""

_SAME = 1e-5
"""Relative difference up to which two distances are the same one."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """One size of the gallery."""

    size: int
    seconds: Float[np.ndarray, " queries"]
    """With the shortlist, each query."""
    exact_seconds: Float[np.ndarray, " some"]
    """With DTW on all, those queries whose true nearest was looked for."""
    found: int
    """Of those, how many found their true nearest with the shortlist."""
    build_s: float
    """Enrolling everything so far."""
    shortlist: int

    def row(self) -> dict[str, Any]:
        """Return one flat record."""
        return {
            "size": self.size,
            "ms_per_query_median": round(float(np.median(self.seconds)) * 1e3, 4),
            "ms_per_query_p95": round(float(np.percentile(self.seconds, 95)) * 1e3, 4),
            "recall": self.found / len(self.exact_seconds),
            "ms_exact_median": round(float(np.median(self.exact_seconds)) * 1e3, 4),
            "queries": len(self.seconds),
            "queries_exact": len(self.exact_seconds),
            "shortlist": self.shortlist,
            "build_s": round(self.build_s, 2),
        }


class EnrolledClips:
    """Variations of UTD-MHAD's clips to enrol, and clips as they were recorded to look for.

    The recorded clips are parted as in the paper's random split: what is enrolled varies the 688 to learn
    from; what is looked for are the 173 others. So a query's true nearest is a stranger to it.

    Args:
        path: Folder of ``Skeleton.zip``.
        seed: Of the split and of the variations.

    Raises:
        DataError: If the recordings are not there.
    """

    def __init__(self, path: str | Path, seed: int) -> None:
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.evaluate.protocols import random_split
        from wigwag.features import Normalisation, Preparation

        clips = load_skeletons(path).clips
        split = random_split(clips, seed)
        prepare, normalise = Preparation(frames=_RECORDED_FRAMES), Normalisation()
        train, test = (
            Variations([normalise.apply(prepare.apply(clips[i])) for i in some], FRAMES)
            for some in (split.train, split.test)
        )
        self._variations, self._seed = train, seed
        drawn = np.concatenate([x for x, _ in train.batches(_LEARN_FROM, seed + 1)])
        frames = drawn.reshape(-1, drawn.shape[2])
        self._mean = frames.mean(axis=0)
        _, directions = np.linalg.eigh(np.cov((frames - self._mean).T))
        self._basis = np.ascontiguousarray(directions[:, ::-1][:, :FEATURES]).astype(np.float32)
        self.sample = self._projected(drawn)
        self.queries = self._projected(test.plain())

    def batches(self, count: int) -> Iterator[Float[np.ndarray, "batch 24 16"]]:
        """Yield so many sequences to enrol."""
        for joints, _ in self._variations.batches(count, self._seed):
            yield self._projected(joints)

    def _projected(self, joints: Float[np.ndarray, "clips 24 39"]) -> Float[np.ndarray, "clips 24 16"]:
        return np.asarray((joints - self._mean) @ self._basis, dtype=np.float32)


def measure(
    clips: EnrolledClips,
    gallery: Gallery,
    sizes: Sequence[int] = SIZES,
    exact: int = 200,
    progress: Callable[[str, int, int], None] = lambda what, done, total: None,
) -> Iterator[Measurement]:
    """Enrol more and more clips, and at each size time every query and see whether it found its nearest.

    The gallery stays one and the same; the first size's clips are part of the second's. Everything runs
    on one thread. The true nearest is found by DTW against all, under the same band and cost.

    Args:
        clips: What is enrolled and looked for.
        gallery: It is fitted anew.
        sizes: Rising numbers of clips.
        exact: How many queries' true nearest is looked for, at most.
        progress: Called with what is being done, how much is done and how much there is.

    Raises:
        InputError: If the sizes do not rise.
    """
    if not sizes or sizes[0] < 1 or any(b <= a for a, b in pairwise(sizes)):
        raise InputError(f"The sizes must be positive and rise, but got {', '.join(map(str, sizes))}.")
    if exact < 1:
        raise InputError(
            f"The number of queries whose true nearest is looked for must be 1 or more: {exact}."
        )
    with one_thread():
        gallery.fit(clips.sample)
        build_s = 0.0
        more = _in_pieces(clips.batches(sizes[-1]), sizes)
        for size in sizes:
            while len(gallery) < size:
                batch = next(more)
                start = perf_counter()
                gallery.add(batch)
                build_s += perf_counter() - start
                progress("enrolling", len(gallery), size)
            yield _measure_size(clips.queries, gallery, exact, build_s, progress)


def _measure_size(
    queries: Float[np.ndarray, "queries frames features"],
    gallery: Gallery,
    exact: int,
    build_s: float,
    progress: Callable[[str, int, int], None],
) -> Measurement:
    seconds, distances = [], []
    gallery.nearest(queries[0])  # what is compiled first does not count
    for number, query in enumerate(queries):
        progress("looking", number, len(queries))
        start = perf_counter()
        _, distance = gallery.nearest(query)
        seconds.append(perf_counter() - start)
        distances.append(float(distance[0]))
    exact_seconds, found = [], 0
    for number, query in enumerate(queries[:exact]):
        progress("looking through all", number, min(exact, len(queries)))
        start = perf_counter()
        _, distance = gallery.exact(query)
        exact_seconds.append(perf_counter() - start)
        found += distances[number] <= distance[0] * (1 + _SAME)
    return Measurement(
        len(gallery), np.array(seconds), np.array(exact_seconds), found, build_s, gallery.shortlist
    )


def _in_pieces(batches: Iterator[np.ndarray], sizes: Sequence[int]) -> Iterator[np.ndarray]:
    """Cut batches where a size is reached."""
    ends, done = list(sizes), 0
    for whole in batches:
        batch = whole
        while len(batch):
            take = min(len(batch), ends[0] - done)
            yield batch[:take]
            done += take
            batch = batch[take:]
            if done == ends[0]:
                ends.pop(0)


def growth(rows: Sequence[dict[str, Any]], field: str = "ms_per_query_median") -> float:
    """Return the exponent of the time's growth from the first size to the last; 1: linear."""
    first, last = rows[0], rows[-1]
    if first["size"] == last["size"]:
        raise InputError("Growth needs two sizes.")
    return float(np.log(last[field] / first[field]) / np.log(last["size"] / first["size"]))


def draw_growth(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Draw time a query over the size of the gallery, both logarithmic, and write each point's recall.

    Raises:
        InputError: If the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    sizes = [row["size"] for row in rows]
    axes.loglog(sizes, [r["ms_exact_median"] for r in rows], "o--", color="#8fa3ad", label="DTW on all")
    axes.loglog(sizes, [r["ms_per_query_median"] for r in rows], "o-", color="#2b6cb0", label="shortlist")
    for row in rows:
        axes.annotate(
            f"recall {100 * row['recall']:.1f} %",
            (row["size"], row["ms_per_query_median"]),
            textcoords="offset points",
            xytext=(0, -14),
            ha="center",
            fontsize=8,
        )
    axes.set(xlabel="enrolled clips", ylabel="ms a query (median, one thread)")
    axes.margins(x=0.12)
    axes.set_ylim(bottom=min(r["ms_per_query_median"] for r in rows) / 3)
    axes.grid(color="#e3e9ec")
    axes.legend(frameon=False)
    picture = BytesIO()
    figure.savefig(picture, dpi=130, format="png")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(picture.getvalue())
    except OSError as error:
        raise InputError(f"{path}: the plot cannot be written ({error.strerror}).") from error


__all__ = ["SIZES", "EnrolledClips", "Measurement", "draw_growth", "growth", "measure"]
