"""Cases judged one by one, perhaps more than once, and the figures that they add up to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.evaluate.metrics import people_interval, wilson_interval
from wigwag.skeleton import Clip


def bare(clips: Iterable[Clip]) -> list[Clip]:
    """Return the clips without label, person and name: nothing for a recogniser to peek at."""
    return [Clip(clip.joints, clip.stamps_ns, name="case") for clip in clips]


@dataclass(slots=True)
class Cases:
    """Which clips were decided rightly, over all runs in which they were judged."""

    right: dict[str, list[bool]] = field(default_factory=dict)
    """By the clip's name, one entry a run."""
    people: dict[str, str] = field(default_factory=dict)
    """Whose clip it is."""

    def add(self, clips: Sequence[Clip], decided: Iterable[str]) -> None:
        """Judge decisions about labelled clips."""
        for clip, label in zip(clips, decided, strict=True):
            self.right.setdefault(clip.name, []).append(str(label) == clip.label)
            self.people[clip.name] = str(clip.subject)

    def by_case(self) -> tuple[Float[np.ndarray, " cases"], list[str]]:
        """Return for each clip the share of runs in which it is right, and whose it is.

        Raises:
            InputError: If nothing was judged.
        """
        if not self.right:
            raise InputError("Nothing was judged: there is no case.")
        return np.array([np.mean(r) for r in self.right.values()]), [self.people[n] for n in self.right]

    def figures(self, seed: int) -> dict[str, Any]:
        """Return accuracy over the cases, its deviation between people and its 95 % interval.

        The interval is a bootstrap of whole people; where no case at all is wrong, Wilson's score over the
        cases stands in, since the bootstrap would give an interval of no width.
        """
        right, people = self.by_case()
        names = np.array(people)
        spread = [right[names == name].mean() for name in np.unique(names)]
        if right.all() and right.min() == 1.0:
            method, interval = "Wilson", wilson_interval(len(right), len(right))
        else:
            method, interval = "bootstrap of people", people_interval(right, people, seed)
        return {
            "accuracy_mean": float(right.mean()),
            "accuracy_std": float(np.std(spread, ddof=1)) if len(spread) > 1 else 0.0,
            "accuracy_ci95": list(interval),
            "ci95_method": method,
            "people": len(spread),
            "cases": len(right),
        }


__all__ = ["Cases", "bare"]
