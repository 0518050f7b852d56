"""The paper's Encoded recogniser: an autoencoder makes the embedding small, DTW compares what is left."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float
from threadpoolctl import threadpool_limits  # comes with scikit-learn

from wigwag.distances import NearestSequences
from wigwag.errors import InputError
from wigwag.features import FrameScaler, Normalisation, Preparation
from wigwag.recognise.embedded import EmbeddedClips
from wigwag.recognise.neighbours import NearestRecognizer
from wigwag.skeleton import Clip

if TYPE_CHECKING:
    from sklearn.decomposition import PCA
    from sklearn.neural_network import MLPRegressor


class EncodedRecognizer(NearestRecognizer):
    """k nearest neighbours under DTW over an autoencoder's latent sequences (paper, section 4).

    A network of dense layers, ``features -> hidden -> latent -> hidden -> features``, is trained to give
    back each frame of the scaled embedding; its first half then encodes every frame. Three things make
    the fit a matter of seconds. The frames are first projected on their ``components`` principal
    directions (98 % of the variance of 1821 features at 128), which for a network whose output stays in
    that subspace leaves the reconstruction error the same up to a constant; encoding then folds scaling,
    projection and first layer into one. At most ``max_frames`` frames, evenly picked, are learned from.
    And training stops when a tenth of them, held out, is no longer reconstructed better.

    Args:
        latent: Numbers a frame is encoded in.
        hidden: Width of the dense layer on either side of the latent one.
        components: Principal directions in front of the network.
        max_frames: Frames to learn from.
        max_epochs: Passes over them at most.
        k: As in :class:`~wigwag.recognise.HeavyRecognizer`, and so are the parameters below.
        triples: See there.
        scaling: See there.
        motion_weight: See there.
        preparation: See there.
        normalisation: See there.
        null_confidence: See there.
        false_accept: See there.
        false_reject: See there.
        random_state: Seed of the network's first weights and of the order of frames.

    Attributes:
        classes_: The gestures, sorted.
        k_: The k in use.
        null_confidence_: The threshold in use.
        reconstruction_: Share of the training frames' variance that the network gives back.
    """

    def __init__(
        self,
        *,
        latent: int = 16,
        hidden: int = 96,
        components: int = 128,
        max_frames: int = 15000,
        max_epochs: int = 30,
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
        self.latent = latent
        self.hidden = hidden
        self.components = components
        self.max_frames = max_frames
        self.max_epochs = max_epochs
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

    def _learn(self, clips: Sequence[Clip]) -> list[Float[np.ndarray, "frames features"]]:
        for field in ("latent", "hidden", "components", "max_frames", "max_epochs"):
            if getattr(self, field) < 1:
                raise InputError(
                    f"EncodedRecognizer.{field} must be 1 or more, but got {getattr(self, field)}."
                )
        self._start()
        sequences = EmbeddedClips([self._normalised(clip) for clip in clips], self._embedding)
        scaler = self._fit_scaler(sequences)
        every = max(1, -(-sum(map(len, sequences.clips)) // self.max_frames))
        frames = scaler.scale(np.concatenate([s[i % every :: every].copy() for i, s in enumerate(sequences)]))
        self._fold(scaler, *self._train(frames))
        return [self._encode(sequence) for sequence in sequences]

    def _train(self, frames: Float[np.ndarray, "frames features"]) -> tuple[PCA, MLPRegressor, float]:
        # Teaching alone needs these, and what comes with them: 100 MB.
        from sklearn.decomposition import PCA
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.neural_network import MLPRegressor

        pca = PCA(
            min(self.components, *frames.shape), svd_solver="randomized", random_state=self.random_state
        )
        reduced = pca.fit_transform(frames).astype(np.float32)
        # One common factor: the network likes numbers about 1, the error's proportions stay.
        size = max(float(reduced.std()), 1e-6)
        network = MLPRegressor(
            hidden_layer_sizes=(self.hidden, self.latent, self.hidden),
            activation="tanh",
            batch_size=min(128, len(reduced)),
            learning_rate_init=2e-3,
            max_iter=self.max_epochs,
            early_stopping=len(reduced) >= 100,
            n_iter_no_change=4,
            random_state=self.random_state,
        )
        # Products this small are faster on one thread, far faster where others use the machine as well.
        with warnings.catch_warnings(), threadpool_limits(1, user_api="blas"):
            warnings.simplefilter("ignore", ConvergenceWarning)  # max_epochs is a budget, not a failure
            network.fit(reduced / size, reduced / size)
        error = (network.predict(reduced / size) * size - reduced).var(axis=0).sum()
        whole = pca.explained_variance_.sum() / max(float(pca.explained_variance_ratio_.sum()), 1e-12)
        lost = float(error) + float(whole) - float(pca.explained_variance_.sum())
        self.reconstruction_ = 1.0 - lost / max(float(whole), 1e-12)
        return pca, network, size

    def _fold(self, scaler: FrameScaler, pca: PCA, network: MLPRegressor, size: float) -> None:
        """Make scaling, projection and the first dense layer one product."""
        first, second = network.coefs_[:2]
        product = (pca.components_.T.astype(np.float64) / size) @ first.astype(np.float64)
        weights = product / scaler.half_range_[:, None]
        offset = network.intercepts_[0] - pca.mean_.astype(np.float64) @ product - scaler.center_ @ weights
        self._layers = [
            (weights.astype(np.float32), offset.astype(np.float32)),
            (second.astype(np.float32), network.intercepts_[1].astype(np.float32)),
        ]

    def _encode(self, embedded: Float[np.ndarray, "frames features"]) -> Float[np.ndarray, "frames latent"]:
        (first, first_offset), (second, second_offset) = self._layers
        return np.asarray(np.tanh(np.tanh(embedded @ first + first_offset) @ second + second_offset))

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames latent"]:
        return self._encode(self._embedding.embed(self._normalised(clip)))

    def _index(self, sequences: Sequence[np.ndarray]) -> NearestSequences:
        # So few dimensions need no bound: with all directions kept it is the distance itself.
        return NearestSequences(n_projected=self.latent).fit(sequences)

    def _arrays(self) -> dict[str, np.ndarray]:
        (first, first_offset), (second, second_offset) = self._layers
        return {
            "sequences": np.concatenate(self.index_.sequences_),
            "lengths": np.array([len(s) for s in self.index_.sequences_]),
            "first": first,
            "first_offset": first_offset,
            "second": second,
            "second_offset": second_offset,
            "reconstruction": np.array([self.reconstruction_]),
        }

    def _restore(self, arrays: dict[str, np.ndarray]) -> NearestSequences:
        self._start()
        self._layers = [
            (arrays["first"], arrays["first_offset"]),
            (arrays["second"], arrays["second_offset"]),
        ]
        self.reconstruction_ = float(arrays["reconstruction"][0])
        return self._index(np.split(arrays["sequences"], np.cumsum(arrays["lengths"])[:-1]))
