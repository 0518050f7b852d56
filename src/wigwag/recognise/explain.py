"""Why a movement was called what it was called: its nearest examples, and what was nearly said instead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from wigwag.distances.path import dtw_path
from wigwag.gesture import Gesture
from wigwag.recognise.kernel import KernelRecognizer
from wigwag.recognise.similarity import Sides, Similarities
from wigwag.skeleton import N_LANDMARKS, Clip


@dataclass(frozen=True, slots=True)
class Example:
    """An enrolled example beside the movement."""

    label: str
    name: str
    times: float
    """Its distance over the usual one between two people who show this gesture."""
    by_view: Float[np.ndarray, " views"]
    """Its distance in each view, in units of the median distance between examples."""
    joints: Float[np.ndarray, "frames 13 3"]
    """As the recogniser keeps it: lengths of an arm, facing the camera; see ``Explanation.joints``."""
    path: Int[np.ndarray, "steps 2"]
    """Which frame of the movement DTW lays on which of the example, where the landmarks are compared."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """Everything that a decision came from, as plain values."""

    gesture: Gesture
    label: str
    """The gesture that the movement is most like, also if it was refused."""
    runner_up: str | None
    """The one that is second; ``None``: only one gesture is known."""
    sure: float
    """Probability that to act on it is right."""
    least: float
    """What it has to reach."""
    lead: float
    """How far its score is ahead of the runner-up's. The scores are about 1 for what is shown, -1 else."""
    over_nothing: float | None
    """How far it is ahead of 'no gesture'; ``None``: that was not taught."""
    views: tuple[str, ...]
    """Those that examples are compared in; then, where that was taught, the last moments by themselves."""
    pushes: Float[np.ndarray, " views"]
    """What each view gives to the lead; they add up to it. Below 0: it speaks for the runner-up."""
    telling: int | None
    """Without so many of the examples, those that tell most, the runner-up would have been ahead, all else
    alike. ``None``: it would not, whatever is left out."""
    examples: int
    """How many there are."""
    nearest: tuple[Example, ...]
    """The nearest two of the gesture itself, then the nearest of the runner-up."""
    joints: Float[np.ndarray, "frames 13 3"]
    """The movement as the recogniser compares it: stretched to a fixed number of frames, in arm's lengths,
    facing the camera, and on as few principal directions as the examples."""
    duration_s: float

    @property
    def answers(self) -> tuple[str, ...]:
        """What would have made it a different answer, in sentences."""
        said, label = [], _quoted(self.label)
        if self.gesture.label is not None:
            said.append(f"Refused, were more than {self.sure:.3f} asked for; it is {self.least:.3f}.")
        elif self.sure < self.least:
            said.append(f"{label}, were {self.sure:.3f} sure enough; {self.least:.3f} is asked for.")
        if self.over_nothing is not None:
            more = "No gesture" if self.over_nothing > 0 else label
            said.append(f"{more}, had that scored {abs(self.over_nothing):.2f} more.")
        if self.runner_up is not None:
            other = _quoted(self.runner_up)
            said.append(f"{other}, had that scored {self.lead:.2f} more.")
            if self.telling is not None:
                some = f"{self.telling} most telling" if self.telling > 1 else "most telling one"
                said.append(f"{other} too, without the {some} of {self.examples} examples.")
            against = [v for v, push in zip(self.views, self.pushes, strict=True) if push < 0]
            if against:
                said.append(f"These views alone spoke for {other}: {', '.join(against)}.")
        return tuple(said)


def _quoted(label: str) -> str:
    return f"\N{LEFT DOUBLE QUOTATION MARK}{label.replace('_', ' ')}\N{RIGHT DOUBLE QUOTATION MARK}"


@dataclass(frozen=True, slots=True)
class Taught:
    """The parts of a recogniser that its decisions come from."""

    similar: Similarities
    weights: Float[np.ndarray, "features targets"]
    """One target a gesture, then 'no gesture'."""
    numbers: Int[np.ndarray, " references"]
    """Which gesture each reference shows; below 0: none."""
    names: Sequence[str]
    labels: Sequence[str]
    typical: Float[np.ndarray, " gestures"]

    @classmethod
    def of(cls, recogniser: KernelRecognizer) -> Taught:
        """Return those of a recogniser of clips."""
        labels = [str(label) for label in recogniser.classes_]
        return cls(
            recogniser.similarities, recogniser.weights, recogniser.numbers_, recogniser.names_, labels,
            recogniser.doubt_.typical,
        )  # fmt: skip


