"""Teaching a network what single rows of streams are, each shown as if by somebody else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.stream.network import RATE, Network, Teacher
from wigwag.stream.track import FEATURES, Change, Track

DOUBTFUL = -1
"""The class of rows that nothing is learned from."""

LEAST_ROWS = 40_000
"""Where little is shown, there are as many rounds as make so many rows."""
_SLOW = 0.7
"""After this share of all rounds steps are a fifth as large."""
_MIRRORED = 0.25
"""This share of the rows that have no side is shown in a mirror."""
_CHUNK = 4096


@dataclass(frozen=True, slots=True)
class Rows:
    """What each row of some streams is."""

    track: Track
    classes: Int[np.ndarray, " rows"]
    """The last class: no gesture; ``DOUBTFUL``: neither here nor there."""
    sided: Bool[np.ndarray, " classes"]
    """Which classes may not be shown in a mirror."""

    @property
    def none(self) -> int:
        """The class of no gesture."""
        return len(self.sided) - 1


@dataclass(frozen=True, slots=True)
class Rounds:
    """How long, and from how many rows, is learned."""

    count: int
    near: int
    """Rows of gestures in a round, at most."""
    elsewhere: int
    """Rows of no gesture in a round, at most."""
    hidden: int = 256
    """Numbers of the network's hidden layer."""
    dropped: float = 0.15
    """Of the numbers of a row, so much is hidden while learning."""


def teach_rows(rows: Rows, rounds: Rounds, rng: np.random.Generator) -> Network:
    """Teach a network.

    In each round some rows are drawn, and each is shown as if by somebody else: with other limbs, another
    posture, another tempo, turned another way, and, where its class has no side, in a mirror.
    """
    near = np.flatnonzero((rows.classes >= 0) & (rows.classes < rows.none))
    elsewhere = np.flatnonzero(rows.classes == rows.none)
    network = Network(FEATURES, rows.none + 1, rng, rounds.hidden)
    network.standardise(rows.track.looks(rng.permutation(near)[: 4 * _CHUNK]))
    teacher = Teacher(network, rng, rounds.dropped)
    counts = (min(rounds.near, len(near)), min(rounds.elsewhere, len(elsewhere)))
    count = max(rounds.count, -(-LEAST_ROWS // max(sum(counts), 1)))
    for number in range(count):
        some = [rng.permutation(of)[:n] for of, n in zip((near, elsewhere), counts, strict=True)]
        chosen = rng.permutation(np.concatenate(some))
        rate = RATE if number < _SLOW * count else RATE / 5
        for low in range(0, len(chosen), _CHUNK):
            part = chosen[low : low + _CHUNK]
            mirrored = (rng.random(len(part)) < _MIRRORED) & ~rows.sided[rows.classes[part]]
            seen: Float[np.ndarray, "rows features"]
            seen = rows.track.looks(part, Change.random(len(part), rng, mirrored))
            teacher.learn(seen, rows.classes[part], rate)
    return network


def as_rare(network: Network, rows: Rows, rounds: Rounds) -> Network:
    """Say that gestures are as rare as in all rows; they are less so among those that are learned from."""
    near = int(((rows.classes >= 0) & (rows.classes < rows.none)).sum())
    elsewhere = int((rows.classes == rows.none).sum())
    if min(near, elsewhere, rounds.near, rounds.elsewhere) > 0:
        shown = min(rounds.near, near) / near
        network.rarer(rows.none, shown * elsewhere / min(rounds.elsewhere, elsewhere))
    return network


__all__ = ["DOUBTFUL", "Rounds", "Rows", "as_rare", "teach_rows"]
