"""When a gesture is spoken: once, as soon as it is sure enough, and never twice for one movement."""

from __future__ import annotations

from dataclasses import dataclass, replace

from wigwag.stream.config import StreamConfig

_OVER = 0.8
"""Nothing may begin before this share of a spoken gesture has passed."""

_WAITS = 0.5
"""What is sure, but of which only this much seems to have passed, waits for the body to come to rest: ..."""
_WAITS_S = 2.0
"""... for so long ..."""
_TIMES = 2
"""... and if it was seen so many times running."""

_USUAL = 0.75
"""The usual length weighs so much in the guess of a gesture's own."""


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
    usual_s: float | None = None
    """How long whoever taught the gesture takes for it, in the middle; ``None``: not known."""

    @property
    def end_ns(self) -> int:
        """When the gesture ends, or is expected to."""
        return self.onset_ns + round((self.now_ns - self.onset_ns) / self._share)

    @property
    def span_ns(self) -> tuple[int, int]:
        """The best guess of when the gesture begins and ends.

        Where a movement begins slowly its beginning is seen late, and then too much of it seems to have
        passed in too short a time. How long the gesture usually takes is the better part of its length;
        how much has passed says where that lies; and the beginning is halfway to where it was seen.
        """
        if self.usual_s is None or self.now_ns <= self.onset_ns:
            return self.onset_ns, self.end_ns
        length_ns = (self.end_ns - self.onset_ns) ** (1 - _USUAL) * (self.usual_s * 1e9) ** _USUAL
        end_ns = self.now_ns + round((1 - self._share) * length_ns)
        return (self.onset_ns + end_ns - round(length_ns)) // 2, end_ns

    @property
    def _share(self) -> float:
        return min(max(self.progress, 0.3), 1.0)


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
        self._waiting: Look | None = None
        self._times = 0

    def hear(self, look: Look) -> Look | None:
        """Take in a look; return what is spoken: it, or one that was sure before and waited for the end.

        How much of a gesture has passed is a guess, and too low where somebody shows it slower or larger
        than those who taught it: what was sure more than once while it went on is spoken when the body has
        come to rest, though it never seemed to have passed far enough.
        """
        if self._speaks(look):
            return self._spoken(look)
        self._remember(look)
        if not look.resting or self._waiting is None or self._times < _TIMES:
            return None
        # A rest may be a pause in the middle: where the gesture ends, the look that waits knows better.
        waiting = self._waiting
        self._spoken(replace(waiting, now_ns=look.now_ns, progress=1.0))
        return waiting

    def _speaks(self, look: Look) -> bool:
        if not self._listens(look):
            return False
        early = not look.resting and look.progress < self.config.least_progress
        least = self.thresholds.at_rest if look.resting else self.thresholds.going_on
        return not early and look.probability >= least

    def _listens(self, look: Look) -> bool:
        return self.may(look.label) and look.onset_ns >= self.blocked_ns and not look.far

    def _spoken(self, look: Look) -> Look:
        self._waiting, self._times = None, 0
        over = _OVER * (look.end_ns - look.onset_ns)
        self.blocked_ns = look.onset_ns + max(round(over), 500_000_000)
        return look

    def _remember(self, look: Look) -> None:
        waiting = self._waiting
        if waiting is not None and (look.now_ns - waiting.now_ns) * 1e-9 > _WAITS_S:
            self._waiting, self._times = None, 0
        sure = look.probability >= self.thresholds.going_on and look.progress >= _WAITS
        if not look.resting and sure and self._listens(look):
            same = self._waiting is not None and self._waiting.label == look.label
            self._times = self._times + 1 if same else 1
            self._waiting = look

    def may(self, label: str) -> bool:
        """Say whether a label is a command."""
        return self.config.commands is None or label in self.config.commands
