"""One person's one showing of a gesture: own speed, size, elbows, lag between the arms, and chance.

Between the key poses of the score each channel moves by minimum jerk (Flash and Hogan 1985), as human arms
do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.sim.further import FURTHER, FURTHER_SCORES
from wigwag.sim.kinematics import CHANNEL, CHANNELS, METRES, rest
from wigwag.sim.person import Person
from wigwag.sim.scores import (
    BACKGROUND,
    COMMANDS,
    DISTRACTORS,
    ENGAGEMENT_SCORES,
    SCORES,
    Key,
    other_side,
)

__all__ = [
    "BACKGROUND", "COMMANDS", "DISTRACTORS", "FURTHER", "PERFORMABLE", "SCORES", "TABLE_HZ", "Performance",
    "minimum_jerk", "perform",
]  # fmt: skip

TABLE_HZ = 120.0
"""Rate at which a performance is tabulated; between rows it is interpolated."""

_ALL = SCORES | ENGAGEMENT_SCORES | FURTHER_SCORES
_NAMES = [*sorted(SCORES), *sorted(ENGAGEMENT_SCORES), *sorted(FURTHER_SCORES)]
"""A name's place chooses its repetitions, so that new names go to the end."""

PERFORMABLE = (*COMMANDS, *FURTHER, *BACKGROUND, *DISTRACTORS)
"""What a simulated operator can be told to show."""


@dataclass(frozen=True, slots=True)
class Performance:
    """One repetition of a gesture by one person, as deviations from the person's rest."""

    name: str
    """The gesture."""
    table: Float[np.ndarray, "rows channels"]
    """What is added to the channels at rest, ``TABLE_HZ`` rows a second; first and last rows are zero."""

    @property
    def duration_s(self) -> float:
        """Seconds from first to last movement."""
        return (len(self.table) - 1) / TABLE_HZ

    def at(self, since_s: float) -> Float[np.ndarray, " channels"]:
        """Return the deviations ``since_s`` seconds after the beginning; zero outside."""
        place = since_s * TABLE_HZ
        if not 0 < place < len(self.table) - 1:
            return np.zeros(len(CHANNELS))
        row = int(place)
        part = place - row
        return np.asarray((1 - part) * self.table[row] + part * self.table[row + 1])


def minimum_jerk(phase: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n"]:
    """Go from 0 to 1 as an arm does (Flash and Hogan 1985): at rest and unaccelerated at both ends."""
    p = np.clip(phase, 0.0, 1.0)
    return np.asarray(p**3 * (10 - 15 * p + 6 * p**2))


def perform(name: str, person: Person, seed: int | Sequence[int] = 0) -> Performance:
    """Let a person show a gesture once.

    Args:
        name: One of ``PERFORMABLE``, or ``"engage"`` or ``"disengage"``.
        person: Whose speed, size and habits.
        seed: Chooses the repetition; the same seed gives the same movement.

    Raises:
        InputError: If there is no gesture of that name.

    Example:
        >>> from wigwag.sim.person import Person
        >>> perform("stop", Person()).table.shape[1] == len(CHANNELS)
        True
    """
    if name not in _NAMES:
        raise InputError(f"There is no simulated gesture {name!r}. Available gestures: {sorted(_NAMES)}.")
    rng = np.random.default_rng([person.seed, _NAMES.index(name), *np.atleast_1d(seed)])
    preferred = person.handedness
    hand = preferred if rng.random() < 0.8 else other_side(preferred)
    tracks = _tracks(_ALL[name](hand), person, rng)
    end = max(times[-1] for times, _ in tracks.values())
    clock = np.arange(int(np.ceil(end * TABLE_HZ)) + 2) / TABLE_HZ
    table = np.zeros((len(clock), len(CHANNELS)))
    for channel, (times, values) in tracks.items():
        steps = minimum_jerk((clock[:, None] - times[:-1]) / np.diff(times))
        table[:, CHANNEL[channel]] = steps @ np.diff(values)
    return Performance(name, table)


def _tracks(
    score: Sequence[Key], person: Person, rng: np.random.Generator
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """One repetition: for each channel its key times (s) and deviations from rest, both ending at rest."""
    # One draw for the whole repetition's speed and size, one for each key.
    # Chance is cut off where the two together would ask for hands faster than people's (8 m/s).
    pace = min(person.tempo * np.exp(rng.normal(0, 0.05 * person.sloppiness)), 1.3)
    size = person.amplitude * np.exp(rng.normal(0, 0.035 * person.sloppiness))
    hurry = np.clip(rng.normal(0, 0.06 * person.sloppiness, len(score)), -0.12, 0.06)
    spans = [key.after_s / pace * np.exp(-late) for key, late in zip(score, hurry, strict=True)]
    moments = np.cumsum(spans)
    standing = dict(zip(CHANNELS, rest(person), strict=True))
    touched = sorted({name for key in score for name in key.to})
    tracks = {}
    for name in touched:
        lag = {"left": person.lag_s, "right": -person.lag_s}.get(name.split("_")[0], 0.0) / 2
        lag += rng.normal(0, 0.012 * person.sloppiness)
        start = max(0.0, lag)
        times, values = [start], [0.0]
        for key, moment in zip(score, moments, strict=True):
            if not key.to:
                times.append(moment + lag)
                values.append(0.0)
            elif name in key.to:
                times.append(moment + lag)
                values.append(
                    _deviation(name, key.to[name], standing[name], person=person, size=size, rng=rng)
                )
        tracks[name] = (np.asarray(times), np.asarray(values))
    return tracks


def _deviation(
    name: str, target: float, standing: float, *, person: Person, size: float, rng: np.random.Generator
) -> float:
    """A person's deviation from rest where the score asks for ``target`` (degrees or centimetres)."""
    kind = name.split("_", 1)[1] if name.startswith(("left_", "right_")) else name
    if name in METRES:
        scale = person.height_m / 1.75 * size * np.exp(rng.normal(0, 0.06 * person.sloppiness))
        return float(target / 100 * scale)
    value = np.deg2rad(target)
    noise = np.deg2rad(3.0) * person.sloppiness * rng.normal()
    if kind == "raise":
        ratio = person.side_ratio if name.startswith("left") else 1.0
        value = standing + (value - standing) * size * ratio + noise
        return float(np.clip(value, 0.0, np.deg2rad(176)) - standing)
    if kind == "bend":
        value = np.clip(value + person.elbow_bend_rad * max(0.0, 1 - value) + noise, 0.02, np.deg2rad(150))
        return float(value - standing)
    if kind == "forward":
        return float(value + person.forward_rad + noise - standing)
    if kind == "roll":
        return float(value + 2 * noise - standing)
    return float(value * size + 0.15 * noise - standing)
