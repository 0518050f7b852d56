"""Other people showing the same movement: bodies, tempo and camera varied at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Landmark

_LEFT_ARM = (Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST)
_RIGHT_ARM = (Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST)
_LEFT_LEG = (Landmark.LEFT_HIP, Landmark.LEFT_KNEE, Landmark.LEFT_HEEL)
_RIGHT_LEG = (Landmark.RIGHT_HIP, Landmark.RIGHT_KNEE, Landmark.RIGHT_HEEL)


@dataclass(frozen=True, slots=True)
class Augmentation:
    """How much varied copies of a clip differ from it; all spreads are standard deviations.

    Raises:
        InputError: If a setting is negative, or nothing of a clip would be left.
    """

    bones: float = 0.08
    """Relative spread of bone lengths, left and right alike."""
    tilt_deg: float = 5.0
    """Spread of pitch and roll of the camera."""
    warp: float = 0.15
    """How unevenly time runs, as a share of the clip."""
    tempo: float = 0.1
    """Relative spread of the tempo."""
    crop: float = 0.12
    """At most this share is cut off at each end."""

    def __post_init__(self) -> None:
        """Check the settings."""
        for name in ("bones", "tilt_deg", "warp", "tempo", "crop"):
            if not getattr(self, name) >= 0:
                raise InputError(f"Augmentation.{name} must be 0 or more, but got {getattr(self, name)}.")
        if self.crop >= 0.4:
            raise InputError(f"Augmentation.crop must be below 0.4, but got {self.crop}.")

    def apply(self, clip: Clip, rng: np.random.Generator) -> Clip:
        """Return a varied copy; label, subject and name stay."""
        joints = _turned(self._other_body(clip.joints, rng), np.radians(self.tilt_deg) * rng.normal(size=2))
        times = self._other_time(clip.times_s, rng)
        before, after = rng.uniform(0, self.crop, 2)
        first = int(before * len(clip))
        kept = slice(first, max(first + 4, len(clip) - int(after * len(clip))))
        stamps = clip.stamps_ns[0] + np.round(times * 1e9).astype(np.int64)
        return Clip(joints[kept], stamps[kept], clip.label, clip.subject, clip.name)

    def _other_body(
        self, joints: Float[np.ndarray, "frames 13 3"], rng: np.random.Generator
    ) -> Float[np.ndarray, "frames 13 3"]:
        trunk, width, neck, *limbs = np.exp(self.bones * rng.normal(size=7))
        hips = (joints[:, Landmark.LEFT_HIP] + joints[:, Landmark.RIGHT_HIP]) / 2
        chest = (joints[:, Landmark.LEFT_SHOULDER] + joints[:, Landmark.RIGHT_SHOULDER]) / 2
        other = joints.copy()
        raised = hips + trunk * (chest - hips)
        other[:, Landmark.NOSE] = raised + neck * (joints[:, Landmark.NOSE] - chest)
        for arm, leg in ((_LEFT_ARM, _LEFT_LEG), (_RIGHT_ARM, _RIGHT_LEG)):
            other[:, arm[0]] = raised + width * (joints[:, arm[0]] - chest)
            bones = (arm[:2], arm[1:], leg[:2], leg[1:])
            for (start, stop), factor in zip(bones, limbs, strict=True):
                other[:, stop] = other[:, start] + factor * (joints[:, stop] - joints[:, start])
        return np.asarray(other)

    def _other_time(
        self, times: Float[np.ndarray, " frames"], rng: np.random.Generator
    ) -> Float[np.ndarray, " frames"]:
        waves, phase = int(rng.integers(1, 3)), rng.uniform(0, 2 * np.pi)
        depth = self.warp * rng.normal() / (2 * np.pi * waves)
        share = times / times[-1]
        share = share + depth * (np.sin(2 * np.pi * waves * share + phase) - np.sin(phase))
        # Time never runs backwards, however strong the warp.
        steps = np.maximum(np.diff(share), 0.1 * np.diff(times) / times[-1])
        share = np.concatenate([[0.0], np.cumsum(steps)])
        return np.asarray(share / share[-1] * times[-1] * np.exp(self.tempo * rng.normal()))


def _turned(
    joints: Float[np.ndarray, "frames 13 3"], angles: Float[np.ndarray, " 2"]
) -> Float[np.ndarray, "frames 13 3"]:
    """Turn about x, then about z, around the middle of the hips of the first frame."""
    (ca, cb), (sa, sb) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, ca, -sa], [0.0, sa, ca]])
    about_z = np.array([[cb, -sb, 0.0], [sb, cb, 0.0], [0.0, 0.0, 1.0]])
    center = (joints[0, Landmark.LEFT_HIP] + joints[0, Landmark.RIGHT_HIP]) / 2
    return np.asarray((joints - center) @ (about_z @ about_x).T + center)
