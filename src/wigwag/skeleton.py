"""The 13 landmarks every room speaks of: ``Pose``, ``Clip``, the bones, and the maps into them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import InputError


class Landmark(IntEnum):
    """The 13 landmarks of the paper's section 2, in the order of every array."""

    NOSE = 0
    LEFT_SHOULDER = 1
    RIGHT_SHOULDER = 2
    LEFT_ELBOW = 3
    RIGHT_ELBOW = 4
    LEFT_WRIST = 5
    RIGHT_WRIST = 6
    LEFT_HIP = 7
    RIGHT_HIP = 8
    LEFT_KNEE = 9
    RIGHT_KNEE = 10
    LEFT_HEEL = 11
    RIGHT_HEEL = 12


LANDMARKS: tuple[str, ...] = tuple(landmark.name.lower() for landmark in Landmark)
"""Names of the landmarks, in order."""

N_LANDMARKS = len(LANDMARKS)

BONES: tuple[tuple[int, int], ...] = (
    (0, 1), (0, 2), (1, 2), (1, 3), (3, 5), (2, 4), (4, 6),
    (1, 7), (2, 8), (7, 8), (7, 9), (9, 11), (8, 10), (10, 12),
)  # fmt: skip
"""Pairs of landmarks that a drawing joins with a line."""

MIRROR: tuple[int, ...] = (0, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11)
"""For each landmark, the one on the other side of the body."""


@dataclass(frozen=True, slots=True)
class Pose:
    """One person's 3-D pose at one moment.

    Raises:
        InputError: If a shape is wrong or a joint is not a finite number.
    """

    joints: Float[np.ndarray, "13 3"]
    """Landmark positions in metres, camera optical frame (x right, y down, z forward)."""
    visibility: Float[np.ndarray, 13]
    """How surely each landmark is seen, 0 to 1. A landmark filled in from others has 0."""
    stamp_ns: int
    """When the frame was taken, monotonic nanoseconds."""
    sigma_m: Float[np.ndarray, 13] = field(default_factory=lambda: np.zeros(N_LANDMARKS))
    """One standard deviation of each landmark's place along its worst axis (the line of sight, mostly),
    metres, everything included. 0: taken as exact, as for poses that were made up or recorded."""
    distance_sigma_m: float = 0.0
    """The part of ``sigma_m`` that all landmarks share, metres: how uncertain the whole body's distance is.
    It matters without depth, where it outweighs the rest."""
    monocular: bool = False
    """Whether it was placed without depth, by the body's supposed size (``wigwag.pose.monocular``)."""

    def __post_init__(self) -> None:
        """Check shapes and finiteness once, where the value enters."""
        if np.shape(self.joints) != (N_LANDMARKS, 3):
            raise InputError(f"Pose.joints must have shape (13, 3), but got {np.shape(self.joints)}.")
        for name in ("visibility", "sigma_m"):
            if np.shape(getattr(self, name)) != (N_LANDMARKS,):
                raise InputError(
                    f"Pose.{name} must have shape (13,), but got {np.shape(getattr(self, name))}."
                )
        if not (np.isfinite(self.sigma_m).all() and np.min(self.sigma_m) >= 0):
            raise InputError("Pose.sigma_m must hold finite metres, 0 or more; 0 means exact.")
        if not 0 <= self.distance_sigma_m < np.inf:
            raise InputError(
                f"Pose.distance_sigma_m must be finite metres, 0 or more, but got {self.distance_sigma_m}."
            )
        if not np.isfinite(self.joints).all():
            raise InputError(
                "Pose.joints holds NaN or infinity; fill missing landmarks and set their visibility to 0."
            )

    @property
    def hip_center(self) -> Float[np.ndarray, 3]:
        """Midpoint of the hips, metres, camera optical frame."""
        return np.asarray((self.joints[Landmark.LEFT_HIP] + self.joints[Landmark.RIGHT_HIP]) / 2)


