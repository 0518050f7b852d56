"""The last two seconds of a body, as a row of numbers: places some moments ago, and how they changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.skeleton import MIRROR, Clip, Pose
from wigwag.stream.posture import Postures
from wigwag.stream.ticks import Ticks

LAGS = np.array([0, 2, 4, 7, 10, 14, 19, 25, 32, 40, 50, 62])
"""Places are taken so many rows ago."""
STEP_LAGS = np.array([0, 3, 6, 10, 15, 22, 30, 40])
"""Steps end so many rows ago."""
STEP = 3
"""Rows that a step takes: a tenth of a second."""
_STEP_GAIN = 3.0
OTHER_SIDE = np.array([-1.0, 1.0, 1.0], dtype=np.float32)
"""A mirror changes x by so much, beside the names of landmarks."""
REACH = 95
"""No number comes from more rows ago, however fast a person is made to move."""

FEATURES = (len(LAGS) + len(STEP_LAGS)) * 39 + 3


@dataclass(frozen=True, slots=True)
class Track:
    """A stream in its person's own frame; see :class:`~wigwag.stream.posture.Postures`."""

    joints: Float[np.ndarray, "rows 13 3"]
    """Torso lengths from the hips."""
    hips: Float[np.ndarray, "rows 3"]
    """How fast they move, torso lengths a second."""
    first: Int[np.ndarray, " rows"]
    """The first row since the stream last began anew: nothing is taken from before it."""
    stamps_ns: Int[np.ndarray, " rows"]

    @classmethod
    def of(cls, stream: Clip) -> Self:
        """Follow a whole stream as it would be in flight."""
        ticks, postures, visibility = Ticks(), Postures(), np.ones(13)
        joints: list[Float[np.ndarray, "13 3"]] = []
        hips: list[Float[np.ndarray, " 3"]] = []
        first: list[int] = []
        stamps: list[int] = []
        begun = restarts = 0
        for pose_joints, stamp_ns in zip(stream.joints, stream.stamps_ns, strict=True):
            new = ticks.update(Pose(pose_joints, visibility, int(stamp_ns)))
            if ticks.restarts != restarts:
                postures.reset()
                begun, restarts = len(joints), ticks.restarts
            for row in range(ticks.count - new, ticks.count):
                placed, moved = postures.update(ticks.window(row, row)[0])
                joints.append(placed)
                hips.append(moved)
                first.append(begun)
                stamps.append(ticks.stamp_ns(row))
        return cls(
            np.array(joints, dtype=np.float32),
            np.array(hips, dtype=np.float32),
            np.array(first, dtype=np.int64),
            np.array(stamps, dtype=np.int64),
        )

    @classmethod
    def joined(cls, tracks: list[Track]) -> Track:
        """Put tracks one after the other; none reaches into the one before."""
        offsets = np.cumsum([0, *(len(track.joints) for track in tracks)])
        return Track(
            np.concatenate([track.joints for track in tracks]),
            np.concatenate([track.hips for track in tracks]),
            np.concatenate([t.first + offset for t, offset in zip(tracks, offsets, strict=False)]),
            np.concatenate([track.stamps_ns for track in tracks]),
        )

    def looks(self, rows: Int[np.ndarray, " n"], change: Change | None = None) -> Float[np.ndarray, "n f"]:
        """Return the numbers of some rows, as they are or of a person changed in some way."""
        faster = np.ones((len(rows), 1)) if change is None else change.faster
        places = self._at(rows, LAGS, faster)
        steps = _STEP_GAIN * (self._at(rows, STEP_LAGS, faster) - self._at(rows, STEP_LAGS + STEP, faster))
        hips = self.hips[rows][:, None]
        if change is not None:
            places, steps, hips = change.apply(places, steps, hips)
        return np.concatenate([part.reshape(len(rows), -1) for part in (places, steps, hips)], axis=1)

    def _at(self, rows: np.ndarray, lags: np.ndarray, faster: np.ndarray) -> Float[np.ndarray, "n lags 13 3"]:
        back = np.minimum(np.rint(lags * faster).astype(np.int64), REACH)
        return np.asarray(self.joints[np.maximum(rows[:, None] - back, self.first[rows][:, None])])


