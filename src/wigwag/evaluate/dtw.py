"""How fast DTW is, ours and others', over the same inputs in one process."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from jaxtyping import Float
from numba.core.errors import NumbaWarning

from wigwag.errors import InputError, MissingExtraError
from wigwag.evaluate.dtw_libraries import (
    PEERS,
    Contender,
    References,
    dtaidistance_nearest,
    our_nearest,
    ours,
)
from wigwag.evaluate.threads import one_thread

REFERENCES, FRAMES = 688, 64
"""As many as the paper's random split of UTD-MHAD has to learn from, resampled to one length."""

CLASSES = 27

NARROW, WIDE = 16, 1821
"""Features: as many as the Encoded recogniser's latents, and as the complete embedding."""

BAND = 6
"""Frames."""

AGREEMENT = 1e-5
"""Largest relative difference between two libraries' sums of squared distances."""

_TURN = 5
"""Queries of 16 features that a library answers in one turn, before the next library's turn."""

_SLOW = 10
"""Of the many features so many times fewer queries are timed, but three at least."""


@dataclass(frozen=True, slots=True)
class Case:
    """What is computed."""

    features: int
    band: int | None

    def __str__(self) -> str:
        """Name it as the records do."""
        return f"D={self.features}, " + ("unconstrained" if self.band is None else f"band {self.band}")


CASES: tuple[Case, ...] = tuple(Case(d, b) for d, b in product((NARROW, WIDE), (BAND, None)))


@dataclass(frozen=True, slots=True)
class Timing:
    """One library in one case."""

    library: str
    nearest: bool
    """It only looks for the nearest; else it computes all distances."""
    seconds: Float[np.ndarray, " queries"]
    disagreement: float
    """Largest relative difference from our scalar recurrence in float64."""

    @property
    def ms(self) -> float:
        """Median milliseconds a query."""
        return float(np.median(self.seconds)) * 1e3


@dataclass(frozen=True, slots=True)
class Comparison:
    """All libraries in one case."""

    case: Case
    timings: list[Timing]
    left_out: list[str]
    """Why a library did not take part."""

    @property
    def agrees(self) -> bool:
        """Whether all libraries found the same."""
        return all(timing.disagreement <= AGREEMENT for timing in self.timings)

    def rows(self) -> list[dict[str, Any]]:
        """Return one flat record a library, all distances first, then the nearest alone.

        ``times_ours`` is the library's time over that of wigwag, ``times_ours_float64`` over that of wigwag
        computing in float64, as the others do. A library that has no search for the nearest is given there
        with its time for all distances.
        """
        rows = []
        for nearest in (False, True):
            mine = {t.library: t.ms for t in self.timings if t.nearest == nearest}
            others = [t for t in self.timings if not t.nearest and not t.library.startswith("wigwag")]
            for timing in [t for t in self.timings if t.nearest == nearest] + others * nearest:
                rows.append(
                    {
                        "case": str(self.case) + (", nearest only" if nearest else ""),
                        "library": timing.library,
                        "ms_per_query_median": round(timing.ms, 4),
                        "times_ours": round(timing.ms / mine["wigwag"], 2),
                        "times_ours_float64": round(timing.ms / mine["wigwag float64"], 2),
                        "disagreement": timing.disagreement,
                        "features": self.case.features,
                        "band": self.case.band,
                        "nearest_only": nearest,
                        "references": REFERENCES,
                        "frames": FRAMES,
                        "queries": len(timing.seconds),
                    }
                )
        return rows


