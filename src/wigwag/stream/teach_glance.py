"""Teaching the second view of a stream, with people left out in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from wigwag.stream.glance import Glance
from wigwag.stream.rows import DOUBTFUL, Rounds, Rows, teach_rows
from wigwag.stream.track import Track
from wigwag.stream.truth import LabelledStream

_PASSED = 0.4
"""A row shows a gesture from this share of it on ..."""
_AFTER_S = 0.2
"""... to so long after its end."""
_DOUBTFUL_S = 0.25
"""So much before and after that is not learned from."""
_ROUNDS = Rounds(count=48, near=8000, elsewhere=8000, dropped=0.3)


class GlanceLesson:
    """Streams that the second view is taught from.

    Args:
        streams: With their truth.
        labels: All gestures.
        fold: Which streams are left out together.
        seed: Of what is drawn.
    """

    def __init__(
        self,
        streams: Sequence[LabelledStream],
        labels: Sequence[str],
        fold: Int[np.ndarray, " streams"],
        seed: int,
    ) -> None:
        self.labels, self.fold, self.seed = tuple(labels), fold, seed
        self.tracks = [Track.of(one.stream) for one in streams]
        self.classes = [self._classes(*both) for both in zip(streams, self.tracks, strict=True)]

    def without(self, fold: int | None) -> Glance | None:
        """Teach what all streams but those of a fold show; ``None``: they show no gesture."""
        kept = [number for number, mine in enumerate(self.fold) if mine != fold]
        classes = np.concatenate([self.classes[number] for number in kept] or [np.empty(0, dtype=np.int64)])
        none = len(self.labels)
        if not ((classes >= 0) & (classes < none)).any():
            return None
        track = Track.joined([self.tracks[number] for number in kept])
        rows = Rows(track, classes, np.ones(none + 1, dtype=bool))
        rng = np.random.default_rng([0x91A, self.seed, 0 if fold is None else fold + 1])
        return Glance(teach_rows(rows, _ROUNDS, rng))

    def glimpses(
        self, glance: Glance, stream: int, stamps_ns: Int[np.ndarray, " looks"]
    ) -> Float[np.ndarray, "looks 2 classes"]:
        """Return what is seen in a stream at some moments."""
        track = self.tracks[stream]
        return glance.of_track(track)[np.searchsorted(track.stamps_ns, stamps_ns)]

    def _classes(self, one: LabelledStream, track: Track) -> Int[np.ndarray, " rows"]:
        classes = np.full(len(track.joints), len(self.labels))
        stamps_s = track.stamps_ns * 1e-9
        for only_doubtful in (True, False):
            for showing in one.showings:
                onset_s, end_s = showing.onset_ns * 1e-9, showing.end_ns * 1e-9
                low, high = onset_s + _PASSED * (end_s - onset_s), end_s + _AFTER_S
                room = _DOUBTFUL_S if only_doubtful else 0.0
                inside = (stamps_s >= low - room) & (stamps_s <= high + room)
                classes[inside] = DOUBTFUL if only_doubtful else self.labels.index(showing.label)
        return classes


__all__ = ["GlanceLesson"]