class Tail:
    """The last rows of a stream as they come, for :class:`Track`'s numbers of the newest one."""

    def __init__(self) -> None:
        self._postures = Postures()
        self._joints = np.zeros((REACH, 13, 3), dtype=np.float32)
        self.reset()

    def reset(self) -> None:
        """Forget the stream."""
        self._postures.reset()
        self._hips = np.zeros(3, dtype=np.float32)
        self.count = 0
        """Rows so far."""

    def update(self, joints: Float[np.ndarray, "13 3"]) -> None:
        """Take in a row: metres, camera optical frame."""
        placed, hips = self._postures.update(joints)
        self._joints[:-1] = self._joints[1:]
        self._joints[-1], self._hips = placed, hips.astype(np.float32)
        self.count += 1

    def look(self) -> Float[np.ndarray, "1 f"]:
        """Return the numbers of the newest row."""
        first = np.full(REACH, max(REACH - self.count, 0))
        track = Track(self._joints, np.broadcast_to(self._hips, (REACH, 3)), first, first)
        return track.looks(np.array([REACH - 1]))


@dataclass(frozen=True, slots=True)
class Change:
    """How other people would have moved at some rows: each row by somebody else."""

    faster: Float[np.ndarray, "n 1"]
    """So many times as fast."""
    turn: Float[np.ndarray, "n 3 3"]
    """Turned about the vertical, and stretched along each axis."""
    limbs: Float[np.ndarray, "n 1 13 1"]
    """Each landmark so many times as far from the hips."""
    posture: Float[np.ndarray, "n 1 13 3"]
    """Each landmark so far from where it was all the time, torso lengths."""
    mirrored: Bool[np.ndarray, " n"] | None = None
    """Who shows it with the other side of the body; ``None``: nobody."""

    @classmethod
    def random(
        cls, count: int, rng: np.random.Generator, mirrored: Bool[np.ndarray, " n"] | None = None
    ) -> Self:
        """Draw a person for each of some rows; ``mirrored`` are given, since not every gesture may be."""
        angle = rng.normal(0, TURN_RAD, count)
        turn = np.zeros((count, 3, 3), dtype=np.float32)
        turn[:, 0, 0] = turn[:, 2, 2] = np.cos(angle)
        turn[:, 0, 2], turn[:, 2, 0], turn[:, 1, 1] = np.sin(angle), -np.sin(angle), 1.0
        turn *= np.exp(rng.normal(0, STRETCH, (count, 1, 3))).astype(np.float32)
        return cls(
            np.exp(rng.uniform(-TEMPO, TEMPO, (count, 1))),
            turn,
            np.exp(rng.normal(0, LIMBS, (count, 1, 13, 1))).astype(np.float32),
            rng.normal(0, POSTURE, (count, 1, 13, 3)).astype(np.float32),
            mirrored,
        )

    def apply(
        self, places: np.ndarray, steps: np.ndarray, hips: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Change places, steps and the hips' speed."""
        faster = self.faster.astype(np.float32)
        if self.mirrored is not None and self.mirrored.any():
            for part in (places, steps):
                part[self.mirrored] = part[self.mirrored][:, :, list(MIRROR)] * OTHER_SIDE
            hips = np.where(self.mirrored[:, None, None], hips * OTHER_SIDE, hips)
        places = np.matmul(places * self.limbs, self.turn[:, None]) + self.posture
        # Steps were taken over as many more rows already; the hips' speed was not.
        steps = np.matmul(steps * self.limbs, self.turn[:, None])
        return places, steps, np.matmul(hips, self.turn) * faster[..., None]


TURN_RAD = 0.175
STRETCH = 0.15
LIMBS = 0.075
TEMPO = 0.3
POSTURE = 0.15
"""How much people differ: standard deviations (of logarithms), tempo by so much either way."""
