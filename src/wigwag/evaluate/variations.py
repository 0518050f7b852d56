"""Many clips from few: seeded variations of recorded ones, as other people and other days would give them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from wigwag.skeleton import Clip, Landmark

_HIPS, _CHEST = 13, 14
"""Hip centre and shoulder centre, which stand behind the 13 landmarks in the tree of the body."""

_PARENT: tuple[int, ...] = (_CHEST, _CHEST, _CHEST, 1, 2, 3, 4, _HIPS, _HIPS, 7, 8, 9, 10, -1, _HIPS)
"""What each of the 13 landmarks, the hips' and the shoulders' centre hangs on; -1: on nothing."""

_KIND: tuple[int, ...] = (0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 8)
"""Which length each hangs by: left and right share one; the last but one, where the hips are, is kept."""

_FIXED = 7

_LIMBS = (
    (Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW), (Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST),
    (Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW), (Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Spread:
    """How far variations lie from what was recorded; standard deviations."""

    bone: float = 0.08
    """Of the logarithm of a bone's length, the same on both sides."""
    yaw_rad: float = 0.15
    """Of the turn about the vertical that normalisation leaves."""
    warp: float = 0.04
    """Of the time warp, as a share of the duration."""
    crop: float = 0.06
    """Mean share of the duration that is cut off at either end."""
    noise: float = 0.01
    """Of each coordinate, in body sizes."""


class Variations:
    """Draw variations of normalised clips.

    Args:
        clips: Normalised clips, all with the same number of frames.
        frames: Frames of a variation.
        spread: How far they lie from the clips.
    """

    def __init__(self, clips: Sequence[Clip], frames: int = 24, spread: Spread | None = None) -> None:
        self.frames, self.spread = frames, spread or Spread()
        joints = np.stack([clip.joints for clip in clips]).astype(np.float32)
        hips = joints[:, :, [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean(axis=2)
        chest = joints[:, :, [Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER]].mean(axis=2)
        points = np.concatenate([joints, hips[:, :, None], chest[:, :, None]], axis=2)
        bones = points.copy()
        for i, parent in enumerate(_PARENT):
            if parent >= 0:
                bones[:, :, i] -= points[:, :, parent]
        self._bones = bones
        self._chain = np.zeros((13, len(_PARENT)), dtype=np.float32)
        for i in range(13):
            at = i
            while at >= 0:
                self._chain[i, at] = 1
                at = _PARENT[at]

    def batches(
        self, count: int, seed: int, batch: int = 4000
    ) -> Iterator[tuple[Float[np.ndarray, "batch frames 39"], Int[np.ndarray, " batch"]]]:
        """Yield ``count`` variations in batches, and the number of the clip that each comes from."""
        rng = np.random.default_rng(seed)
        for start in range(0, count, batch):
            origin = rng.integers(len(self._bones), size=min(batch, count - start))
            yield self._draw(origin, rng), origin

    def plain(self) -> Float[np.ndarray, "clips frames 39"]:
        """Return the clips themselves, brought to the same number of frames."""
        grid = np.broadcast_to(
            np.linspace(0, 1, self.frames, dtype=np.float32), (len(self._bones), self.frames)
        )
        joints = np.einsum("jb,ctbx->ctjx", self._chain, self._at(np.arange(len(self._bones)), grid))
        return np.asarray(joints.reshape(len(joints), self.frames, -1))

    def _draw(
        self, origin: Int[np.ndarray, " batch"], rng: np.random.Generator
    ) -> Float[np.ndarray, "batch frames 39"]:
        count, spread = len(origin), self.spread
        bones = self._at(origin, self._times(count, rng))
        lengths = np.exp(rng.normal(scale=spread.bone, size=(count, 9))).astype(np.float32)
        lengths[:, _FIXED] = 1
        bones *= lengths[:, None, list(_KIND), None]
        joints = np.matmul(self._chain, bones)
        start, stop = np.array(_LIMBS).T
        size = 4 * np.linalg.norm(joints[:, :, stop] - joints[:, :, start], axis=3).mean(axis=2)
        joints /= np.maximum(np.median(size, axis=1), 1e-9)[:, None, None, None]
        yaw = rng.normal(scale=spread.yaw_rad, size=count).astype(np.float32)
        cosine, sine = np.cos(yaw)[:, None, None], np.sin(yaw)[:, None, None]
        x, z = joints[..., 0].copy(), joints[..., 2].copy()
        joints[..., 0], joints[..., 2] = cosine * x + sine * z, cosine * z - sine * x
        joints += rng.standard_normal(joints.shape, dtype=np.float32) * np.float32(spread.noise)
        return np.asarray(joints.reshape(count, self.frames, -1))

    def _times(self, count: int, rng: np.random.Generator) -> Float[np.ndarray, "batch frames"]:
        """Draw what moment of the clip, 0 to 1, each frame shows: cropped, and smoothly warped."""
        even = np.linspace(0, 1, self.frames)
        ends = np.minimum(rng.exponential(self.spread.crop, size=(2, count, 1)), 0.2)
        slow, fast = rng.normal(scale=self.spread.warp, size=(2, count, 1))
        warped = even + slow * np.sin(np.pi * even) + fast / 2 * np.sin(2 * np.pi * even)
        warped = np.maximum.accumulate(np.clip(warped, 0, 1), axis=1)
        return np.asarray(ends[0] + warped * (1 - ends[0] - ends[1]), dtype=np.float32)

    def _at(
        self, origin: Int[np.ndarray, " batch"], times: Float[np.ndarray, "batch frames"]
    ) -> Float[np.ndarray, "batch frames 15 3"]:
        """Interpolate the bones linearly."""
        place = times * (self._bones.shape[1] - 1)
        before = np.minimum(place.astype(np.int64), self._bones.shape[1] - 2)
        weight = (place - before)[..., None, None].astype(np.float32)
        first = self._bones[origin[:, None], before]
        return np.asarray(first + weight * (self._bones[origin[:, None], before + 1] - first))


__all__ = ["Spread", "Variations"]
