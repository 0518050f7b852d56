"""What the baselines that look for the one nearest example have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float

from wigwag.errors import InputError, NotFittedError
from wigwag.features import Classifier
from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Landmark

ACCEPT = 0.95
"""Share of right decisions about training people left out that the threshold lets through."""


class Baseline(Classifier):
    """Base of the baselines: labels are checked here, decisions are made in the subclass."""

    classes_: np.ndarray

    def fit(self, clips: Sequence[Clip], y: Sequence[str | None] | np.ndarray | None = None) -> Self:
        """Learn gestures from examples; label ``None`` is a movement that is no gesture.

        Args:
            clips: Examples, with ``subject`` set where more than one person shows them.
            y: Labels; ``None``: the clips' own.

        Raises:
            InputError: If there are no clips, no labels, or not as many labels as clips.
        """
        if len(clips) == 0:
            raise InputError("fit needs at least one labelled clip, but got an empty list.")
        labels = [clip.label for clip in clips] if y is None else [None if v is None else str(v) for v in y]
        if len(labels) != len(clips):
            raise InputError(f"fit needs one label a clip, but got {len(labels)} for {len(clips)} clips.")
        if all(label is None for label in labels):
            raise InputError("fit needs clips of at least one gesture, but every label is None.")
        self.classes_ = np.array(sorted({label for label in labels if label is not None}))
        self._learn(list(clips), labels)
        return self

    @abstractmethod
    def _learn(self, clips: list[Clip], labels: list[str | None]) -> None:
        """Learn from checked input."""

    @abstractmethod
    def predict(self, clips: Sequence[Clip]) -> np.ndarray[Any, Any]:
        """Return the most likely gesture of each clip."""

    @abstractmethod
    def accept_score(self, clips: Sequence[Clip]) -> Float[np.ndarray, " clips"]:
        """Return for each clip a number that is higher, the more surely it is one of the gestures."""

    @property
    @abstractmethod
    def accept_threshold_(self) -> float:
        """The score from which ``recognise`` believes a decision; chosen on training people."""

    def recognise(self, clip: Clip) -> Gesture:
        """Decide what one clip shows; ``label=None`` below ``accept_threshold_``.

        The confidence is 1 or 0: the published methods give none.
        """
        score = float(self.accept_score([clip])[0])
        first, last = int(clip.stamps_ns[0]), int(clip.stamps_ns[-1])
        if score < self.accept_threshold_:
            reason = f"not like any example: score {score:.3g} < {self.accept_threshold_:.3g}"
            return Gesture(None, 0.0, first, last, last, reason)
        return Gesture(str(self.predict([clip])[0]), 1.0, first, last, last, f"score {score:.3g}")

    def _check_fitted(self) -> None:
        if not hasattr(self, "classes_"):
            raise NotFittedError(f"{type(self).__name__} is not fitted yet; call fit with clips.")


class NearestBaseline(Baseline):
    """One nearest neighbour; a subclass says what is compared and how.

    ``accept_score`` is minus the distance to the nearest example of a gesture; where movements that are
    none were taught, the logarithm of how many times nearer the nearest gesture is than the nearest of them.
    """

    def _learn(self, clips: list[Clip], labels: list[str | None]) -> None:
        self.labels_ = np.array(labels, dtype=object)
        self.subjects_ = [clip.subject for clip in clips]
        self.references_ = [self._sequence(clip) for clip in clips]
        self._threshold: float | None = None
        self._tune()

    def _tune(self) -> None:
        """Learn what is beyond the references, if anything."""

    @abstractmethod
    def _sequence(self, clip: Clip) -> np.ndarray:
        """Turn a clip into what is compared."""

    @abstractmethod
    def _distances(self, sequence: np.ndarray) -> Float[np.ndarray, " references"]:
        """Compare one sequence with every reference."""

    def predict(self, clips: Sequence[Clip]) -> np.ndarray[Any, Any]:
        """Return the gesture of the nearest example of each clip.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        nearest = [np.argmin(np.where(self._gesture, self._to_all(clip), np.inf)) for clip in clips]
        return np.asarray(self.labels_[np.array(nearest, dtype=int)].astype(str))

    def accept_score(self, clips: Sequence[Clip]) -> Float[np.ndarray, " clips"]:
        """Return for each clip a number that is higher, the more surely it is one of the gestures."""
        self._check_fitted()
        everything = np.ones(len(self.labels_), dtype=bool)
        return np.array([self._score(self._to_all(clip), everything) for clip in clips])

    @property
    def accept_threshold_(self) -> float:
        """The score that 95 % of the right decisions about training people left out reach.

        Computed when it is first asked for: the distances between all training clips are needed for it.
        """
        self._check_fitted()
        if self._threshold is None:
            right = [
                self._score(distances, others)
                for i, (distances, others) in enumerate(self._left_out())
                if self._gesture[i]
                and (self._gesture & others).any()
                and self.labels_[np.argmin(np.where(self._gesture & others, distances, np.inf))]
                == self.labels_[i]
            ]
            self._threshold = float(np.quantile(right, 1 - ACCEPT)) if right else -np.inf
        return self._threshold

    @property
    def _gesture(self) -> Bool[np.ndarray, " references"]:
        return np.array([label is not None for label in self.labels_])

    def _to_all(self, clip: Clip) -> Float[np.ndarray, " references"]:
        return self._distances(self._sequence(clip))

    def _score(self, distances: np.ndarray, allowed: Bool[np.ndarray, " references"]) -> float:
        gesture = distances[self._gesture & allowed].min()
        if not (~self._gesture & allowed).any():
            return -float(gesture)
        none = distances[~self._gesture & allowed].min()
        return float(np.log(max(none, 1e-12) / max(gesture, 1e-12)))

    def _left_out(self) -> list[tuple[np.ndarray, Bool[np.ndarray, " references"]]]:
        """Return each training clip's distances, and which references are other people's."""
        return [
            (self._distances(sequence), others_than(self.subjects_, i))
            for i, sequence in enumerate(self.references_)
        ]


def others_than(subjects: Sequence[str | None], i: int) -> Bool[np.ndarray, " clips"]:
    """Say which clips are of other people than clip ``i``; if only one person is known, all but itself."""
    if subjects[i] is None or len({s for s in subjects if s is not None}) < 2:
        return np.array([j != i for j in range(len(subjects))])
    return np.array([s != subjects[i] for s in subjects])


def by_shoulders(clip: Clip) -> Float[np.ndarray, "frames 13 3"]:
    """Move the middle of the shoulders to the origin, frame by frame; a shoulder width becomes 1.

    The width is the median over the clip's frames: seen from the side it would vanish.
    """
    left, right = clip.joints[:, Landmark.LEFT_SHOULDER], clip.joints[:, Landmark.RIGHT_SHOULDER]
    width = float(np.median(np.linalg.norm(left - right, axis=1)))
    middle = (left + right)[:, None, :] / 2
    return np.asarray((clip.joints - middle) / max(width, 1e-9))


__all__ = ["ACCEPT", "Baseline", "NearestBaseline", "by_shoulders", "others_than"]
