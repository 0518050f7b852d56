"""How far apart the gestures of a recogniser lie, judged by its own examples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import InputError
from wigwag.recognise.kernel import KernelRecognizer
from wigwag.recognise.similarity import Similarities


@dataclass(frozen=True, slots=True)
class Separation:
    """Of each example, how far the nearest other one of each gesture is."""

    classes: tuple[str, ...]
    numbers: Int[np.ndarray, " examples"]
    """Which class each example shows."""
    names: tuple[str, ...]
    """What the examples are called."""
    nearest: Float[np.ndarray, "examples classes"]
    """DTW distance to the nearest other example of each class, in usual distances summed over the views;
    infinity where there is none to compare with."""
    neighbour: Int[np.ndarray, "examples classes"]
    """Which example that is."""

    def ratios(self, first: str, second: str) -> Float[np.ndarray, " examples"]:
        """Return for each example of two gestures how many times farther the other is than its own.

        Below 1: the nearest example is one of the other gesture. Empty where nothing can be compared.
        """
        one, two = self.classes.index(first), self.classes.index(second)
        sides = []
        for own, other in ((one, two), (two, one)):
            mine = self.nearest[self.numbers == own]
            known = np.isfinite(mine[:, own]) & np.isfinite(mine[:, other])
            sides.append(mine[known, other] / np.maximum(mine[known, own], 1e-9))
        return np.concatenate(sides)

    def closest(self, first: str, second: str) -> tuple[str, str]:
        """Return the example of each of two gestures that lie closest to each other, by name."""
        one, two = self.classes.index(first), self.classes.index(second)
        mine = np.flatnonzero(self.numbers == one)
        best = int(mine[np.argmin(self.nearest[mine, two])])
        return self.names[best], self.names[int(self.neighbour[best, two])]


def separation(recogniser: KernelRecognizer, people: Sequence[str | None] | None = None) -> Separation:
    """Compare every example of a recogniser's gestures with every other.

    Args:
        recogniser: Fitted or loaded; its examples of no gesture are left aside.
        people: Who shows each of its examples, in the order in which they were learned: those of other
            people alone are compared then. ``None``: all others.

    Raises:
        InputError: If there are not as many people as examples.
        NotFittedError: If it is not fitted.
    """
    similar = recogniser.similarities
    return separation_of(
        similar, recogniser.numbers_, recogniser.classes_.tolist(), recogniser.names_, people
    )


def separation_of(
    similar: Similarities,
    numbers: Int[np.ndarray, " examples"],
    classes: Sequence[str],
    names: Sequence[str],
    people: Sequence[str | None] | None = None,
) -> Separation:
    """Compare every reference with every other.

    Args:
        similar: With references.
        numbers: Which class each shows; below 0: none.
        classes: What the classes are called.
        names: What the references are called.
        people: As for :func:`separation`.

    Raises:
        InputError: If there are not as many people as references.
    """
    references = similar.references
    if people is not None and len(people) != len(references):
        raise InputError(
            f"Expected who shows each of {len(references)} examples, but got {len(people)} people."
        )
    distances = np.stack([similar.relative(similar.distances(s)).sum(axis=1) for s in references])
    distances = distances.astype(np.float64)
    np.fill_diagonal(distances, np.inf)
    if people is not None:
        known = np.array([f"example {i}" if person is None else person for i, person in enumerate(people)])
        distances[known[:, None] == known[None, :]] = np.inf
    kept = np.flatnonzero(numbers >= 0)
    shown = numbers[kept]
    among = distances[np.ix_(kept, kept)]
    nearest = np.full((len(kept), len(classes)), np.inf)
    neighbour = np.zeros((len(kept), len(classes)), dtype=np.int64)
    for number in range(len(classes)):
        columns = np.flatnonzero(shown == number)
        nearest[:, number] = among[:, columns].min(axis=1)
        neighbour[:, number] = columns[among[:, columns].argmin(axis=1)]
    return Separation(tuple(classes), shown, tuple(names[int(i)] for i in kept), nearest, neighbour)


__all__ = ["Separation", "separation", "separation_of"]
