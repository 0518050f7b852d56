"""What a stretch is most like, and how much of it has passed: ridge regression on DTW similarities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.linalg import cho_factor, cho_solve

from wigwag.features.canonical import CanonicalForm
from wigwag.recognise.presets import PRESETS
from wigwag.recognise.similarity import Sides, Similarities
from wigwag.skeleton import Clip
from wigwag.stream.glance import Glimpse, scores_of, signs_of
from wigwag.stream.watcher import Hypothesis

NOTHING = -1
"""Stands for 'no gesture, or not enough of one' where labels are numbers."""

WIDTH = 1.5
RIDGE = 3e-4
_PROGRESS_RIDGE = 3 * RIDGE
_MIDDLE = 0.75
"""Progress is learned as what it is more or less than this."""

SIGNS = (
    "score", "lead", "over nothing", "progress", "nearness", "nearer than others", "length", "activity",
    "peak", "slowing", "resting", "lull", "over nothing before", "lead before", "times before",
)  # fmt: skip
"""What is known of a look, in order; see :meth:`PrefixModel.read`."""

Evidence = tuple[int, Float[np.ndarray, " signs"], int]
"""The class a stretch is most like, the signs that it is that, the nearest reference."""


@dataclass(slots=True)
class Memory:
    """The last look at stretches by their beginnings: label, signs and how often it was the same."""

    looks: dict[int, tuple[int, float, float, int]]

    @classmethod
    def empty(cls) -> Memory:
        """Return a memory of nothing."""
        return cls({})

    def recall(self, onset: int, decided: int) -> tuple[float, float, int]:
        """Return what the last look at the same beginning said of the same label."""
        last = self.looks.get(onset)
        if last is None:
            return (-0.5, -0.2, 0)
        return (last[1], last[2], last[3]) if last[0] == decided else (-1.0, -0.5, 0)

    def keep(self, onset: int, decided: int, over: float, lead: float, times: int) -> None:
        """Remember a look."""
        self.looks[onset] = (decided, over, lead, min(times + 1, 5))
        if len(self.looks) > 64:
            self.looks = dict(sorted(self.looks.items())[-32:])


class PrefixModel:
    """Scores stretches that may be whole gestures, the first part of one, or nothing.

    As :class:`~wigwag.recognise.kernel.KernelRecognizer`, but what is learned from are the stretches that a
    :class:`~wigwag.stream.watcher.Watcher` looks at in streams, each with the share of the gesture that had
    passed; a second target is that share. References are whole gestures alone.

    Args:
        origin: As in :class:`~wigwag.features.canonical.CanonicalForm`.
    """

    def __init__(self, origin: str = "start") -> None:
        self.origin = origin
        preset = PRESETS["fast"]
        form = CanonicalForm(frames=preset.frames, origin=origin)  # type: ignore[arg-type]
        self.similar = Similarities(form, preset.kinds, preset.n_dims, preset.band, WIDTH)

    def refer_to(self, clips: Sequence[Clip], labels: Sequence[str]) -> None:
        """Take whole gestures as references and learn the projections from them."""
        sides = self.similar.fit(clips)
        self.similar.refer_to(sides)
        self.similar.set_scales(np.stack([self.similar.distances(s) for s in sides]))
        self.labels = tuple(sorted(set(labels)))
        number = {label: i for i, label in enumerate(self.labels)}
        self.numbers = np.array([number[label] for label in labels])
        self.names = [clip.name for clip in clips]
        self.typical = np.ones(len(self.labels))
        self.limits = np.full(len(self.labels), np.inf)
        self.lengths_s = np.full(len(self.labels), np.nan)
        self.weights = np.zeros((0, len(self.labels) + 2), dtype=np.float32)

    def sides(self, clip: Clip) -> Sides:
        """Return the views of a stretch."""
        return self.similar.sides(clip)

    def read(
        self, hypothesis: Hypothesis, clip: Clip, memory: Memory, glimpse: Glimpse | None = None
    ) -> Evidence:
        """Return what a stretch is most like.

        The signs: its score; its lead over the second; over 'nothing'; progress; how near the nearest
        example is, as the negative logarithm of its distance over the usual; how much nearer than another
        gesture's; length in s; activity now; the greatest; their ratio; whether the body rests; whether a
        lull was just now; and of the last look at the same beginning: its lead over 'nothing', its lead, how
        many looks have agreed. With a glimpse of the last moments it helps to decide, and those of
        :func:`~wigwag.stream.glance.signs_of` follow.
        """
        distances = self.similar.distances(self.sides(clip))
        scores = (self.similar.features(distances) @ self.weights).astype(np.float64)
        return self.evidence(hypothesis, distances, scores, memory, glimpse=glimpse)

    def evidence(
        self,
        hypothesis: Hypothesis,
        distances: Float[np.ndarray, "references views"],
        scores: Float[np.ndarray, " targets"],
        memory: Memory,
        *,
        allowed: Bool[np.ndarray, " references"] | None = None,
        glimpse: Glimpse | None = None,
    ) -> Evidence:
        """Return the same from distances and scores; references that are not allowed do not count."""
        classes = len(self.labels)
        named = scores[:classes]
        relative = self.similar.relative(distances).sum(axis=1)
        if allowed is not None:
            relative = np.where(allowed, relative, np.inf)
            named = np.where(np.bincount(self.numbers[allowed], minlength=classes) > 0, named, -np.inf)
        together = named if glimpse is None else named + scores_of(glimpse)
        decided = int(together.argmax())
        second = np.delete(named, decided).max(initial=-1.0)
        same = self.numbers == decided
        nearest = int(np.where(same, relative, np.inf).argmin())
        near = max(float(relative[nearest]), 1e-9)
        other = float(np.where(same, np.inf, relative).min(initial=30.0 * near))
        over, lead = scores[decided] - scores[classes], scores[decided] - second
        before = memory.recall(hypothesis.rows[0], decided)
        memory.keep(hypothesis.rows[0], decided, float(over), float(lead), before[2])
        signs = np.array([
            scores[decided], lead, over, scores[classes + 1] + _MIDDLE,
            -np.log(near / self.typical[decided]), min(np.log(other / near), 3.0),
            hypothesis.length_s, hypothesis.activity_m_s, hypothesis.peak_m_s,
            hypothesis.activity_m_s / max(hypothesis.peak_m_s, 1e-3),
            hypothesis.resting, hypothesis.lull, *before,
            *(() if glimpse is None else signs_of(glimpse, decided, together)),
        ])  # fmt: skip
        return decided, signs, nearest

    def usual_s(self, number: int) -> float | None:
        """Return how long a gesture usually takes, s; ``None``: not known."""
        length_s = float(self.lengths_s[number])
        return length_s if length_s > 0 else None

    def facts(self) -> dict[str, Any]:
        """Return what is not an array."""
        return {"origin": self.origin, "labels": list(self.labels), "names": self.names}

    def arrays(self) -> dict[str, np.ndarray]:
        """Return everything else."""
        own = {
            "weights": self.weights,
            "numbers": self.numbers,
            "typical": self.typical,
            "limits": self.limits,
            "lengths_s": self.lengths_s,
        }
        return own | self.similar.arrays()

    @classmethod
    def restored(cls, facts: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Self:
        """Take back what ``facts`` and ``arrays`` gave."""
        self = cls(str(facts["origin"]))
        self.labels, self.names = tuple(facts["labels"]), list(facts["names"])
        self.weights, self.numbers = arrays["weights"], arrays["numbers"]
        self.typical, self.limits = arrays["typical"], arrays["limits"]
        self.lengths_s = arrays.get("lengths_s", np.full(len(self.labels), np.nan))  # not in files of before
        self.similar.restore(arrays)
        return self


class Shares:
    """Ridge regression from sums over parts of the rows, so that parts can be left out at no cost.

    Args:
        features: How many there are.
        classes: Number of gestures.
    """

    def __init__(self, features: int, classes: int) -> None:
        self.features, self.classes = features, classes
        self._gestures: dict[int, _Sums] = {}
        self._all: dict[int, _Sums] = {}

    def add(
        self,
        fold: int,
        features: Float[np.ndarray, "rows features"],
        numbers: Int[np.ndarray, " rows"],
        progress: Float[np.ndarray, " rows"],
    ) -> None:
        """Add a fold, once.

        Args:
            fold: Whose stretches they are.
            features: Similarities to the references.
            numbers: Which gesture each is; ``NOTHING``: none.
            progress: How much of it has passed; not looked at where it is none.
        """
        targets = np.full((len(features), self.classes + 1), -1.0, dtype=np.float32)
        targets[np.arange(len(features)), np.where(numbers == NOTHING, self.classes, numbers)] = 1.0
        gesture = numbers != NOTHING
        self._all[fold] = _Sums.of(features, targets)
        passed = (progress[gesture, None] - _MIDDLE).astype(np.float32)
        self._gestures[fold] = _Sums.of(features[gesture], passed)

    def solve(
        self,
        fold: int | None = None,
        kept: Bool[np.ndarray, " features"] | None = None,
    ) -> Float[np.ndarray, "features targets"]:
        """Return a target a class, one for 'nothing', and progress, which is learned from gestures alone.

        Args:
            fold: People to be left out.
            kept: Features to be used; the others have no weight.
        """
        kept = np.ones(self.features, dtype=bool) if kept is None else kept
        weights = np.zeros((self.features, self.classes + 2), dtype=np.float32)
        every = [sums for of, sums in self._all.items() if of != fold]
        gestures = [sums for of, sums in self._gestures.items() if of != fold]
        weights[kept] = np.hstack(
            [_solution(every, kept, RIDGE, self.classes + 1), _solution(gestures, kept, _PROGRESS_RIDGE, 1)]
        )
        return weights


@dataclass(slots=True)
class _Sums:
    """What ridge regression asks of rows."""

    rows: int
    gram: Float[np.ndarray, "features features"]
    right: Float[np.ndarray, "features targets"]

    @classmethod
    def of(cls, features: np.ndarray, targets: np.ndarray) -> _Sums:
        """Sum over rows."""
        return cls(len(features), features.T @ features, features.T @ targets)


def _solution(groups: Sequence[_Sums], kept: np.ndarray, ridge: float, targets: int) -> np.ndarray:
    gram = np.zeros((int(kept.sum()), int(kept.sum())))
    right = np.zeros((len(gram), targets))
    for group in groups:
        gram += group.gram[np.ix_(kept, kept)]
        right += group.right[kept]
    gram[np.diag_indices(len(gram))] += ridge * max(sum(group.rows for group in groups), 1)
    return np.asarray(cho_solve(cho_factor(gram, lower=True, overwrite_a=True), right))
