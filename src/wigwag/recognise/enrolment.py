"""How a recogniser of clips learns on, forgets, and is kept: what its weights came from, and their growth."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Self

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import InputError, NotFittedError
from wigwag.features import Classifier
from wigwag.features.augment import Augmentation
from wigwag.recognise import store
from wigwag.recognise.doubt import Doubt, targets_of
from wigwag.recognise.examples import check_clips
from wigwag.recognise.ridge import EmpiricalMapRidge
from wigwag.recognise.similarity import Sides, Similarities
from wigwag.skeleton import Clip


class Enrolling(Classifier, ABC):
    """What was learned from examples, as it grows and shrinks gesture by gesture, in memory and in a file.

    Every example is a reference that movements are compared with; examples and varied copies of them are the
    rows that a linear map is learned from. A child says how the first are learned from, and how it decides.

    Attributes:
        classes_: The gestures.
        numbers_, names_: Which gesture each example shows, and what it is called.
        doubt_: How sure to be.
        accept_threshold_: The log odds below which nothing is said.
        leeway_: How far below that each gesture may lie; 0 but for what was enrolled so.
        ridge_, width_, copies_: The penalty, the width of the kernels, the number of copies.
        apart_: Whether each view decides by itself.
    """

    random_state: int
    false_reject: float
    classes_: np.ndarray
    numbers_: Int[np.ndarray, " clips"]
    names_: list[str]
    doubt_: Doubt
    accept_threshold_: float
    leeway_: Float[np.ndarray, " classes"]
    ridge_: float
    width_: float
    copies_: int
    apart_: bool
    _similar: Similarities
    _ridge: EmpiricalMapRidge
    _penalised: int
    _rows: list[Sides]
    _row_numbers: Int[np.ndarray, " rows"]
    _examples: Similarities
    _rows_in: Path
    _weights: Float[np.ndarray, "features classes+1"]
    _weights_apart: Float[np.ndarray, "features classes+1"]

    @abstractmethod
    def _similarities(self) -> Similarities:
        """Return a comparison by the settings, with no references yet."""

    def _varied(self, clips: Sequence[Clip], rng: np.random.Generator) -> list[Sides]:
        augmentation = Augmentation()
        return [self._similar.sides(augmentation.apply(clip, rng)) for clip in clips]

    def _take_weights(self) -> None:
        self._weights_apart = self._ridge.weights_apart.astype(np.float32)
        self._weights = self._weights_apart if self.apart_ else self._ridge.weights.astype(np.float32)

    def _check_fitted(self) -> None:
        if not hasattr(self, "_weights"):
            raise NotFittedError(
                f"{type(self).__name__} is not fitted yet; call fit with clips, or "
                f"{type(self).__name__}.load a model."
            )

    # -- learn and forget ---------------------------------------------------------------------------------

    def enrol(
        self, label: str, clips: Sequence[Clip], *, copies: int | None = None, leeway: float = 0.0
    ) -> Self:
        """Add a gesture, or more examples of one that is known, without learning everything anew.

        The examples become references, and teach together with varied copies of them. How sure to be
        stays as it was learned, less ``leeway``.

        Args:
            label: Name of the gesture.
            clips: One example or more; their own labels are not looked at.
            copies: Varied copies of each example; ``None``: as many as ``fit`` made.
            leeway: How far below the threshold the log odds of a gesture that is new may lie: one that one
                person has shown a few times never looks as sure as those that many have.

        Raises:
            InputError: If there is no clip or the label is empty.
            ModelError: If the file this was loaded from is gone or has been replaced.
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        check_clips(clips)
        if len(clips) == 0:
            raise InputError(f"enrol needs at least one clip of {label!r}, but got an empty list.")
        if not isinstance(label, str) or not label:
            raise InputError(f"enrol needs a gesture's name, but got {label!r}.")
        self.ready_to_learn()
        sides = [self._similar.sides(clip) for clip in clips]  # what can go wrong comes before any change
        rng = np.random.default_rng([self.random_state, len(self._rows)])
        wanted = max(self.copies_, 1) if copies is None else copies
        rows = sides + [s for _ in range(wanted) for s in self._varied(clips, rng)]
        if label not in self.classes_:
            self.classes_ = np.append(self.classes_, label)
            self.leeway_ = np.append(self.leeway_, leeway)
            self._ridge.add_target(len(self.classes_) - 1)
            self.doubt_.add_gesture()
        number = int(np.flatnonzero(self.classes_ == label)[0])
        self._ridge.add_features(self._columns(sides))
        self._similar.add(sides)
        self.numbers_ = np.append(self.numbers_, [number] * len(clips))
        self.names_ += [clip.name for clip in clips]
        distances = np.stack([self._similar.distances(s) for s in rows])
        numbers = np.full(len(rows), number)
        self._ridge.add_examples(self._similar.features(distances), targets_of(numbers, len(self.classes_)))
        self._examples.add(rows)
        self._rows, self._row_numbers = self._rows + rows, np.append(self._row_numbers, numbers)
        self._take_weights()
        return self

    def forget(self, label: str) -> Self:
        """Take a gesture away, with all its examples.

        Raises:
            InputError: If there is no such gesture, or it is the only one.
            ModelError: If the file this was loaded from is gone or has been replaced.
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        if label not in self.classes_:
            raise InputError(
                f"There is no gesture {label!r} to forget. Known gestures: {', '.join(self.classes_)}."
            )
        if len(self.classes_) == 1:
            raise InputError(f"{label!r} is the only gesture; a recogniser without any is none.")
        self.ready_to_learn()
        number = int(np.flatnonzero(self.classes_ == label)[0])
        kept, kept_rows = self.numbers_ != number, self._row_numbers != number
        self._ridge.keep(kept_rows, np.repeat(kept, len(self._similar.kinds)), number)
        self._similar.refer_to([s for s, keep in zip(self._similar.references, kept, strict=True) if keep])
        self._rows = [s for s, keep in zip(self._rows, kept_rows, strict=True) if keep]
        self._examples = Similarities.comparing(self._similar, self._rows)
        self.names_ = [name for name, keep in zip(self.names_, kept, strict=True) if keep]
        self.classes_ = np.delete(self.classes_, number)
        self.leeway_ = np.delete(self.leeway_, number)
        self.doubt_.forget_gesture(number)
        self.numbers_ = _renumbered(self.numbers_[kept], number)
        self._row_numbers = _renumbered(self._row_numbers[kept_rows], number)
        self._take_weights()
        return self

    def _columns(self, references: Sequence[Sides]) -> Float[np.ndarray, "examples new"]:
        """Return the similarities of all examples so far to new references: DTW is symmetric."""
        distances = np.stack([self._examples.distances(sides) for sides in references], axis=1)
        return self._similar.features(distances)

    def ready_to_learn(self) -> None:
        """Take back what the weights came from, which a loaded recogniser does not know: a second or two.

        The first change does this by itself; call it before copying a recogniser that each copy will change.

        Raises:
            ModelError: If the file this was loaded from is gone or has been replaced.
        """
        self._recall()
        if not hasattr(self, "_examples"):
            self._examples = Similarities.comparing(self._similar, self._rows)
        if not hasattr(self, "_ridge"):
            features = self._similar.features(np.stack([self._similar.distances(s) for s in self._rows]))
            self._ridge = EmpiricalMapRidge(self.ridge_, len(self._similar.kinds)).fit(
                features, targets_of(self._row_numbers, len(self.classes_)), self._penalised
            )

    def _recall(self) -> None:
        """Read the examples of a loaded recogniser, which deciding does not need."""
        if hasattr(self, "_rows"):
            return
        _, arrays = store.read(self._rows_in, type(self).__name__)
        with store.explained(self._rows_in):
            if not np.array_equal(arrays["weights"], self._weights):
                raise InputError("it has been replaced since it was loaded; load it again")
            self._rows = self._similar.unstacked("rows", arrays)

    # -- keep ---------------------------------------------------------------------------------------------

    def save(self, path: str | PathLike[str]) -> None:
        """Write the fitted recogniser to one file of arrays and JSON; an old file is replaced at once.

        Raises:
            ModelError: If the file this was loaded from is gone or has been replaced.
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        self._recall()
        facts: dict[str, Any] = {
            "parameters": store.plain(self.get_params(deep=False)),
            "classes": [str(label) for label in self.classes_],
            "names": self.names_,
            "doubt": self.doubt_.facts(),
            "accept_threshold": self.accept_threshold_,
            "leeway": self.leeway_.tolist(),
            "width": self.width_,
            "ridge": self.ridge_,
            "copies": self.copies_,
            "apart": self.apart_,
            "penalised": self._penalised,
        }
        arrays = {
            "numbers": self.numbers_, "row_numbers": self._row_numbers,
            "weights": self._weights, "weights_apart": self._weights_apart,
        }  # fmt: skip
        arrays |= self._similar.arrays() | self._similar.stacked("rows", self._rows)
        store.write(path, type(self).__name__, facts, arrays)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a recogniser that ``save`` wrote; it decides what the saved one did.

        What was learned from stays in the file: the first ``enrol``, ``forget`` or ``save`` after loading
        reads it again, and takes longer than later ones.

        Raises:
            ModelError: If the file is missing, damaged, of another version, or holds something else.
        """
        facts, arrays = store.read(path, cls.__name__, leave="rows_")
        with store.explained(path):
            self = cls(**store.revived(facts["parameters"]))
            self.classes_, self.names_ = np.array(facts["classes"]), list(facts["names"])
            self.numbers_, self._row_numbers = arrays["numbers"], arrays["row_numbers"]
            self._weights, self._weights_apart = arrays["weights"], arrays["weights_apart"]
            self.doubt_ = Doubt(self.false_reject).restore(facts["doubt"])
            self.accept_threshold_ = float(facts["accept_threshold"])
            self.leeway_ = np.array(facts.get("leeway", [0.0] * len(self.classes_)))
            self._penalised = int(facts["penalised"])
            self.width_, self.ridge_ = float(facts["width"]), float(facts["ridge"])
            self.copies_, self.apart_ = int(facts["copies"]), bool(facts["apart"])
            self._rows_in = Path(path).resolve()
            self._similar = self._similarities()
            self._similar.width = self.width_
            self._similar.restore(arrays)
        return self


def _renumbered(numbers: Int[np.ndarray, " some"], gone: int) -> Int[np.ndarray, " some"]:
    return np.asarray(np.where(numbers > gone, numbers - 1, numbers))


__all__ = ["Enrolling"]