@dataclass(frozen=True, slots=True)
class Clip:
    """A finite sequence of one person's poses: what a recogniser takes.

    Joint positions may be in any rigid frame that stays fixed over the clip and whose y axis points
    down (camera optical); recognisers remove where the person stands.

    Raises:
        InputError: If there are fewer than two frames, a shape is wrong, a joint is not finite, or time
            does not run forward. The message starts with ``name``.
    """

    joints: Float[np.ndarray, "frames 13 3"]
    """Landmark positions in metres, camera optical frame."""
    stamps_ns: Int[np.ndarray, " frames"]
    """Strictly increasing monotonic nanoseconds."""
    label: str | None = None
    """The gesture shown; ``None``: not known, or a movement that is no gesture."""
    subject: str | None = None
    """Who shows it. Evaluation never lets one person stand on both sides of a split."""
    name: str = "clip"
    """Where it comes from (a file name); error messages start with it."""

    def __post_init__(self) -> None:
        """Check everything once, where the value enters."""
        shape = np.shape(self.joints)
        if len(shape) != 3 or shape[1:] != (N_LANDMARKS, 3):
            raise InputError(
                f"{self.name}: joints must have shape (frames, 13, 3), but got {shape}. "
                "Map other skeletons with wigwag.skeleton.from_kinect20 or from_blazepose33."
            )
        if shape[0] < 2:
            raise InputError(f"{self.name}: a clip needs at least 2 frames, but got {shape[0]}.")
        if not np.isfinite(self.joints).all():
            bad = int(np.argmin(np.isfinite(self.joints).all(axis=(1, 2))))
            raise InputError(
                f"{self.name}: joints hold NaN or infinity, first in frame {bad}. Fill or drop such frames."
            )
        if np.shape(self.stamps_ns) != shape[:1]:
            raise InputError(
                f"{self.name}: stamps_ns must have shape ({shape[0]},), one a frame, "
                f"but got {np.shape(self.stamps_ns)}."
            )
        if (steps := np.diff(self.stamps_ns)).min() <= 0:
            bad = int(np.argmin(steps > 0)) + 1
            raise InputError(
                f"{self.name}: time must run forward, but frame {bad} is {int(steps[bad - 1])} ns "
                "after the frame before it. Sort the frames and drop repeated ones."
            )

    def __len__(self) -> int:
        return len(self.stamps_ns)

    @property
    def times_s(self) -> Float[np.ndarray, " frames"]:
        """Seconds since the first frame."""
        return np.asarray((self.stamps_ns - self.stamps_ns[0]) * 1e-9)

    @property
    def duration_s(self) -> float:
        """Seconds from the first frame to the last."""
        return float(self.stamps_ns[-1] - self.stamps_ns[0]) * 1e-9

    @classmethod
    def from_poses(
        cls,
        poses: Sequence[Pose],
        label: str | None = None,
        subject: str | None = None,
        name: str = "clip",
    ) -> Clip:
        """Join poses, oldest first, into a clip."""
        if not poses:
            raise InputError(f"{name}: a clip needs at least 2 frames, but got 0.")
        return cls(
            np.stack([p.joints for p in poses]),
            np.array([p.stamp_ns for p in poses], dtype=np.int64),
            label,
            subject,
            name,
        )

    @classmethod
    def at_rate(
        cls,
        joints: Float[np.ndarray, "frames 13 3"],
        rate_hz: float,
        label: str | None = None,
        subject: str | None = None,
        name: str = "clip",
    ) -> Clip:
        """Build a clip from frames taken at one steady rate.

        Example:
            >>> import numpy as np
            >>> Clip.at_rate(np.zeros((31, 13, 3)), rate_hz=30).duration_s
            1.0
        """
        stamps = np.round(np.arange(len(joints)) * (1e9 / rate_hz)).astype(np.int64)
        return cls(joints, stamps, label, subject, name)


KINECT20: tuple[str, ...] = (
    "head", "shoulder_center", "spine", "hip_center", "left_shoulder", "left_elbow", "left_wrist",
    "left_hand", "right_shoulder", "right_elbow", "right_wrist", "right_hand", "left_hip", "left_knee",
    "left_ankle", "left_foot", "right_hip", "right_knee", "right_ankle", "right_foot",
)  # fmt: skip
"""The Kinect-20 joints in UTD-MHAD's order."""

_FROM_KINECT20 = (
    "head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
    "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle",
)  # fmt: skip

_FROM_BLAZEPOSE33 = (0, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 29, 30)


def from_kinect20(
    joints: Float[np.ndarray, "*batch 20 3"], names: Sequence[str] = KINECT20
) -> Float[np.ndarray, "*batch 13 3"]:
    """Map Kinect-20 joints into the 13 landmarks and into the camera optical frame.

    Kinect has neither nose nor heels: its head and ankles stand in for them.

    Args:
        joints: Metres, Kinect frame: y up, z away from the camera, the person's right side at +x.
        names: The name of each of the 20 joints, in the order of the array.

    Returns:
        Metres, camera optical frame (x right, y down, z forward), the order of ``LANDMARKS``.

    Raises:
        InputError: If the array does not hold 20 joints or a needed name is absent.
    """
    joints = np.asarray(joints)
    if joints.ndim < 2 or joints.shape[-2:] != (len(names), 3):
        raise InputError(f"Kinect joints must have shape (..., {len(names)}, 3), but got {joints.shape}.")
    if absent := sorted(set(_FROM_KINECT20) - set(names)):
        raise InputError(f"Kinect joint names lack {absent}; expected {KINECT20} in any order.")
    index = [list(names).index(name) for name in _FROM_KINECT20]
    return np.asarray(joints[..., index, :] * np.array([-1.0, -1.0, 1.0]))


def from_blazepose33(
    points: Float[np.ndarray, "*batch 33 dims"], head: str = "nose"
) -> Float[np.ndarray, "*batch 13 dims"]:
    """Pick the 13 landmarks out of BlazePose's 33; works on pixels, metres and visibilities alike.

    Args:
        points: The last axis may have any length; the one before it holds the 33 landmarks.
        head: ``"nose"`` as in the paper, or ``"ears"``: the middle of the ears, which is where a
            Kinect puts its head joint.

    Raises:
        InputError: If the array does not hold 33 landmarks.
    """
    points = np.asarray(points)
    if points.ndim < 2 or points.shape[-2] != 33:
        raise InputError(f"BlazePose landmarks must have shape (..., 33, dims), but got {points.shape}.")
    picked = points[..., _FROM_BLAZEPOSE33, :]
    if head == "ears":
        picked[..., 0, :] = (points[..., 7, :] + points[..., 8, :]) / 2
    elif head != "nose":
        raise InputError(f"head must be 'nose' or 'ears', but got {head!r}.")
    return np.asarray(picked)


def mirrored(clip: Clip) -> Clip:
    """Return the clip as seen in a mirror: left and right change places. The label stays as it is."""
    joints = clip.joints[:, MIRROR, :] * np.array([-1.0, 1.0, 1.0])
    return Clip(joints, clip.stamps_ns, clip.label, clip.subject, f"{clip.name} (mirrored)")


__all__ = [
    "BONES", "KINECT20", "LANDMARKS", "MIRROR", "N_LANDMARKS", "Clip", "Landmark", "Pose",
    "from_blazepose33", "from_kinect20", "mirrored",
]  # fmt: skip
