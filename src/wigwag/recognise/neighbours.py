"""What the Heavy and the Encoded recogniser share: k nearest references under DTW, vote, confidence."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from os import PathLike
from typing import Any, Literal, Self

import numpy as np
from jaxtyping import Float

from wigwag.distances import NearestSequences
from wigwag.errors import InputError, NotFittedError
from wigwag.features import Classifier, Embedding, FrameScaler, Normalisation, Preparation
from wigwag.gesture import Gesture
from wigwag.recognise import store
from wigwag.recognise.confidence import (
    BACKGROUND,
    Confidence,
    Evidence,
    choose_k,
    held_out,
    weigh,
)
from wigwag.recognise.examples import check_clips, labels_of
from wigwag.skeleton import Clip

K_CANDIDATES = (1, 3, 5, 7)
"""Values of k that cross-validation chooses from."""


class NearestRecognizer(Classifier):
    """Base of recognisers that compare a clip's sequence of vectors with those of all training clips.

    A subclass says what the sequences are: ``_learn`` and ``_sequence``.
    """

    k: int | None
    triples: Literal["adjacent", "all"]
    scaling: Literal["minmax", "quantile", "std"]
    motion_weight: float
    preparation: Preparation | None
    normalisation: Normalisation | None
    null_confidence: float | None
    false_accept: float
    false_reject: float
    random_state: int

    classes_: np.ndarray
    k_: int

    @classmethod
    def as_in_paper(cls, **settings: Any) -> Self:
        """Return the paper's plain form: clips as recorded, normalised frame by frame, features alike.

        Args:
            settings: Any other parameters of the recogniser.
        """
        plain: dict[str, Any] = {
            "preparation": Preparation.none(),
            "normalisation": Normalisation.paper(),
            "scaling": "minmax",
            "motion_weight": 1.0,
        }
        return cls(**(plain | settings))

    # -- what a subclass brings -------------------------------------------------------------------------

    @abstractmethod
    def _learn(self, clips: Sequence[Clip]) -> Sequence[Float[np.ndarray, "frames features"]]:
        """Fit what turns a clip into a sequence, and return the training clips' sequences."""

    @abstractmethod
    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames features"]:
        """Turn one clip into a sequence."""

    @abstractmethod
    def _arrays(self) -> dict[str, np.ndarray]:
        """Return what ``_learn`` learned, to be saved."""

    @abstractmethod
    def _restore(self, arrays: dict[str, np.ndarray]) -> NearestSequences:
        """Take back what ``_arrays`` gave, and return the index of references."""

    def _index(self, sequences: Sequence[np.ndarray]) -> NearestSequences:
        return NearestSequences(random_state=self.random_state).fit(sequences)

    def _start(self) -> None:
        self._preparation = self.preparation or Preparation()
        self._normalisation = self.normalisation or Normalisation()
        self._embedding = Embedding(self.triples).fit()

    def _fit_scaler(self, sequences: Sequence[np.ndarray]) -> FrameScaler:
        if not self.motion_weight > 0:
            raise InputError(f"motion_weight must be positive, but got {self.motion_weight}.")
        linear = [name.split(".")[1] in ("velocity", "displacement") for name in self._embedding.names_]
        weights = np.where(linear, self.motion_weight, 1.0)
        return FrameScaler(self.scaling, weights).fit(sequences)

    def _normalised(self, clip: Clip) -> Clip:
        return self._normalisation.apply(self._preparation.apply(clip))

    # -- fit ----------------------------------------------------------------------------------------------

    def fit(self, clips: Sequence[Clip], y: Sequence[str | None] | np.ndarray | None = None) -> Self:
        """Learn gestures from examples.

        Clips labelled ``None`` are movements that are no gesture. They take part as references: a clip
        that is nearest to them is no gesture either.

        Args:
            clips: Examples, with ``subject`` set where more than one person shows them; k, the confidence
                and the threshold are then chosen by leaving each person out.
            y: Labels; ``None``: the clips' own.

        Raises:
            InputError: If there are no clips, no labels, or not as many labels as clips.
        """
        if self.k is not None and self.k < 1:
            raise InputError(f"{type(self).__name__}.k must be 1 or more, or None, but got {self.k}.")
        labels = labels_of(clips, y)
        self.classes_ = np.array(sorted({label for label in labels if label is not None}))
        number = {str(label): i for i, label in enumerate(self.classes_)}
        self.numbers_ = np.array([BACKGROUND if label is None else number[label] for label in labels])
        self.names_ = [clip.name for clip in clips]
        self.index_ = self._index(self._learn(clips))
        self._choose([clip.subject for clip in clips])
        return self

    def _choose(self, subjects: list[str | None]) -> None:
        """Choose k, the confidence's weights and its threshold from distances between training clips.

        The bounds stand in for the distances: they are within a few per cent of them and cost a
        hundredth.
        """
        packed = self.index_.packed_
        distances = np.stack([packed.distances(projected) for projected in self.index_.projected_])
        distances = np.asarray(np.minimum(distances, distances.T), dtype=np.float64)
        allowed = held_out(distances, subjects)
        self.k_scores_: dict[int, float] = {}
        if self.k is None:
            self.k_, self.k_scores_ = choose_k(distances, self.numbers_, allowed, K_CANDIDATES)
        else:
            self.k_ = int(self.k)
        self.confidence_ = Confidence(self.false_accept, self.false_reject)
        self.confidence_.fit(distances, self.numbers_, allowed, self.k_)
        self.null_confidence_ = (
            self.confidence_.threshold_ if self.null_confidence is None else float(self.null_confidence)
        )

    # -- decide -------------------------------------------------------------------------------------------

    def predict(self, clips: Sequence[Clip]) -> np.ndarray:
        """Return the most likely gesture of each clip: always one, however unlikely.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        check_clips(clips)
        gesture = self.numbers_ != BACKGROUND
        decided = [self._weigh(clip, gesture)[0].decided for clip in clips]
        return np.asarray(self.classes_[np.array(decided, dtype=int)])

    def predict_proba(self, clips: Sequence[Clip]) -> Float[np.ndarray, "clips classes"]:
        """Return a probability for each gesture, given that it is one of them.

        The decided gesture has its calibrated confidence, and the others share the rest according to
        their distance; the decided one is never below another.
        """
        self._check_fitted()
        check_clips(clips)
        gesture = self.numbers_ != BACKGROUND
        result = np.zeros((len(clips), len(self.classes_)))
        for row, clip in zip(result, clips, strict=True):
            evidence, bounds, _ = self._weigh(clip, gesture)
            near = np.full(len(row), np.inf)
            np.minimum.at(near, self.numbers_[gesture], bounds[gesture])
            weight = np.exp(-(near - near.min()) / (0.25 * max(float(near.min()), 1e-12)))
            weight[evidence.decided] = 0.0
            sure = self.confidence_(evidence)
            if weight.sum() == 0:
                row[evidence.decided] = 1.0
                continue
            weight /= weight.sum()
            sure = max(sure, weight.max() / (1 + weight.max()))
            row[:] = (1 - sure) * weight
            row[evidence.decided] = sure
        return result

    def recognise(self, clip: Clip) -> Gesture:
        """Decide what one clip shows; ``label=None`` if it is no gesture, or if that is not sure enough.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        evidence, _, voters = self._weigh(clip, None)
        first, last = int(clip.stamps_ns[0]), int(clip.stamps_ns[-1])
        nearest = self.names_[int(voters[0])]
        if evidence.decided == BACKGROUND:
            return Gesture(None, 0.0, first, last, last, f"like a movement that is no gesture ({nearest})")
        label, sure = str(self.classes_[evidence.decided]), self.confidence_(evidence)
        novelty = self.confidence_.novelty(evidence)
        account = f"nearest example {nearest} at {novelty:.2f} times the usual distance"
        if novelty > self.confidence_.novelty_limit_:
            limit = self.confidence_.novelty_limit_
            reason = f"unlike any {label} learned: {account}, limit {limit:.2f}"
            return Gesture(None, sure, first, last, last, reason)
        if sure < self.null_confidence_:
            reason = f"not sure of {label}: {sure:.2f} < {self.null_confidence_:.2f}; {account}"
            return Gesture(None, sure, first, last, last, reason)
        return Gesture(label, sure, first, last, last, account)

    def _weigh(
        self, clip: Clip, allowed: np.ndarray | None
    ) -> tuple[Evidence, Float[np.ndarray, " references"], np.ndarray]:
        """Find the nearest references among those allowed and weigh what they say."""
        sequence = self._sequence(clip)
        bounds = self.index_.bounds(sequence)
        voters, distances = self.index_.nearest(sequence, self.k_, allowed, bounds)
        if allowed is None:
            return weigh(bounds, self.numbers_, voters, distances), bounds, voters
        where = np.cumsum(allowed) - 1
        evidence = weigh(bounds[allowed], self.numbers_[allowed], where[voters], distances)
        return evidence, bounds, voters

    def _check_fitted(self) -> None:
        if not hasattr(self, "index_"):
            name = type(self).__name__
            raise NotFittedError(f"{name} is not fitted yet; call fit with clips, or {name}.load a model.")

    # -- keep ---------------------------------------------------------------------------------------------

    def save(self, path: str | PathLike[str]) -> None:
        """Write the fitted recogniser to one file of arrays and JSON; an old file is replaced at once.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        facts: dict[str, Any] = {
            "parameters": store.plain(self.get_params(deep=False)),
            "classes": [str(label) for label in self.classes_],
            "names": self.names_,
            "k": self.k_,
            "k_scores": {str(k): v for k, v in self.k_scores_.items()},
            "null_confidence": self.null_confidence_,
            "offset": self.confidence_.offset_,
            "novelty_limit": self.confidence_.novelty_limit_,
            "threshold": self.confidence_.threshold_,
            "rates": self.confidence_.rates_,
        }
        arrays = {
            "numbers": self.numbers_,
            "typical": self.confidence_.typical_,
            "weights": self.confidence_.weights_,
            **self._arrays(),
        }
        store.write(path, type(self).__name__, facts, arrays)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a recogniser that ``save`` wrote; it predicts what the saved one did.

        Raises:
            ModelError: If the file is missing, damaged, of another version, or holds something else.
        """
        facts, arrays = store.read(path, cls.__name__)
        with store.explained(path):
            self = cls(**store.revived(facts["parameters"]))
            self.classes_ = np.array(facts["classes"])
            self.names_ = list(facts["names"])
            self.numbers_ = arrays["numbers"]
            self.k_ = int(facts["k"])
            self.k_scores_ = {int(k): float(v) for k, v in facts["k_scores"].items()}
            self.null_confidence_ = float(facts["null_confidence"])
            self.confidence_ = Confidence(self.false_accept, self.false_reject)
            self.confidence_.typical_, self.confidence_.weights_ = arrays["typical"], arrays["weights"]
            self.confidence_.offset_ = float(facts["offset"])
            self.confidence_.novelty_limit_ = float(facts["novelty_limit"])
            self.confidence_.threshold_ = float(facts["threshold"])
            self.confidence_.rates_ = dict(facts["rates"])
            self.index_ = self._restore(arrays)
        return self
