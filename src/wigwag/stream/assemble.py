"""Streams to teach by, out of cut examples: rest between them, and movements that are no gesture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from wigwag.skeleton import Clip
from wigwag.stream.ticks import RATE_HZ
from wigwag.stream.truth import LabelledStream, Showing

_ACROSS = np.array([1.0, 0.0, 1.0])
_HEELS = slice(11, 13)
_HIPS = slice(7, 9)
_ARMS = ((1, 3), (3, 5), (2, 4), (4, 6))
_MOVING_M_S = 0.2
_MOVING_SHARE = 0.1
_FREE_M_S = 1.2
"""Mean speed of the landmark that has farthest to go from one movement to the next."""
_JITTER_M = 0.004
_LONGEST_S = 8.0
"""So much of a movement that is no gesture is shown at once."""


def assemble(
    clips: Sequence[Clip],
    background: Sequence[Clip],
    rng: np.random.Generator,
    *,
    share: float = 0.5,
    hold_s: tuple[float, float] = (0.4, 1.8),
) -> LabelledStream:
    """Let one person show clips in random order, with rest and other movements between.

    Args:
        clips: Labelled examples of one person. Where in a clip the gesture is, its movement says.
        background: Movements that are no gesture, of anybody: they are shown in the person's size.
        rng: Chooses order, rest and what comes between.
        share: Chance that a movement that is no gesture is shown before a clip.
        hold_s: Shortest and longest rest.
    """
    size = arm_length(clips[0].joints)
    reel = _Reel(rng)
    for number in rng.permutation(len(clips)):
        if background and rng.random() < share:
            other = at_rate(_piece(background[int(rng.integers(len(background)))], rng))
            reel.show(other * (size / arm_length(other)))
            reel.hold(float(rng.uniform(*hold_s)))
        clip = clips[int(number)]
        rows = at_rate(clip)
        first, last = moving(rows)
        start = reel.show(rows)
        if clip.label is not None:
            reel.showings.append((clip.label, start + first, start + last))
        reel.hold(float(rng.uniform(*hold_s)))
    name = f"stream of {clips[0].subject or 'somebody'}"
    joints = np.concatenate(reel.parts)
    noise = gaussian_filter1d(rng.normal(size=joints.shape), 2.0, axis=0) * (2.6 * _JITTER_M)
    stream = Clip.at_rate(joints + noise, RATE_HZ, None, clips[0].subject, name)
    stamps = stream.stamps_ns
    showings = (Showing(label, int(stamps[a]), int(stamps[b])) for label, a, b in reel.showings)
    return LabelledStream(stream, tuple(showings))


class _Reel:
    """What is shown so far."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.parts: list[np.ndarray] = []
        self.count = 0
        self.showings: list[tuple[str, int, int]] = []

    def show(self, rows: Float[np.ndarray, "rows 13 3"]) -> int:
        """Go over into a movement and show it; return the row at which it begins."""
        if self.parts:
            last = self.parts[-1][-1]
            stand = (last[_HIPS].mean(axis=0) - rows[0, _HIPS].mean(axis=0)) * _ACROSS
            stand[1] = last[_HEELS, 1].mean() - rows[0, _HEELS, 1].mean()
            rows = rows + stand
            far = float(np.linalg.norm(rows[0] - last, axis=1).max())
            steps = round(RATE_HZ * max(float(self.rng.uniform(0.35, 0.6)), far / _FREE_M_S))
            phase = (np.arange(1, steps) / steps)[:, None, None]
            ease = phase**3 * (10 - 15 * phase + 6 * phase**2)
            self._add(last + ease * (rows[0] - last))
        begin = self.count
        self._add(rows)
        return begin

    def hold(self, seconds: float) -> None:
        """Keep still."""
        self._add(np.repeat(self.parts[-1][-1:], max(round(seconds * RATE_HZ), 1), axis=0))

    def _add(self, rows: np.ndarray) -> None:
        self.parts.append(rows)
        self.count += len(rows)


def _piece(clip: Clip, rng: np.random.Generator) -> Clip:
    """Return at most ``_LONGEST_S`` of a clip, from anywhere in it."""
    length = int(np.searchsorted(clip.times_s, _LONGEST_S))
    start = int(rng.integers(max(len(clip) - length, 0) + 1))
    stop = max(start + length, start + 2)
    return Clip(clip.joints[start:stop], clip.stamps_ns[start:stop], None, clip.subject, clip.name)


def at_rate(clip: Clip) -> Float[np.ndarray, "rows 13 3"]:
    """Return a clip's landmarks at ``RATE_HZ``."""
    times = np.arange(int(clip.duration_s * RATE_HZ) + 1) / RATE_HZ
    own = clip.times_s
    after = np.clip(np.searchsorted(own, times, side="right"), 1, len(own) - 1)
    share = ((times - own[after - 1]) / (own[after] - own[after - 1]))[:, None, None]
    rows = clip.joints[after - 1] * (1 - share) + clip.joints[after] * share
    return np.asarray(rows if len(rows) > 1 else np.repeat(rows, 2, axis=0), dtype=np.float64)


def arm_length(joints: Float[np.ndarray, "rows 13 3"]) -> float:
    """Return the median over a movement of upper arm and forearm together, metres; 1 without extent."""
    lengths = sum(np.linalg.norm(joints[:, b] - joints[:, a], axis=1) for a, b in _ARMS)
    return max(float(np.median(lengths)) / 2, 0.0) or 1.0


def moving(rows: Float[np.ndarray, "rows 13 3"]) -> tuple[int, int]:
    """Return the first and the last row of a movement; all of it if nobody moves."""
    relative = rows - rows[:, _HIPS].mean(axis=1, keepdims=True) * _ACROSS
    smooth = gaussian_filter1d(relative, 0.08 * RATE_HZ, axis=0, mode="nearest")
    speed = np.sort(np.linalg.norm(np.gradient(smooth, axis=0), axis=2) * RATE_HZ, axis=1)[:, -3:].mean(
        axis=1
    )
    fast = np.flatnonzero(speed > max(_MOVING_M_S, _MOVING_SHARE * float(np.percentile(speed, 95))))
    return (int(fast[0]), int(fast[-1])) if len(fast) > 1 else (0, len(rows) - 1)
