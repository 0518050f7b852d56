"""What is truly shown in a stream, and what that makes of each stretch that is looked at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wigwag.errors import InputError
from wigwag.skeleton import Clip
from wigwag.stream.watcher import Hypothesis

ONSET = 0.25
"""A stretch begins with a gesture if it begins within this share of the gesture's length from its onset."""

_DOUBTFUL_ONSET = 0.35
_DOUBTFUL = 0.15
"""Less than this share of a gesture is nothing; from here to ``ENOUGH`` it is neither here nor there."""

ENOUGH = 0.35
"""Share of a gesture that it may be recognised by."""

TOO_MUCH = 1.25
"""A stretch longer than this share of a gesture holds more than it."""


@dataclass(frozen=True, slots=True)
class Showing:
    """One gesture in a stream.

    Raises:
        InputError: If it ends before it begins.
    """

    label: str
    onset_ns: int
    end_ns: int
    """The same as the onset for an action point: the moment at which the gesture is to be recognised. Such
    are taught by :func:`~wigwag.stream.teach_moments.teach_moments`."""

    def __post_init__(self) -> None:
        """Check the order."""
        if self.end_ns < self.onset_ns:
            raise InputError(
                f"Showing {self.label!r} must not end before it begins, but ends "
                f"{self.onset_ns - self.end_ns} ns earlier."
            )

    @property
    def is_point(self) -> bool:
        """Whether only a moment is known."""
        return self.onset_ns == self.end_ns


@dataclass(frozen=True, slots=True)
class LabelledStream:
    """A stream of one person's poses, and the gestures in it; without any, it is background."""

    stream: Clip
    """With ``subject`` set: how sure to be is learned by leaving people out."""
    showings: tuple[Showing, ...] = ()
    deliberate: bool = False
    """Whoever is seen gestures on purpose all the time, and commands nothing: nobody moves so by the way. A
    false command said of it is as wrong as any, but does not count as one on everyday movement."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """What one stretch truly is."""

    showing: int | None
    """Number of the gesture that begins with it and has passed far enough; ``None``: none."""
    progress: float
    doubtful: bool
    """Neither clearly a gesture nor clearly none: not learned from."""


def meaning(hypothesis: Hypothesis, showings: Sequence[Showing]) -> Meaning:
    """Say what a stretch truly is.

    Args:
        hypothesis: The stretch.
        showings: The gestures of its stream, or those that are near.
    """
    best, nearest, share = None, np.inf, 0.0
    for number, showing in enumerate(showings):
        length = max(showing.end_ns - showing.onset_ns, 1)
        away = abs(hypothesis.onset_ns - showing.onset_ns) / length
        if away < nearest:
            best, nearest = number, away
            share = (hypothesis.now_ns - hypothesis.onset_ns) / length
    if best is None or nearest >= _DOUBTFUL_ONSET or not _DOUBTFUL < share <= TOO_MUCH:
        return Meaning(None, 0.0, doubtful=False)
    if nearest >= ONSET or share < ENOUGH:
        return Meaning(None, 0.0, doubtful=True)
    return Meaning(best, share, doubtful=False)
