"""Whoever hears a stream of poses: ``Listener``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from wigwag.gesture import Gesture
from wigwag.skeleton import Pose
from wigwag.stream.spot import Recogniser, SpotConfig, Spotter

if TYPE_CHECKING:
    from wigwag.stream.gesture_stream import StreamModel
    from wigwag.stream.moments import MomentModel


class Listener(Protocol):
    """Takes poses without end, says gestures."""

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose; return a gesture when one has been decided."""
        ...

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        ...


def listening(taught: StreamModel | MomentModel | Recogniser, config: SpotConfig | None = None) -> Listener:
    """Let what was taught hear a stream.

    Args:
        taught: A model of streams, or of moments in them; or a recogniser of whole clips, which hears what a
            :class:`~wigwag.stream.spot.Spotter` cuts out, once it is over.
        config: The spotter's.
    """
    from wigwag.stream.gesture_stream import StreamModel
    from wigwag.stream.moments import MomentModel

    return taught.stream() if isinstance(taught, StreamModel | MomentModel) else Spotter(taught, config)
