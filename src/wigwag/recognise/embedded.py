"""Many clips' embeddings, computed when they are asked for: all at once they are 50 times the clips."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import overload

import numpy as np
from jaxtyping import Float

from wigwag.features import Embedding, FrameScaler
from wigwag.skeleton import Clip

_KEPT = 32
"""Embeddings that stay at hand: a live stream asks for the same few references again and again."""

Embedded = Float[np.ndarray, "frames features"]


class EmbeddedClips(Sequence[Embedded]):
    """A read-only sequence of embedded and, if there is a scaler, scaled clips.

    Going through all of them keeps none; asking for one keeps it while it is among the 32 that were asked
    for last.

    Args:
        clips: Normalised clips.
        embedding: Fitted.
        scaler: Fitted; ``None``: features as they are.
    """

    def __init__(
        self, clips: Sequence[Clip], embedding: Embedding, scaler: FrameScaler | None = None
    ) -> None:
        self.clips, self._embedding, self._scaler = clips, embedding, scaler
        self._kept: dict[int, Embedded] = {}

    def __len__(self) -> int:
        return len(self.clips)

    def __iter__(self) -> Iterator[Embedded]:
        return map(self._embed, self.clips)

    @overload
    def __getitem__(self, index: int) -> Embedded: ...
    @overload
    def __getitem__(self, index: slice) -> EmbeddedClips: ...
    def __getitem__(self, index: int | slice) -> Embedded | EmbeddedClips:
        if isinstance(index, slice):
            return EmbeddedClips(self.clips[index], self._embedding, self._scaler)
        sequence = self._kept.pop(index, None)
        if sequence is None:
            sequence = self._embed(self.clips[index])
        self._kept[index] = sequence  # a dict keeps the order: last asked, last out
        if len(self._kept) > _KEPT:
            self._kept.pop(next(iter(self._kept)), None)
        return sequence

    def _embed(self, clip: Clip) -> Embedded:
        sequence = self._embedding.embed(clip)
        return sequence if self._scaler is None else self._scaler.scale(sequence)
