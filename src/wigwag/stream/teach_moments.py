"""Teaching gestures by their action points: ``teach_moments``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from wigwag.errors import InputError
from wigwag.stream.moments import NEAR_S, MomentConfig, MomentModel
from wigwag.stream.network import RATE, Network, Teacher
from wigwag.stream.track import FEATURES, Change, Track
from wigwag.stream.truth import LabelledStream

_NETWORKS = 3
_ROUNDS = 9
_LEAST_ROWS = 40_000
"""Where little is shown, there are as many rounds as make so many rows."""
_SLOW = 0.7
"""After this share of all rounds steps are a fifth as large."""
_DOUBTFUL_S = 0.1
"""So near before and after what is taught as a gesture, nothing is taught."""
_AROUND_S = 1.2
_POINTS, _AROUND, _ELSEWHERE = 0.5, 0.65, 0.4
"""Rows of a round: this share of those at action points, and as many around them and elsewhere, over how many
there are at action points. Rows that follow each other are nearly the same."""
_CHUNK = 4096


@dataclass(frozen=True, slots=True)
class _Rows:
    """What each row of all streams is."""

    track: Track
    classes: Int[np.ndarray, " rows"]
    """The last class: no action point."""
    doubtful: Bool[np.ndarray, " rows"]
    around: Bool[np.ndarray, " rows"]


def teach_moments(
    streams: Sequence[LabelledStream], config: MomentConfig | None = None, random_state: int = 0
) -> MomentModel:
    """Teach gestures by the moments at which they are to be recognised.

    For what is marked by action points alone (Nowozin and Shotton, Microsoft Research TR 2012-68), as
    MSRC-12 is: when a movement began is not known. A network sees the last two seconds of a body and
    learns whether now is an action point. In each round every row is shown as if by somebody else: with
    other limbs, another posture, another tempo, turned another way.

    Args:
        streams: With their showings, whose ends are the moments; streams without any are everyday movement.
        config: When a gesture is spoken.
        random_state: Seed.

    Raises:
        InputError: If nothing is shown, or a command is never shown.

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
    if config.commands is not None and (absent := set(config.commands) - set(labels)):
        raise InputError(
            f"MomentConfig.commands holds {sorted(absent)}, which nobody shows; shown are {list(labels)}."
        )
    rows = _rows(streams, labels)
    networks = tuple(
        _taught(rows, len(labels) + 1, np.random.default_rng([0x90147, random_state, number]))
        for number in range(_NETWORKS)
    )
    return MomentModel(labels, networks, config)


def _rows(streams: Sequence[LabelledStream], labels: tuple[str, ...]) -> _Rows:
    """Follow all streams and say what each row is."""
    tracks = [Track.of(one.stream) for one in streams]
    classes, doubtful, around = [], [], []
    for one, track in zip(streams, tracks, strict=True):
        mine = np.full(len(track.joints), len(labels))
        if not one.showings:
            away = np.full(len(mine), np.inf)
        else:
            ends = np.array([showing.end_ns for showing in one.showings])
            every = (track.stamps_ns[:, None] - ends) * 1e-9
            nearest = np.abs(every - sum(NEAR_S) / 2).argmin(axis=1)
            away = every[np.arange(len(mine)), nearest]
            numbers = np.array([labels.index(showing.label) for showing in one.showings])
            at = (away >= NEAR_S[0]) & (away <= NEAR_S[1])
            mine[at] = numbers[nearest[at]]
        classes.append(mine)
        near = (away > NEAR_S[0] - _DOUBTFUL_S) & (away < NEAR_S[1] + _DOUBTFUL_S)
        doubtful.append(near & (mine == len(labels)))
        around.append(np.abs(away) < _AROUND_S)
    return _Rows(
        Track.joined(tracks), np.concatenate(classes), np.concatenate(doubtful), np.concatenate(around)
    )


def _taught(rows: _Rows, classes: int, rng: np.random.Generator) -> Network:
    """Teach one network."""
    points = np.flatnonzero(rows.classes < classes - 1)
    none = (rows.classes == classes - 1) & ~rows.doubtful
    around, elsewhere = np.flatnonzero(none & rows.around), np.flatnonzero(none & ~rows.around)
    network = Network(FEATURES, classes, rng)
    usual = rng.permutation(np.concatenate([points, around]))[: 4 * _CHUNK]
    network.standardise(rows.track.looks(usual))
    teacher = Teacher(network, rng)
    counts = (round(_POINTS * len(points)), round(_AROUND * len(points)), round(_ELSEWHERE * len(points)))
    rounds = max(_ROUNDS, -(-_LEAST_ROWS // max(sum(counts), 1)))
    for number in range(rounds):
        some = [rng.permutation(of)[:n] for of, n in zip((points, around, elsewhere), counts, strict=True)]
        chosen = rng.permutation(np.concatenate(some))
        rate = RATE if number < _SLOW * rounds else RATE / 5
        for low in range(0, len(chosen), _CHUNK):
            part = chosen[low : low + _CHUNK]
            seen = rows.track.looks(part, Change.random(len(part), rng))
            teacher.learn(seen, rows.classes[part], rate)
    shown = sum(map(len, some)) - len(some[0])
    if shown and len(some[0]):
        network.rarer(classes - 1, float(none.sum()) / shown * len(some[0]) / len(points))
    return network


__all__ = ["teach_moments"]