LAST_MOMENTS = "last moments"
"""What says which gesture goes on without comparing examples; see :mod:`wigwag.stream.glance`."""


def explain(
    taught: Taught,
    clip: Clip,
    gesture: Gesture,
    least: float,
    moments: Float[np.ndarray, " gestures"] | None = None,
) -> Explanation:
    """Return what a decision about a clip came from.

    Args:
        taught: What decided.
        clip: What was judged.
        gesture: The decision.
        least: How sure it had to be.
        moments: What the last moments by themselves added to the score of each gesture, if anything.
    """
    similar, views = taught.similar, taught.similar.kinds
    sides = similar.sides(clip)
    distances = similar.distances(sides)
    relative = similar.relative(distances)
    features = similar.features(distances)
    scores = (features @ taught.weights).astype(np.float64)
    classes = len(taught.labels)
    together = scores[:classes] + (0.0 if moments is None else moments)
    order = np.argsort(-together, kind="stable")
    first, second = int(order[0]), int(order[1]) if classes > 1 else None
    difference = taught.weights[:, first] - (taught.weights[:, second] if second is not None else 0.0)
    shares = (features * difference).reshape(-1, len(views)).astype(np.float64)
    lead = float(together[first] - (together[second] if second is not None else 0.0))
    pushes = list(shares.sum(axis=0))
    if moments is not None:
        pushes.append(lead - sum(pushes))
    nearest = [_example(taught, sides, relative, i) for i in _nearest(taught, relative, first, 2)]
    if second is not None:
        nearest += [_example(taught, sides, relative, i) for i in _nearest(taught, relative, second, 1)]
    background = bool((taught.numbers < 0).any()) or taught.weights.shape[1] > classes + 1
    return Explanation(
        gesture, taught.labels[first], None if second is None else taught.labels[second],
        gesture.confidence, least, lead,
        float(scores[first] - scores[classes]) if background else None,
        (*views, *(() if moments is None else (LAST_MOMENTS,))), np.array(pushes),
        _telling(shares.sum(axis=1), lead), len(taught.numbers),
        tuple(nearest), _joints(similar, sides), similar.form.apply(clip).duration_s,
    )  # fmt: skip


def _nearest(taught: Taught, relative: np.ndarray, number: int, count: int) -> Int[np.ndarray, " some"]:
    own = np.flatnonzero(taught.numbers == number)
    return own[np.argsort(relative[own].sum(axis=1), kind="stable")[:count]]


def _example(taught: Taught, sides: Sides, relative: np.ndarray, index: int) -> Example:
    similar, number = taught.similar, int(taught.numbers[index])
    reference, at = similar.references[index], similar.kinds.index("positions")
    times = float(relative[index].sum() / taught.typical[number])
    _, path = dtw_path(sides[at], reference[at], similar.band)
    return Example(
        taught.labels[number], taught.names[index], times, np.asarray(relative[index], np.float64),
        _joints(similar, reference), path,
    )  # fmt: skip


def _joints(similar: Similarities, sides: Sides) -> Float[np.ndarray, "frames 13 3"]:
    """Return where the landmarks are, as far as the principal directions that are kept tell."""
    at = similar.kinds.index("positions")
    flat = sides[at] @ similar.bases[at].T + similar.means[at]
    return np.asarray(flat.reshape(len(flat), N_LANDMARKS, 3), dtype=np.float64)


def _telling(shares: Float[np.ndarray, " references"], lead: float) -> int | None:
    """Return how many of the examples, the most telling first, the lead needs."""
    left = lead - np.cumsum(np.sort(shares)[::-1])
    return int(np.argmax(left < 0)) + 1 if (left < 0).any() else None


__all__ = ["LAST_MOMENTS", "Example", "Explanation", "Taught", "explain"]
