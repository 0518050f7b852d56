"""From signs to the probability that a look is right: a small network, learned on people left out."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Self

import numpy as np
from jaxtyping import Bool, Float
from scipy.special import expit

_NETWORKS = 8
"""Few people show few looks that are hard: one network more or less would decide what is spoken of them."""
_HIDDEN = 16
_MOST_WRONG = 20_000


class Sureness:
    """Some small networks whose log odds are averaged.

    Signs are standardised; each network has one hidden layer. They learn from looks at people who took no
    part in teaching what is looked with, so that their probabilities are those of people not seen before.
    """

    def fit(
        self,
        signs: Float[np.ndarray, "looks signs"],
        right: Bool[np.ndarray, " looks"],
        seed: int = 0,
    ) -> Self:
        """Learn.

        Args:
            signs: Of looks, see :data:`~wigwag.stream.prefix.SIGNS`.
            right: Whether to act on each would have been right.
            seed: Of the networks' first weights.
        """
        self.center = signs.mean(axis=0)
        self.spread = np.maximum(signs.std(axis=0), 1e-3)
        self.first = np.zeros((_NETWORKS, signs.shape[1], _HIDDEN))
        self.first_offset = np.zeros((_NETWORKS, _HIDDEN))
        self.second = np.zeros((_NETWORKS, _HIDDEN))
        self.second_offset = np.full(_NETWORKS, -6.0)
        if not right.any() or right.all():
            return self
        from sklearn.neural_network import MLPClassifier  # 30 MB that only teaching needs

        rng = np.random.default_rng(seed)
        wrong = np.flatnonzero(~right)
        some = rng.permutation(wrong)[:_MOST_WRONG]
        rows = np.concatenate([np.flatnonzero(right), some])
        scaled = (signs[rows] - self.center) / self.spread
        for n in range(_NETWORKS):
            network = MLPClassifier(
                (_HIDDEN,), activation="tanh", alpha=1e-2, max_iter=25, tol=1e-5,
                random_state=_NETWORKS * seed + n, learning_rate_init=3e-3, n_iter_no_change=40,
            )  # fmt: skip
            with warnings.catch_warnings():
                # So many rounds are enough, settled or not: what is left out has judged it.
                warnings.simplefilter("ignore")
                network.fit(scaled, right[rows])
            (first, second), (first_offset, second_offset) = network.coefs_, network.intercepts_
            self.first[n], self.first_offset[n] = first, first_offset
            self.second[n] = second[:, 0]
            # Of what is wrong only some was learned from: as many times less likely is what is right.
            self.second_offset[n] = second_offset[0] + np.log(len(some) / len(wrong))
        return self

    def probability(self, signs: Float[np.ndarray, "*looks signs"]) -> Float[np.ndarray, "*looks"]:
        """Return the probability that acting on each look is right."""
        scaled = np.clip((signs - self.center) / self.spread, -8, 8)
        hidden = np.tanh(scaled[..., None, None, :] @ self.first + self.first_offset[:, None])[..., 0, :]
        log_odds = (hidden * self.second).sum(axis=-1) + self.second_offset
        return np.asarray(expit(log_odds.mean(axis=-1)))

    def arrays(self) -> dict[str, np.ndarray]:
        """Return what was learned."""
        names = ("center", "spread", "first", "first_offset", "second", "second_offset")
        return {f"sure_{name}": getattr(self, name) for name in names}

    @classmethod
    def restored(cls, arrays: Mapping[str, np.ndarray]) -> Self:
        """Take back what ``arrays`` gave."""
        self = cls()
        for name, array in arrays.items():
            if name.startswith("sure_"):
                setattr(self, name.removeprefix("sure_"), array)
        return self