def compare(
    case: Case,
    references: Float[np.ndarray, "references frames features"],
    queries: Float[np.ndarray, "queries frames features"],
    progress: Callable[[str, int, int], None] = lambda what, done, total: None,
) -> Comparison:
    """Time all libraries in turn, a few queries each, on one thread.

    Every library answers the first query once before the clock starts, so that nobody's compilation
    counts; that answer is compared with the plain recurrence in float64. Who goes first changes from
    turn to turn.

    The inputs are rounded to float32, the type of wigwag's features. Others compute in float64 whatever
    they are given; conversion is not timed.

    Args:
        case: What is computed.
        references: One length for all.
        queries: Of that length too.
        progress: Called with what is being done, turns done and turns in all.
    """
    references, queries = (x.astype(np.float32).astype(np.float64) for x in (references, queries))
    with one_thread():
        contenders, left_out = _contenders(References(references), case.band, progress)
        truth = _truth(references, queries[0], case.band)
        off = [_check(contender, nearest, queries[0], truth) for contender, nearest in contenders]
        turn = _TURN if case.features == NARROW else 1
        seconds = np.zeros((len(contenders), len(queries)))
        turns = np.array_split(np.arange(len(queries)), -(-len(queries) // turn))
        for number, some in enumerate(turns):
            progress("timing", number, len(turns))
            for follower in range(len(contenders)):
                who = (number + follower) % len(contenders)
                for q in some:
                    start = perf_counter()
                    contenders[who][0].call(queries[q])
                    seconds[who, q] = perf_counter() - start
    timings = [
        Timing(contender.library, nearest, seconds[who], off[who])
        for who, (contender, nearest) in enumerate(contenders)
    ]
    return Comparison(case, timings, left_out)


def _contenders(
    references: References, band: int | None, progress: Callable[[str, int, int], None]
) -> tuple[list[tuple[Contender, bool]], list[str]]:
    """Prepare who is there; say who is not."""
    progress("preparing", 0, 1)
    found, left_out = [], []
    for dtype in ("float32", "float64"):
        found.append((ours(references, band, dtype), False))
        found.append((our_nearest(references, band, dtype), True))
    for peer, nearest in [*((p, False) for p in PEERS), (dtaidistance_nearest, True)]:
        try:
            found.append((peer(references, band), nearest))
        except MissingExtraError as error:
            left_out.append(str(error))
    return found, list(dict.fromkeys(left_out))


def _truth(
    references: Float[np.ndarray, "references frames features"],
    query: Float[np.ndarray, "frames features"],
    band: int | None,
) -> Float[np.ndarray, " references"]:
    from wigwag.distances import dtw

    return np.array([dtw(query, reference, band, "squared") for reference in references])


def _check(contender: Contender, nearest: bool, query: np.ndarray, truth: np.ndarray) -> float:
    """Return the largest relative difference of an answer from the truth."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NumbaWarning)  # about a peer's own code, while it is compiled
        answer = contender.squares(contender.call(query))
    expected = truth.min(keepdims=True) if nearest else truth
    return float(np.max(np.abs(answer - expected) / np.maximum(expected, 1e-300)))


def walks(features: int, queries: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw references and queries when there are no recordings.

    As recordings of gestures do, they fall into 27 classes: each is a random walk of its class plus one of
    its own, half as large.
    """
    rng = np.random.default_rng(seed)
    classes = rng.normal(size=(CLASSES, FRAMES, features)).cumsum(axis=1)
    drawn = rng.normal(size=(REFERENCES + queries, FRAMES, features), scale=0.5).cumsum(axis=1)
    drawn += classes[rng.integers(CLASSES, size=len(drawn))]
    return drawn[:REFERENCES], drawn[REFERENCES:]


class Recordings:
    """UTD-MHAD's clips as references and queries: the paper's random split, every clip of 64 frames.

    Args:
        path: Folder of ``Skeleton.zip``.
        seed: Of the split.

    Raises:
        DataError: If the recordings are not there.
        InputError: If there are fewer than 688 to learn from.
    """

    def __init__(self, path: str | Path, seed: int) -> None:
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.evaluate.protocols import random_split
        from wigwag.features import Normalisation, Preparation

        clips = load_skeletons(path).clips
        split = random_split(clips, seed)
        if len(split.train) < REFERENCES:
            raise InputError(f"{path}: {REFERENCES} clips to learn from are needed, got {len(split.train)}.")
        prepare, normalise = Preparation(frames=FRAMES), Normalisation()
        self._train, self._test = (
            [normalise.apply(prepare.apply(clips[i])) for i in some]
            for some in (split.train[:REFERENCES], split.test)
        )

    def arrays(self, features: int, queries: int) -> tuple[np.ndarray, np.ndarray]:
        """Return references and queries: 16 principal components of the joints, or the whole embedding.

        Components and scales are learned from the references alone.
        """
        chosen = self._test[:queries]
        if features == WIDE:
            from wigwag.features import Embedding, FrameScaler

            embedding = Embedding().fit()
            train = [embedding.embed(clip) for clip in self._train]
            scaler = FrameScaler().fit(train)
            test = [embedding.embed(clip) for clip in chosen]
            return _stacked(scaler.transform(train)), _stacked(scaler.transform(test))
        joints = _stacked([clip.joints.reshape(FRAMES, -1) for clip in self._train])
        mean = joints.mean(axis=(0, 1))
        frames = (joints - mean).reshape(-1, joints.shape[2])
        _, directions = np.linalg.eigh(frames.T @ frames)
        basis = directions[:, ::-1][:, :features]
        test_joints = _stacked([clip.joints.reshape(FRAMES, -1) for clip in chosen])
        return (joints - mean) @ basis, (test_joints - mean) @ basis


def _stacked(sequences: list[np.ndarray]) -> Float[np.ndarray, "sequences frames features"]:
    return np.stack(sequences).astype(np.float64)


def rounds(case: Case, queries: int) -> int:
    """Return how many queries are timed in a case."""
    return queries if case.features == NARROW else max(3, queries // _SLOW)


__all__ = [
    "AGREEMENT", "CASES", "Case", "Comparison", "Recordings", "Timing", "compare", "rounds", "walks",
]  # fmt: skip
