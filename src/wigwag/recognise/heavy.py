"""The paper's Heavy recogniser: the full embedding, dynamic time warping, the k nearest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.distances import NearestSequences
from wigwag.features import FrameScaler, Normalisation, Preparation
from wigwag.recognise.embedded import EmbeddedClips
from wigwag.recognise.neighbours import NearestRecognizer
from wigwag.skeleton import Clip


class HeavyRecognizer(NearestRecognizer):
    """k nearest neighbours over the complete embedding under unconstrained DTW (paper, section 4).

    The answer is that of comparing a clip with every reference in all 1821 (or 4251) dimensions; an
    exact lower bound spares most of the work (:class:`~wigwag.distances.NearestSequences`). It keeps the
    references' joints, and embeds anew the few that the bound does not rule out.

    Args:
        k: How many of the nearest vote; ``None``: of 1, 3, 5, 7 the one that does best on training
            people left out.
        triples: ``"adjacent"`` (1821 features) or ``"all"`` (4251), see
            :class:`~wigwag.features.Embedding`.
        scaling: How features are made comparable, see :class:`~wigwag.features.FrameScaler`.
        motion_weight: How many times velocities and displacements count among the scaled features. The
            paper's 1 lets them drown among the many positions and angles.
        preparation: What is done to a clip in time; ``None``: the default.
        normalisation: What is done to it in space; ``None``: the default.
        null_confidence: ``recognise`` gives no label below this confidence; ``None``: chosen on training
            people by the two rates that follow.
        false_accept: Of movements that are not a taught gesture, let at most this share pass as one ...
        false_reject: ... unless more than this share of right decisions would be turned away.
        random_state: Seed; it does not change any decision of this recogniser.

    Attributes:
        classes_: The gestures, sorted.
        k_: The k in use; ``k_scores_``: accuracy of each candidate on people left out.
        null_confidence_: The threshold in use.

    Example:
        >>> import numpy as np
        >>> from wigwag.skeleton import Clip
        >>> rng, poses = np.random.default_rng(0), np.random.default_rng(1).normal(size=(2, 13, 3))
        >>> ramp = np.linspace(0, 1, 30)[:, None, None]
        >>> clips = [
        ...     Clip.at_rate(pose * (1 + ramp) + rng.normal(0, 0.01, (30, 13, 3)), 30, label, f"s{i}")
        ...     for i in range(3) for label, pose in zip(("wave", "stop"), poses)
        ... ]
        >>> recogniser = HeavyRecognizer().fit(clips)
        >>> recogniser.predict(clips[:2]).tolist()
        ['wave', 'stop']
    """

    def __init__(
        self,
        *,
        k: int | None = None,
        triples: Literal["adjacent", "all"] = "adjacent",
        scaling: Literal["minmax", "quantile", "std"] = "minmax",
        motion_weight: float = 3.0,
        preparation: Preparation | None = None,
        normalisation: Normalisation | None = None,
        null_confidence: float | None = None,
        false_accept: float = 0.02,
        false_reject: float = 0.05,
        random_state: int = 0,
    ) -> None:
        self.k = k
        self.triples = triples
        self.scaling = scaling
        self.motion_weight = motion_weight
        self.preparation = preparation
        self.normalisation = normalisation
        self.null_confidence = null_confidence
        self.false_accept = false_accept
        self.false_reject = false_reject
        self.random_state = random_state

    def _learn(self, clips: Sequence[Clip]) -> EmbeddedClips:
        self._start()
        self._references = [self._normalised(clip) for clip in clips]
        self._scaler = self._fit_scaler(EmbeddedClips(self._references, self._embedding))
        return EmbeddedClips(self._references, self._embedding, self._scaler)

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames features"]:
        return self._scaler.scale(self._embedding.embed(self._normalised(clip)))

    def _arrays(self) -> dict[str, np.ndarray]:
        return {
            "joints": np.concatenate([clip.joints for clip in self._references]),
            "stamps_ns": np.concatenate([clip.stamps_ns for clip in self._references]),
            "lengths": np.array([len(clip) for clip in self._references]),
            "center": self._scaler.center_,
            "half_range": self._scaler.half_range_,
            "mean": self.index_.mean_,
            "basis": self.index_.basis_,
            "projected": np.concatenate(self.index_.projected_),
        }

    def _restore(self, arrays: dict[str, np.ndarray]) -> NearestSequences:
        self._start()
        ends = np.cumsum(arrays["lengths"])
        self._references = [
            Clip(arrays["joints"][end - length : end], arrays["stamps_ns"][end - length : end], name=name)
            for end, length, name in zip(ends, arrays["lengths"], self.names_, strict=True)
        ]
        self._scaler = FrameScaler(self.scaling)
        self._scaler.center_, self._scaler.half_range_ = arrays["center"], arrays["half_range"]
        sequences = EmbeddedClips(self._references, self._embedding, self._scaler)
        projected = np.split(arrays["projected"], ends[:-1])
        index = NearestSequences(random_state=self.random_state)
        return index.restore(sequences, arrays["mean"], arrays["basis"], projected)
