"""Streams assembled from cut recordings: gestures in random order, rest and everyday life between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.datasets.recording import Mark, Recording
from wigwag.errors import InputError
from wigwag.evaluate.stream.body import Limbs, Stance, Stillness, turn, upright
from wigwag.evaluate.stream.moves import movement, resampled
from wigwag.skeleton import Clip

GRID_HZ = 60.0
"""Everything is put together at this rate; the stream is read off it at its own."""

_HOME = np.array([0.0, 1.0, 3.0])
"""Where the person stands at first: metres, camera optical frame."""

_FREE_M_S = 1.2
"""Greatest speed of a landmark on its way from rest into a recording and back."""


@dataclass(frozen=True, slots=True)
class StreamConfig:
    """How a stream is put together.

    Raises:
        InputError: If a setting is out of range.
    """

    rate_hz: float = 30.0
    """Poses a second, 10 to 60."""
    lead_s: float = 3.0
    """Seconds of rest at the beginning and at the end."""
    hold_s: tuple[float, float] = (0.6, 2.4)
    """Shortest and longest rest between two movements, blends not counted."""
    everyday_share: float = 1.0
    """Chance that an everyday movement is shown between two gestures."""
    turn_rad: float = 0.5
    """How far everyday movements may be turned from the camera, either way, beside their own turn."""
    seat_s: tuple[float, float] = (0.7, 1.5)
    """How long a person who sits down sits before what follows."""

    def __post_init__(self) -> None:
        """Check the settings."""
        if not 10 <= self.rate_hz <= GRID_HZ:
            raise InputError(
                f"StreamConfig.rate_hz must be within 10 and {GRID_HZ:g}, but got {self.rate_hz}."
            )
        if not 0 <= self.everyday_share <= 1:
            raise InputError(
                f"StreamConfig.everyday_share must be within 0 and 1, but got {self.everyday_share}."
            )


@dataclass(frozen=True, slots=True)
class Shown:
    """A recording that is to be shown in a stream."""

    clip: Clip
    """Any person's; it is given the limbs of the stream's."""
    source: str
    """Such as ``"utd:a1"`` or ``"utkinect:carry"``."""
    label: str | None = None
    """Its name if it is a gesture; ``None``: everyday movement."""


@dataclass(frozen=True, slots=True)
class Body:
    """The person of a stream, as measured on their own recordings."""

    name: str
    limbs: Limbs
    stillness: Stillness
    rests: Float[np.ndarray, "postures 13 3"]
    """Postures in which the person was seen standing with lowered arms; facing the camera, feet at 0."""

    @classmethod
    def of(cls, clips: Sequence[Clip], rate_hz: float) -> Body:
        """Measure a person on all their clips.

        Raises:
            InputError: If there are none, or the person never stands with lowered arms at an end of one.
        """
        limbs, stillness = Limbs.of(clips), Stillness.of(clips, rate_hz)
        ends = [clip.joints[i] for clip in clips for i in (0, -1)]
        rests = [_at_origin(end) for end in ends if upright(end, limbs)]
        name = str(clips[0].subject)
        if not rests:
            raise InputError(f"{name} never stands with lowered arms at an end of {len(clips)} clips.")
        return cls(name, limbs, stillness, np.stack(rests))


def assemble(
    body: Body,
    gestures: Sequence[Sequence[Shown]],
    everyday: Sequence[Shown],
    config: StreamConfig | None = None,
    *,
    seed: int | Sequence[int] = 0,
    name: str = "stream",
) -> Recording:
    """Let a person show gestures in random order, with rest and everyday movements between them.

    Each recording plays at its own pace from its first frame to its last, in the person's own limbs,
    where the person happens to stand. Between recordings the person moves to a posture in which they were
    seen resting, and keeps still with their own sensor's jitter. What is marked as a gesture is the
    recorded movement alone (:func:`~wigwag.evaluate.stream.moves.movement`), neither the rest that was
    recorded with it nor the way into it.

    Args:
        body: Who.
        gestures: Groups of recordings; a group's are shown in its order, without everyday movements
            between (sitting down comes before standing up).
        everyday: Movements that are no gesture, in the order in which they are taken; as many as fit.
        config: Rate, rest, and how many everyday movements.
        seed: Of order and rest.
        name: Of the stream.

    Returns:
        The stream, its gestures as marks, everything else that is shown as scenes. Time starts at 0.

    Raises:
        InputError: If there is nothing to show.
    """
    config = config or StreamConfig()
    if not gestures and not everyday:
        raise InputError(f"{name}: there is nothing to show.")
    rng = np.random.default_rng(seed)
    reel = _Reel(body, config, rng)
    reel.rest(config.lead_s)
    waiting = list(everyday)[::-1]
    for group in [gestures[int(i)] for i in rng.permutation(len(gestures))]:
        if waiting and rng.random() < config.everyday_share:
            reel.show(waiting.pop(), turned=True)
            reel.rest()
        for number, shown in enumerate(group):
            if number and not reel.seated:
                reel.rest()
            reel.show(shown)
        reel.rest()
    while waiting and not gestures:
        reel.show(waiting.pop(), turned=True)
        reel.rest()
    reel.rest(config.lead_s)
    return reel.finish(name)


class _Reel:
    """What is filmed so far, at ``GRID_HZ``."""

    def __init__(self, body: Body, config: StreamConfig, rng: np.random.Generator) -> None:
        self.body, self.config, self.rng = body, config, rng
        self.parts: list[np.ndarray] = []
        self.frames = 0
        self.marks: list[Mark] = []
        self.scenes: list[Mark] = []
        self.stance = Stance(_HOME, 0.0)
        self.last = self._resting()
        self.speed = np.zeros((13, 3))

    @property
    def seated(self) -> bool:
        """Whether the person's last posture is none of standing at rest, but sunk."""
        return not upright(self.last, self.body.limbs)

    def _resting(self) -> Float[np.ndarray, "13 3"]:
        posture = self.body.rests[int(self.rng.integers(len(self.body.rests)))]
        return np.asarray(Stance(self.stance.ground, 0.0).put(posture[None])[0])

    def rest(self, seconds: float | None = None) -> None:
        """Go to rest and keep still; now and then, the weight is shifted."""
        left = float(self.rng.uniform(*self.config.hold_s)) if seconds is None else seconds
        path = [self._way(self._resting(), np.zeros((13, 3)))]
        while left > 2.0:
            still = min(float(self.rng.uniform(1.0, 2.0)), left)
            path.append(np.repeat(self.last[None], round(still * GRID_HZ), axis=0))
            path.append(self._way(self._resting(), np.zeros((13, 3)), least_s=0.8))
            left -= still + len(path[-1]) / GRID_HZ
        path.append(np.repeat(self.last[None], max(round(left * GRID_HZ), 1), axis=0))
        self._add(self._alive(np.concatenate(path)))

    def show(self, shown: Shown, turned: bool = False) -> None:
        """Go into a recording and play it."""
        clip = shown.clip if shown.clip.subject == self.body.name else self.body.limbs.wear(shown.clip)
        times = np.arange(int(np.floor(clip.duration_s * GRID_HZ)) + 1) / GRID_HZ
        # A recorded person faces the camera as they did when they were recorded, give or take.
        facing = Stance.of(clip.joints[0]).facing_rad + (self._turn(clip) if turned else 0.0)
        played = Stance(self.stance.ground, facing).put(resampled(clip, times))
        if self._sunk(played[0]):
            way = [self._way(played[0], np.zeros((13, 3)))]
            way.append(
                np.repeat(played[:1], round(float(self.rng.uniform(*self.config.seat_s)) * GRID_HZ), axis=0)
            )
        else:
            way = [self._way(played[0], (played[1] - played[0]) * GRID_HZ)]
        self._add(self._alive(np.concatenate(way)))
        begin = self.frames / GRID_HZ
        onset_s, end_s = (0.0, clip.duration_s) if shown.label is None else movement(shown.clip)
        mark = Mark(shown.label or shown.source, _ns(begin + onset_s), _ns(begin + end_s))
        (self.scenes if shown.label is None else self.marks).append(mark)
        self._add(played)
        self.last, self.speed = played[-1], (played[-1] - played[-2]) * GRID_HZ
        self.stance = Stance(Stance.of(played[-1]).ground * [1, 0, 1] + _HOME * [0, 1, 0], 0.0)

    def _turn(self, clip: Clip) -> float:
        """Say how far to turn an everyday movement; who walks, walks back to where they came from."""
        path = Stance.of(clip.joints[-1]).ground - Stance.of(clip.joints[0]).ground
        back = _HOME - self.stance.ground
        by = float(self.rng.uniform(-1, 1)) * self.config.turn_rad
        if np.hypot(path[0], path[2]) < 0.5 or np.hypot(back[0], back[2]) < 0.5:
            return by
        return by + float(np.arctan2(back[2], back[0]) - np.arctan2(path[2], path[0]))

    def _sunk(self, joints: Float[np.ndarray, "13 3"]) -> bool:
        hips = float((joints[7, 1] + joints[8, 1]) / 2)
        return self.body.limbs.leg_m - (float(joints[[11, 12], 1].max()) - hips) >= 0.12

    def _way(self, to: np.ndarray, speed: np.ndarray, least_s: float = 0.4) -> np.ndarray:
        """Go from the last posture to another, at either end as fast as it is there."""
        a, b = Stance.of(self.last), Stance.of(to)
        span = float(np.linalg.norm(to - self.last, axis=1).max())
        turned = (b.facing_rad - a.facing_rad + np.pi) % (2 * np.pi) - np.pi
        length_s = max(least_s, 1.5 * span / _FREE_M_S, abs(turned) / 1.5)
        frames = max(round(length_s * GRID_HZ), 2)
        t = (np.arange(1, frames) / frames)[:, None, None]
        start, goal = turn(self.last - a.ground, -a.facing_rad), turn(to - b.ground, -b.facing_rad)
        slopes = [
            turn(_slow(v), -f) * length_s for v, f in ((self.speed, a.facing_rad), (speed, b.facing_rad))
        ]
        path = (
            (2 * t**3 - 3 * t**2 + 1) * start + (t**3 - 2 * t**2 + t) * slopes[0]
            + (3 * t**2 - 2 * t**3) * goal + (t**3 - t**2) * slopes[1]
        )  # fmt: skip
        ease = (3 * t**2 - 2 * t**3)[:, 0, 0]
        for i, share in enumerate(ease):
            path[i] = turn(path[i], a.facing_rad + share * turned) + a.ground + share * (b.ground - a.ground)
        self.last, self.speed = to, np.zeros((13, 3))
        return np.asarray(path)

    def _alive(self, path: np.ndarray) -> np.ndarray:
        """Add sway and jitter, rising from nothing at both ends, where recordings bring their own."""
        moved = self.body.stillness.around(path, GRID_HZ, self.rng)
        edge = np.clip(np.minimum(np.arange(len(path)), np.arange(len(path))[::-1]) / (0.1 * GRID_HZ), 0, 1)
        return np.asarray(path + edge[:, None, None] * (moved - path))

    def _add(self, frames: np.ndarray) -> None:
        self.parts.append(frames.astype(np.float32))
        self.frames += len(frames)

    def finish(self, name: str) -> Recording:
        """Read the stream off at its own rate."""
        film = np.concatenate(self.parts).reshape(self.frames, -1)
        count = int((self.frames - 1) / GRID_HZ * self.config.rate_hz) + 1
        times = np.arange(count) / self.config.rate_hz
        place = np.minimum(times * GRID_HZ, self.frames - 1)
        row = np.minimum(place.astype(int), self.frames - 2)
        part = (place - row)[:, None].astype(np.float32)
        joints = ((1 - part) * film[row] + part * film[row + 1]).reshape(count, 13, 3)
        stream = Clip(joints, np.round(times * 1e9).astype(np.int64), None, self.body.name, name)
        return Recording(stream, tuple(self.marks), tuple(self.scenes))


def _at_origin(joints: Float[np.ndarray, "13 3"]) -> Float[np.ndarray, "13 3"]:
    stance = Stance.of(joints)
    return turn(joints - stance.ground, -stance.facing_rad)


def _slow(speed: np.ndarray) -> np.ndarray:
    """Limit each landmark's speed, m/s."""
    size = np.linalg.norm(speed, axis=1, keepdims=True)
    return np.asarray(speed * np.minimum(1.0, 1.0 / np.maximum(size, 1e-9)))


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)


__all__ = ["GRID_HZ", "Body", "Shown", "StreamConfig", "assemble"]
