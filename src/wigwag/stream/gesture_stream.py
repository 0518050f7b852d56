"""A stream of poses becomes gestures: ``GestureStream``."""

from __future__ import annotations

from dataclasses import dataclass, field

from wigwag.gesture import Gesture
from wigwag.skeleton import Pose
from wigwag.stream.spot import Recogniser, SpotConfig, Spotter


@dataclass(frozen=True, slots=True)
class StreamConfig:
    """How a stream becomes gestures."""

    commands: tuple[str, ...] | None = None
    """Labels that may be spoken; others are known by name and kept silent. ``None``: all."""
    spot: SpotConfig = field(default_factory=SpotConfig)


class GestureStream:
    """Finds gestures in a stream of poses, each once.

    Args:
        recogniser: Names clips.
        config: What may be spoken, and when.
    """

    def __init__(self, recogniser: Recogniser, config: StreamConfig | None = None) -> None:
        self.config = config or StreamConfig()
        self._spotter = Spotter(recogniser, self.config.spot)

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose; return a gesture when one has been decided."""
        gesture = self._spotter.update(pose)
        if gesture is None or gesture.label is None:
            return gesture
        if self.config.commands is not None and gesture.label not in self.config.commands:
            return Gesture(
                None,
                gesture.confidence,
                gesture.onset_ns,
                gesture.end_ns,
                gesture.decided_ns,
                f"{gesture.label}, which is no command; {gesture.reason}",
            )
        return gesture

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self._spotter.reset()
