"""What can be set about turning a stream into gestures."""

from __future__ import annotations

from dataclasses import dataclass, field

from wigwag.errors import InputError
from wigwag.stream.watcher import WatchConfig


@dataclass(frozen=True, slots=True)
class StreamConfig:
    """How a stream becomes gestures.

    Raises:
        InputError: If a setting is out of range.
    """

    commands: tuple[str, ...] | None = None
    """Labels that may be spoken. Others that are taught are known by name, which tells them from commands,
    and come out as gestures without a label. ``None``: all may be spoken."""
    earliness: float = 0.6
    """0: a gesture is decided when it seems to be over; 1: as soon as half of it seems to have passed. The
    earlier, the more errors."""
    false_per_hour: float = 1.0
    """False commands an hour that are allowed on people who took no part in teaching, as far as they are
    not said of another gesture; the thresholds are the best ones that keep to it."""
    watch: WatchConfig = field(default_factory=WatchConfig)

    def __post_init__(self) -> None:
        """Check the settings."""
        if not 0 <= self.earliness <= 1:
            raise InputError(
                f"StreamConfig.earliness must be within 0 and 1, but got {self.earliness}; 0 decides at the "
                "end of a gesture, 1 in its middle."
            )
        if not self.false_per_hour >= 0:
            raise InputError(f"StreamConfig.false_per_hour must be 0 or more, but got {self.false_per_hour}.")

    @property
    def least_progress(self) -> float:
        """Share of a gesture that must seem to have passed before it is decided."""
        return 1.0 - 0.5 * self.earliness
