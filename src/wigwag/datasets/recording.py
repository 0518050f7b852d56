"""A stream of one person's poses and what is known to happen in it, for sets that are not cut into clips."""

from __future__ import annotations

from dataclasses import dataclass, field

from wigwag.errors import InputError
from wigwag.skeleton import Clip


@dataclass(frozen=True, slots=True)
class Mark:
    """One movement in a stream.

    Raises:
        InputError: If it ends before it begins.
    """

    label: str
    """What is shown."""
    onset_ns: int
    """When it begins, in the stream's own time."""
    end_ns: int
    """When it ends; the same as ``onset_ns`` for an action point, which is a moment."""
    point_ns: int | None = None
    """The moment at which it is clear what is shown, where somebody marked it."""

    def __post_init__(self) -> None:
        """Check the order."""
        if self.end_ns < self.onset_ns:
            raise InputError(
                f"Mark {self.label!r} must not end before it begins, but ends "
                f"{self.onset_ns - self.end_ns} ns earlier."
            )

    @property
    def duration_s(self) -> float:
        """Seconds."""
        return (self.end_ns - self.onset_ns) * 1e-9


@dataclass(frozen=True, slots=True)
class Recording:
    """A stream and its truth."""

    stream: Clip
    """All poses of one recording; no label. Stamps may have holes: nobody was seen then."""
    marks: tuple[Mark, ...] = ()
    """Gestures, in the order in which they begin."""
    scenes: tuple[Mark, ...] = ()
    """What else is shown, such as ``"utkinect:carry"``: no gesture, but it is good to know what was."""

    @property
    def hours(self) -> float:
        """Length of the stream."""
        return self.stream.duration_s / 3600


@dataclass(frozen=True, slots=True)
class Recordings:
    """The readable part of a set of streams. One bad file never hides the others."""

    recordings: list[Recording]
    """In the data set's natural order."""
    left_out: list[tuple[str, str]] = field(default_factory=list)
    """``(recording, reason)`` of what is missing or cannot be read, and of marks that make no sense."""
    repaired: list[tuple[str, str]] = field(default_factory=list)
    """``(recording, what was done)`` of each that is not as it was recorded."""

    @property
    def clips(self) -> list[Clip]:
        """The streams alone."""
        return [recording.stream for recording in self.recordings]

    def __len__(self) -> int:
        return len(self.recordings)


__all__ = ["Mark", "Recording", "Recordings"]
