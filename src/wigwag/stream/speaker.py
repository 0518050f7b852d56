"""When a gesture is spoken: once, as soon as it is sure enough, and never twice for one movement."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.stream.config import StreamConfig

_OVER = 0.8
"""Nothing may begin before this share of a spoken gesture has passed."""


@dataclass(frozen=True, slots=True)
class Look:
    """What came of one hypothesis."""

    label: str
    """What it is most like."""
    probability: float
    """That it is that, and began there."""
    progress: float
    """How much of the gesture seems to have passed, 1 at its end."""
    onset_ns: int
    now_ns: int
    resting: bool
    far: bool
    """The nearest enrolled example is farther than it has ever been when the label was right."""
    account: str
    """Why, for people to read."""

    @property
    def end_ns(self) -> int:
        """When the gesture ends, or is expected to."""
        share = min(max(self.progress, 0.3), 1.0)
        return self.onset_ns + round((self.now_ns - self.onset_ns) / share)


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Least probabilities."""

    going_on: float
    """While the movement goes on."""
    at_rest: float
    """When the body has come to rest."""


class Speaker:
    """Hears what every hypothesis looks like and says which one is a gesture.

    Args:
        config: What may be spoken, and how early.
        thresholds: How sure to be.
    """

    def __init__(self, config: StreamConfig, thresholds: Thresholds) -> None:
        self.config, self.thresholds = config, thresholds
        self.blocked_ns = -(1 << 62)
        """Nothing that began before this moment is listened to."""

    def hear(self, look: Look) -> bool:
        """Take in a look; return whether it is spoken."""
        if look.onset_ns < self.blocked_ns or look.far:
            return False
        early = not look.resting and look.progress < self.config.least_progress
        least = self.thresholds.at_rest if look.resting else self.thresholds.going_on
        if early or look.probability < least:
            return False
        over = _OVER * (look.end_ns - look.onset_ns)
        self.blocked_ns = look.onset_ns + max(round(over), 500_000_000)
        return True

    def may(self, label: str) -> bool:
        """Say whether a label is a command."""
        return self.config.commands is None or label in self.config.commands
