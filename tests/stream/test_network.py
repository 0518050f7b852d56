"""The small network: its slopes are right, it learns, and it comes back from arrays as it was."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.stream import network as module
from wigwag.stream.network import Network, Teacher


def ring(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Points inside and outside of a ring, which no line parts; each coordinate eight times, with noise."""
    rng = np.random.default_rng(seed)
    places = rng.normal(0, 2, (count, 2))
    numbers = np.tile(places, 8) + rng.normal(0, 0.1, (count, 16))
    return numbers.astype(np.float32), (np.hypot(*places.T) > 2.4).astype(int)


def test_what_no_line_parts_is_learned() -> None:
    numbers, classes = ring(4000, 0)
    network = Network(16, 2, np.random.default_rng(0))
    network.standardise(numbers)
    teacher = Teacher(network, np.random.default_rng(1))
    for _ in range(40):
        teacher.learn(numbers, classes, 5e-3)
    other, truth = ring(1000, 1)
    assert (network.probabilities(other).argmax(axis=1) == truth).mean() > 0.8
    np.testing.assert_allclose(network.probabilities(other).sum(axis=1), 1.0, rtol=1e-5)


def test_slopes_are_those_of_the_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "DECAY", 0.0)
    numbers, classes = ring(32, 2)
    network = Network(16, 2, np.random.default_rng(0))
    network.layers = [layer.astype(np.float64) for layer in network.layers]
    teacher = Teacher(network, np.random.default_rng(1))
    slopes = teacher._slope(numbers.astype(np.float64), classes)

    def loss() -> float:
        first, first_offset, second, second_offset = network.layers
        scores = np.maximum(numbers @ first + first_offset, 0) @ second + second_offset
        scores = scores - scores.max(axis=1, keepdims=True)
        return float((np.log(np.exp(scores).sum(axis=1)) - scores[np.arange(32), classes]).mean())

    for layer, slope in zip(network.layers, slopes, strict=True):
        place = np.unravel_index(int(np.abs(slope).argmax()), layer.shape)
        was, step = layer[place], 1e-5
        layer[place] = was + step
        above = loss()
        layer[place] = was - step
        below = loss()
        layer[place] = was
        assert (above - below) / (2 * step) == pytest.approx(slope[place], rel=1e-3)


def test_a_class_that_is_rarer_than_taught() -> None:
    network = Network(16, 3, np.random.default_rng(0))
    numbers = ring(5, 0)[0]
    before = network.probabilities(numbers)
    network.rarer(2, 4.0)
    weighed = before * [1.0, 1.0, 4.0]
    np.testing.assert_allclose(
        network.probabilities(numbers), weighed / weighed.sum(axis=1, keepdims=True), rtol=1e-5
    )


def test_it_comes_back_as_it_was() -> None:
    network = Network(16, 3, np.random.default_rng(0))
    numbers = ring(9, 0)[0]
    network.standardise(numbers)
    again = Network.restored(network.arrays("one"), "one")
    np.testing.assert_array_equal(again.probabilities(numbers), network.probabilities(numbers))
