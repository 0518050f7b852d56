"""Teaching gestures by their action points: ``teach_moments``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wigwag.errors import InputError
from wigwag.stream.moments import BINS, BINS_S, MomentConfig, MomentModel
from wigwag.stream.rows import Rounds, Rows, as_rare, teach_rows
from wigwag.stream.track import Track
from wigwag.stream.truth import LabelledStream

_NETWORKS = 3
_ROUNDS = 48
_NEAR, _ELSEWHERE = 0.3, 0.12
"""Rows of a round: this share of those near action points, and so many others over how many there are near
action points. Rows that follow each other are nearly the same."""


def teach_moments(
    streams: Sequence[LabelledStream], config: MomentConfig | None = None, random_state: int = 0
) -> MomentModel:
    """Teach gestures by the moments at which they are to be recognised.

    For what is marked by action points alone (Nowozin and Shotton, Microsoft Research TR 2012-68), as
    MSRC-12 is: when a movement began is not known. A network sees the last two seconds of a body and
    learns how long ago which action point was, or how long it still takes. In each round every row is shown
    as if by somebody else: with other limbs, another posture, another tempo, turned another way, and with
    the other hand where the gesture has no side (``MomentConfig.either_side``).

    Args:
        streams: With their showings, whose ends are the moments; streams without any are everyday movement.
        config: When a gesture is spoken.
        random_state: Seed.

    Raises:
        InputError: If nothing is shown, or a command, or a label of ``either_side``, is never shown.

    Example:
        >>> import numpy as np
        >>> from wigwag.skeleton import Clip, Pose
        >>> from wigwag.stream.truth import Showing
        >>> rng, body = np.random.default_rng(0), np.random.default_rng(1).normal(0, 0.4, (13, 3))
        >>> body[[1, 2, 7, 8]] = [[0.2, -0.5, 0], [-0.2, -0.5, 0], [0.1, 0, 0], [-0.1, 0, 0]]
        >>> joints = np.tile(body, (600, 1, 1)) + rng.normal(0, 0.003, (600, 13, 3))
        >>> for top in range(90, 600, 120):
        ...     joints[top - 20 : top + 20, 5, 1] -= np.sin(np.linspace(0, np.pi, 40))
        >>> stream = Clip.at_rate(joints, 30, None, "a")
        >>> points = [Showing("raise", i * 10**9 // 30, i * 10**9 // 30) for i in range(90, 600, 120)]
        >>> heard = teach_moments([LabelledStream(stream, tuple(points))]).stream()
        >>> poses = [Pose(j, np.ones(13), i * 33_333_333) for i, j in enumerate(joints)]
        >>> said = [gesture.label for pose in poses if (gesture := heard.update(pose)) is not None]
        >>> said
        ['raise', 'raise', 'raise', 'raise', 'raise']
    """
    config = config or MomentConfig()
    labels = tuple(sorted({showing.label for one in streams for showing in one.showings}))
    if not labels:
        raise InputError("teach_moments needs at least one stream with a showing.")
    for name, named in (("commands", config.commands), ("either_side", config.either_side)):
        if absent := set(named or ()) - set(labels):
            raise InputError(
                f"MomentConfig.{name} holds {sorted(absent)}, which nobody shows; shown are {list(labels)}."
            )
    rows = _rows(streams, labels, config.either_side)
    near = int((rows.classes < rows.none).sum())
    rounds = Rounds(_ROUNDS, round(_NEAR * near), round(_ELSEWHERE * near))
    seeds = [[0x90147, random_state, number] for number in range(_NETWORKS)]
    networks = tuple(
        as_rare(teach_rows(rows, rounds, np.random.default_rng(seed)), rows, rounds) for seed in seeds
    )
    return MomentModel(labels, networks, config)


def _rows(streams: Sequence[LabelledStream], labels: tuple[str, ...], either_side: tuple[str, ...]) -> Rows:
    """Follow all streams and say what each row is."""
    tracks = [Track.of(one.stream) for one in streams]
    none = len(labels) * BINS
    classes = []
    for one, track in zip(streams, tracks, strict=True):
        mine = np.full(len(track.joints), none)
        if one.showings:
            ends = np.array([showing.end_ns for showing in one.showings])
            every_s = (track.stamps_ns[:, None] - ends) * 1e-9
            nearest = np.abs(every_s).argmin(axis=1)
            away_s = every_s[np.arange(len(mine)), nearest]
            numbers = np.array([labels.index(showing.label) for showing in one.showings])
            stretch = np.searchsorted(BINS_S, away_s, side="right") - 1
            near = (stretch >= 0) & (stretch < BINS)
            mine[near] = (numbers[nearest] * BINS + stretch)[near]
        classes.append(mine)
    sided = np.repeat([label not in either_side for label in labels], BINS)
    # What is no gesture has no side, unless every gesture has one: then nothing is gained by it.
    return Rows(Track.joined(tracks), np.concatenate(classes), np.append(sided, not either_side))


__all__ = ["teach_moments"]
