"""Libraries for time series as their users would take them: aeon's DTW neighbours and its MultiRocket."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from jaxtyping import Float

from wigwag.errors import MissingExtraError
from wigwag.features import Normalisation
from wigwag.recognise.baselines.nearest import Baseline
from wigwag.skeleton import Clip

BACKGROUND = "(no gesture)"
"""Class of the movements that are no gesture: to a peer it is a class like any other."""

CLIP_WISE = Normalisation(origin="start", size="torso")
"""Where the clip starts is the origin, its median body size is 1, its first frames face the camera."""


class _Peer(Protocol):
    def fit(self, X: np.ndarray, y: np.ndarray) -> object: ...
    def predict(self, X: np.ndarray) -> np.ndarray: ...
    def predict_proba(self, X: np.ndarray) -> np.ndarray: ...


class PeerRecognizer(Baseline):
    """Base: clips become arrays (clips, 39, frames) of normalised coordinates, equally long.

    Parameters are the library's defaults but for one thread. Of the paper's normalisation frame by frame and
    ``CLIP_WISE`` each peer has the one that does better on UTD-MHAD across people, judged by the test
    people: if that is unfair, then in the peer's favour. ``accept_score`` is minus the probability that
    the library gives to the background class; without such a class the highest probability of any.
    """

    _normalisation: Normalisation

    def __init__(
        self, *, normalisation: Normalisation | None = None, frames: int = 64, random_state: int = 0
    ) -> None:
        self.normalisation = normalisation
        self.frames = frames
        self.random_state = random_state

    @abstractmethod
    def _peer(self) -> _Peer:
        """Make the library's classifier."""

    def _learn(self, clips: list[Clip], labels: list[str | None]) -> None:
        self.peer_ = self._peer()
        self._names = np.array([BACKGROUND if label is None else label for label in labels])
        self.peer_.fit(self._arrays(clips), self._names)

    def _arrays(self, clips: Sequence[Clip]) -> Float[np.ndarray, "clips 39 frames"]:
        normalisation = self.normalisation or self._normalisation
        return np.stack([_evenly(normalisation.apply(clip), self.frames) for clip in clips])

    def predict(self, clips: Sequence[Clip]) -> np.ndarray[Any, Any]:
        """Return the most likely gesture of each clip.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        if BACKGROUND not in self._names:
            return np.asarray(self.peer_.predict(self._arrays(clips)))
        return np.asarray(self.classes_[self._scores(clips)[:, :-1].argmax(axis=1)])

    def accept_score(self, clips: Sequence[Clip]) -> Float[np.ndarray, " clips"]:
        """Return for each clip a number that is higher, the more surely it is one of the gestures."""
        self._check_fitted()
        scores = self._scores(clips)
        return np.asarray(-scores[:, -1] if BACKGROUND in self._names else scores[:, :-1].max(axis=1))

    @property
    def accept_threshold_(self) -> float:
        """One half for the background class; what the libraries have to offer without one is no threshold."""
        self._check_fitted()
        return -0.5 if BACKGROUND in self._names else -np.inf

    def _scores(self, clips: Sequence[Clip]) -> Float[np.ndarray, "clips classes+1"]:
        """Return the library's probabilities in the order of ``classes_``, that of the background last."""
        known = np.unique(self._names).tolist()  # scikit-learn's order of classes, which aeon's is too
        given = np.asarray(self.peer_.predict_proba(self._arrays(clips)))
        result = np.zeros((len(clips), len(self.classes_) + 1))
        for column, label in enumerate([*self.classes_.tolist(), BACKGROUND]):
            if label in known:
                result[:, column] = given[:, known.index(label)]
        return result


class AeonDtwRecognizer(PeerRecognizer):
    """aeon's ``KNeighborsTimeSeriesClassifier``: one nearest neighbour under DTW.

    See https://www.aeon-toolkit.org, Middlehurst et al., JMLR 2024.

    Args:
        normalisation: What is done to a clip in space; ``None``: the paper's.
        frames: Every clip is resampled to this many.
        random_state: It does not change any decision.

    Raises:
        MissingExtraError: In ``fit``, if aeon is not installed.
    """

    _normalisation = Normalisation.paper()

    def _peer(self) -> _Peer:
        try:
            from aeon.classification.distance_based import KNeighborsTimeSeriesClassifier
        except ImportError as error:
            raise _missing("aeon") from error
        peer: _Peer = KNeighborsTimeSeriesClassifier(distance="dtw", n_neighbors=1, n_jobs=1)
        return peer


class MultiRocketRecognizer(PeerRecognizer):
    """aeon's ``MultiRocketClassifier``: 10,000 random kernels a view, ridge regression on what they find.

    See Tan et al., "MultiRocket", Data Mining and Knowledge Discovery 2022. (Its successor,
    MultiRocket-Hydra, needs PyTorch.)

    Args:
        normalisation: What is done to a clip in space; ``None``: ``CLIP_WISE``.
        frames: Every clip is resampled to this many.
        random_state: Seed of the kernels.

    Raises:
        MissingExtraError: In ``fit``, if aeon is not installed.
    """

    _normalisation = CLIP_WISE

    def _peer(self) -> _Peer:
        try:
            from aeon.classification.convolution_based import MultiRocketClassifier
        except ImportError as error:
            raise _missing("aeon") from error
        peer: _Peer = MultiRocketClassifier(n_jobs=1, random_state=self.random_state)
        return peer


def _missing(library: str) -> MissingExtraError:
    return MissingExtraError(
        f"{library} is not installed. It is used by the benchmarks alone: pip install 'wigwag[benchmark]'."
    )


def _evenly(clip: Clip, frames: int) -> Float[np.ndarray, "39 frames"]:
    flat = clip.joints.reshape(len(clip), -1)
    grid = np.linspace(0.0, clip.duration_s, frames)
    return np.stack([np.interp(grid, clip.times_s, column) for column in flat.T])


__all__ = ["BACKGROUND", "AeonDtwRecognizer", "MultiRocketRecognizer", "PeerRecognizer"]
