"""Models that learn on: gestures are added, renamed and taken away, whatever kind of model it is."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Sequence
from os import PathLike
from typing import Self

import numpy as np

from wigwag.errors import InputError
from wigwag.recognise import KernelRecognizer
from wigwag.recognise.similarity import Similarities
from wigwag.skeleton import Clip
from wigwag.stream.gesture_stream import StreamModel
from wigwag.teach.advice import Near

COPIES = 12
LEEWAY, LEEWAY_WITHOUT_BACKGROUND = 6.0, 2.0
"""How a recogniser of clips takes in a gesture that one person has shown a few times: varied copies of each
example, and how far below the threshold its log odds may lie; less where no movement that is no gesture was
taught, so that walking may look like a raised knee. See docs/teaching.md for what was measured."""


class Student(ABC):
    """A model, and all it needs to learn on. It changes in place; ``save`` writes it so that it can fly."""

    @property
    @abstractmethod
    def model(self) -> StreamModel | KernelRecognizer:
        """What decides."""

    @property
    @abstractmethod
    def known(self) -> tuple[str, ...]:
        """Every gesture that it tells from others by name."""

    @property
    @abstractmethod
    def spoken(self) -> tuple[str, ...]:
        """Those that it may answer with."""

    @abstractmethod
    def examples(self) -> list[tuple[str, str]]:
        """Return label and name of each example that movements are compared with."""

    @abstractmethod
    def enrol(self, label: str, clips: Sequence[Clip]) -> Self:
        """Add a gesture, or more examples of one.

        Args:
            label: Its name.
            clips: One example or more; their own labels are not looked at.

        Raises:
            InputError: If there is no clip or no name.
        """

    @abstractmethod
    def forget(self, label: str) -> Self:
        """Take a gesture away.

        Raises:
            InputError: If there is none of that name, or no other.
        """

    @abstractmethod
    def rename(self, label: str, name: str) -> Self:
        """Give a gesture another name.

        Raises:
            InputError: If there is no such gesture, or one of the other name already.
        """

    @abstractmethod
    def save(self, path: str | PathLike[str]) -> None:
        """Write it to one file; an old one is replaced in one step."""

    @abstractmethod
    def copy(self) -> Self:
        """Return one that learns on by itself."""

    @abstractmethod
    def _parts(self) -> tuple[Similarities, np.ndarray, np.ndarray]:
        """Return the comparison, which of ``known`` each reference shows, and each one's usual distance."""

    def counts(self) -> dict[str, int]:
        """Return how many examples each gesture has."""
        found = Counter(label for label, _ in self.examples())
        return {label: found[label] for label in self.known}

    def nearest(self, clip: Clip) -> list[Near]:
        """Return the nearest example of each gesture, the nearest gesture first."""
        similar, numbers, typical = self._parts()
        relative = similar.relative(similar.distances(similar.sides(clip))).sum(axis=1)
        names = [name for _, name in self.examples()]
        kept = np.flatnonzero(numbers >= 0)
        found = []
        for number, label in enumerate(self.known):
            mine = kept[numbers[kept] == number]
            if len(mine):
                best = mine[relative[mine].argmin()]
                times = float(relative[best] / typical[number])
                found.append(Near(label, times, names[int(np.searchsorted(kept, best))]))
        return sorted(found, key=lambda near: near.times)

    def neighbours(self, label: str) -> list[Near]:
        """Return how near the nearest example of each other gesture is to a gesture's own examples.

        Raises:
            InputError: If there is no gesture of that name.
        """
        self._check_known(label)
        similar, numbers, typical = self._parts()
        kept = np.flatnonzero(numbers >= 0)
        names, own = [name for _, name in self.examples()], self.known.index(label)
        mine = [similar.references[int(i)] for i in np.flatnonzero(numbers == own)]
        relative = np.stack([similar.relative(similar.distances(side)).sum(axis=1) for side in mine])
        found = []
        for number, other in enumerate(self.known):
            theirs = kept[numbers[kept] == number]
            if number != own and len(theirs):
                best = theirs[relative[:, theirs].min(axis=0).argmin()]
                times = float(relative[:, best].min() / typical[own])
                found.append(Near(other, times, names[int(np.searchsorted(kept, best))]))
        return sorted(found, key=lambda near: near.times)

    def apart(self, clip: Clip, others: Sequence[Clip]) -> float:
        """Return how far the nearest of some clips is, in times the usual distance within a gesture."""
        similar, _, typical = self._parts()
        among = Similarities.comparing(similar, [similar.sides(other) for other in others])
        relative = similar.relative(among.distances(similar.sides(clip))).sum(axis=1)
        return float(relative.min() / np.median(typical))

    def _check_known(self, label: str) -> None:
        if label not in self.known:
            raise InputError(
                f"There is no gesture {label!r}. Known gestures: {', '.join(sorted(self.known))}."
            )

    def _check_name(self, label: str, name: str) -> None:
        self._check_known(label)
        if not name.strip():
            raise InputError("A gesture needs a name.")
        if name in self.known:
            raise InputError(f"There is a gesture {name!r} already; remove it first, or choose another name.")


class KernelStudent(Student):
    """A recogniser of clips, which learns on at once.

    Args:
        recogniser: Fitted or loaded.
    """

    def __init__(self, recogniser: KernelRecognizer) -> None:
        self._recogniser = recogniser

    @property
    def model(self) -> KernelRecognizer:
        """What decides."""
        return self._recogniser

    @property
    def known(self) -> tuple[str, ...]:
        """Every gesture."""
        return tuple(str(label) for label in self._recogniser.classes_)

    @property
    def spoken(self) -> tuple[str, ...]:
        """Every gesture."""
        return self.known

    def examples(self) -> list[tuple[str, str]]:
        """Return label and name of each example."""
        model, known = self._recogniser, self.known
        pairs = zip(model.numbers_, model.names_, strict=True)
        return [(known[number], name) for number, name in pairs if number >= 0]

    def enrol(self, label: str, clips: Sequence[Clip]) -> Self:
        """Add a gesture or examples; see :class:`Student`."""
        background = self._recogniser.doubt_.taught_background
        leeway = LEEWAY if background else LEEWAY_WITHOUT_BACKGROUND
        self._recogniser.enrol(label, clips, copies=COPIES, leeway=leeway)
        return self

    def forget(self, label: str) -> Self:
        """Take a gesture away; see :class:`Student`."""
        self._recogniser.forget(label)
        return self

    def rename(self, label: str, name: str) -> Self:
        """Give a gesture another name; see :class:`Student`."""
        self._check_name(label, name)
        self._recogniser.classes_ = np.array([name if known == label else known for known in self.known])
        return self

    def save(self, path: str | PathLike[str]) -> None:
        """Write it to one file."""
        self._recogniser.save(path)

    def copy(self) -> Self:
        """Return one that learns on by itself."""
        self._recogniser.ready_to_learn()
        return type(self)(copy.deepcopy(self._recogniser))

    def _parts(self) -> tuple[Similarities, np.ndarray, np.ndarray]:
        model = self._recogniser
        return model.similarities, model.numbers_, model.doubt_.typical


__all__ = ["COPIES", "LEEWAY", "LEEWAY_WITHOUT_BACKGROUND", "KernelStudent", "Student"]
