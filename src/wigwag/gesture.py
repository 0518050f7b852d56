"""What a person did, as far as the recogniser can tell: ``Gesture``."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.errors import InputError


@dataclass(frozen=True, slots=True)
class Gesture:
    """A decision about one movement. ``label=None`` is the null gesture: unsure, so no command.

    Raises:
        InputError: If the confidence is not within 0 to 1.
    """

    label: str | None
    """The gesture's name, or ``None`` when unsure or when the movement is no gesture."""
    confidence: float
    """0 to 1."""
    onset_ns: int = 0
    """When the movement began, monotonic nanoseconds."""
    end_ns: int = 0
    """When the movement ended."""
    decided_ns: int = 0
    """When the decision fell."""
    reason: str = ""
    """Why: the nearest examples, or why there is no label. For people to read."""

    def __post_init__(self) -> None:
        """Check the confidence."""
        if not 0.0 <= self.confidence <= 1.0:
            raise InputError(f"Gesture.confidence must be within 0 to 1, but got {self.confidence}.")
