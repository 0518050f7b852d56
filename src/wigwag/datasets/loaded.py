"""What reading a data set gives: the clips, and what was left out or repaired and why."""

from __future__ import annotations

from dataclasses import dataclass, field

from wigwag.skeleton import Clip


@dataclass(frozen=True, slots=True)
class Loaded:
    """The readable part of a data set. One bad file never hides the others."""

    clips: list[Clip]
    """Every clip that could be read, in the data set's natural order."""
    left_out: list[tuple[str, str]] = field(default_factory=list)
    """``(file, reason)`` of each recording that is missing or could not be read."""
    repaired: list[tuple[str, str]] = field(default_factory=list)
    """``(file, what was done)`` of each recording that is among the clips, but not as it was recorded."""

    def __len__(self) -> int:
        return len(self.clips)
