"""A small network that says which of some classes a row of numbers is, and how it is taught."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Self

import numpy as np
from jaxtyping import Float, Int

HIDDEN = 128
RATE = 1e-3
"""Adam's."""
DECAY = 0.1
_BATCH = 256
DROPPED = 0.3


class Network:
    """Numbers, standardised; one hidden layer; the probabilities of the classes.

    Args:
        features: How many numbers.
        classes: How many classes.
        rng: Of the first weights.
        hidden: How many numbers the hidden layer has.
    """

    def __init__(self, features: int, classes: int, rng: np.random.Generator, hidden: int = HIDDEN) -> None:
        self.center = np.zeros(features, dtype=np.float32)
        self.spread = np.ones(features, dtype=np.float32)
        self.layers: list[Float[np.ndarray, "..."]] = []
        for inside, outside in ((features, hidden), (hidden, classes)):
            bound = np.sqrt(6.0 / (inside + outside))
            self.layers.append(rng.uniform(-bound, bound, (inside, outside)).astype(np.float32))
            self.layers.append(np.zeros(outside, dtype=np.float32))

    def standardise(self, numbers: Float[np.ndarray, "rows features"]) -> None:
        """Learn what is usual."""
        self.center = numbers.mean(axis=0)
        self.spread = numbers.std(axis=0) + 0.01

    def probabilities(self, numbers: Float[np.ndarray, "rows features"]) -> Float[np.ndarray, "rows classes"]:
        """Return the probability of each class."""
        first, first_offset, second, second_offset = self.layers
        hidden = np.maximum((numbers - self.center) / self.spread @ first + first_offset, 0)
        return _softmax(hidden @ second + second_offset)

    def rarer(self, number: int, times: float) -> None:
        """Say that a class is so many times as usual as it was where the network has learned."""
        self.layers[3][number] += np.float32(np.log(times))

    def arrays(self, prefix: str) -> dict[str, np.ndarray]:
        """Return what was learned."""
        named = {f"{prefix}_layer{i}": layer for i, layer in enumerate(self.layers)}
        return {f"{prefix}_center": self.center, f"{prefix}_spread": self.spread} | named

    @classmethod
    def restored(cls, arrays: Mapping[str, np.ndarray], prefix: str) -> Self:
        """Take back what ``arrays`` gave."""
        layers = [arrays[f"{prefix}_layer{i}"] for i in range(4)]
        self = cls(1, 1, np.random.default_rng(0))
        self.center, self.spread = arrays[f"{prefix}_center"], arrays[f"{prefix}_spread"]
        self.layers = layers
        return self


class Teacher:
    """Teaches a network by Adam (Kingma and Ba, ICLR 2015), with dropout of what it sees.

    Args:
        network: With ``standardise`` done.
        rng: Of what is dropped.
        dropped: Of what is seen, so much is hidden while learning: no number may be relied on alone.
    """

    def __init__(self, network: Network, rng: np.random.Generator, dropped: float = DROPPED) -> None:
        self.network, self.rng, self.dropped = network, rng, dropped
        self.steps = 0
        self._mean = [np.zeros_like(layer) for layer in network.layers]
        self._square = [np.zeros_like(layer) for layer in network.layers]

    def learn(
        self, numbers: Float[np.ndarray, "rows features"], classes: Int[np.ndarray, " rows"], rate: float
    ) -> None:
        """Go once through rows in the order given."""
        seen = (numbers - self.network.center) / self.network.spread
        kept = self.rng.random(seen.shape, dtype=np.float32) >= self.dropped
        seen *= kept / np.float32(np.sqrt(1 - self.dropped))
        for low in range(0, len(seen), _BATCH):
            self._step(self._slope(seen[low : low + _BATCH], classes[low : low + _BATCH]), rate)

    def _slope(self, seen: np.ndarray, classes: np.ndarray) -> list[np.ndarray]:
        first, first_offset, second, second_offset = self.network.layers
        hidden = np.maximum(seen @ first + first_offset, 0)
        error = _softmax(hidden @ second + second_offset)
        error[np.arange(len(classes)), classes] -= 1
        error /= len(classes)
        back = (error @ second.T) * (hidden > 0)
        decay = DECAY / len(classes)
        return [
            seen.T @ back + decay * first,
            back.sum(axis=0),
            hidden.T @ error + decay * second,
            error.sum(axis=0),
        ]

    def _step(self, slope: Iterable[np.ndarray], rate: float) -> None:
        self.steps += 1
        rate *= float(np.sqrt(1 - 0.999**self.steps) / (1 - 0.9**self.steps))
        for i, one in enumerate(slope):
            self._mean[i] += 0.1 * (one - self._mean[i])
            self._square[i] += 0.001 * (one * one - self._square[i])
            self.network.layers[i] -= rate * self._mean[i] / (np.sqrt(self._square[i]) + 1e-8)


def _softmax(scores: Float[np.ndarray, "rows classes"]) -> Float[np.ndarray, "rows classes"]:
    raised = np.exp(scores - scores.max(axis=1, keepdims=True))
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))
