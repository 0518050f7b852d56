"""Who the simulated operator is: sizes of the limbs and habits of moving, drawn from a seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.skeleton import KINECT20

Side = Literal["left", "right"]

JOINT: dict[str, int] = {name: i for i, name in enumerate(KINECT20)}
"""Index of each Kinect-20 joint by name."""

_PARENT_NAMES: dict[str, str | None] = {
    "hip_center": None,
    "spine": "hip_center", "shoulder_center": "spine", "head": "shoulder_center",
    "left_shoulder": "shoulder_center", "left_elbow": "left_shoulder",
    "left_wrist": "left_elbow", "left_hand": "left_wrist",
    "right_shoulder": "shoulder_center", "right_elbow": "right_shoulder",
    "right_wrist": "right_elbow", "right_hand": "right_wrist",
    "left_hip": "hip_center", "left_knee": "left_hip", "left_ankle": "left_knee", "left_foot": "left_ankle",
    "right_hip": "hip_center", "right_knee": "right_hip",
    "right_ankle": "right_knee", "right_foot": "right_ankle",
}  # fmt: skip

TREE: tuple[tuple[int, int], ...] = tuple(
    (JOINT[child], JOINT[parent]) for child, parent in _PARENT_NAMES.items() if parent is not None
)
"""The 19 bones as (child, parent), parents first; the root is ``hip_center``."""

# Share of the stature, from the mean of UTD-MHAD's Kinect skeletons (whose head-to-ankle distance is
# about 0.9 of the stature) and anthropometric tables for the arms, which a Kinect makes too short.
_SHARES = {
    "spine_m": 0.047, "chest_m": 0.204, "neck_m": 0.112, "shoulder_half_m": 0.100, "shoulder_drop_m": 0.055,
    "upper_arm_m": 0.162, "forearm_m": 0.142, "hand_m": 0.045, "hip_half_m": 0.044, "hip_drop_m": 0.045,
    "thigh_m": 0.261, "shin_m": 0.220, "foot_m": 0.075, "ankle_height_m": 0.046,
}  # fmt: skip

_UPRIGHT = ("ankle_height_m", "shin_m", "thigh_m", "hip_drop_m", "spine_m", "chest_m", "neck_m")
"""What stands on top of each other from the ground to the middle of the head."""

_CROWN = 0.065
"""Middle of the head to its top, share of the stature."""


@dataclass(frozen=True, slots=True)
class Person:
    """A body's sizes and its owner's habits. ``Person.random`` draws one; every field may be set.

    Lengths are in metres between Kinect-20 joints, whose hips lie higher and closer together than the
    hip joints of anatomy.
    """

    seed: int = 0
    """Names the person; what is random about them, clothes included, follows from it."""
    height_m: float = 1.75
    """Stature from the ground to the top of the head."""
    spine_m: float = 0.082
    """Hip centre to the middle of the spine."""
    chest_m: float = 0.357
    """Middle of the spine to the shoulder centre."""
    neck_m: float = 0.196
    """Shoulder centre to the middle of the head."""
    shoulder_half_m: float = 0.175
    """Half the width of the shoulders."""
    shoulder_drop_m: float = 0.096
    """How far the shoulder joints lie below the shoulder centre."""
    upper_arm_m: float = 0.284
    """Shoulder to elbow."""
    forearm_m: float = 0.249
    """Elbow to wrist."""
    hand_m: float = 0.079
    """Wrist to the middle of the hand."""
    hip_half_m: float = 0.077
    """Half the distance between the hip joints."""
    hip_drop_m: float = 0.079
    """How far the hip joints lie below the hip centre."""
    thigh_m: float = 0.457
    """Hip to knee."""
    shin_m: float = 0.385
    """Knee to ankle."""
    foot_m: float = 0.131
    """Ankle to the middle of the foot."""
    ankle_height_m: float = 0.081
    """The ankle's height above the ground when the foot stands flat."""
    stance_half_m: float = 0.11
    """Half the distance of the ankles when standing."""
    handedness: Side = "right"
    """The hand that waves, scratches and throws."""
    tempo: float = 1.0
    """Speed of gestures, 0.75 to 1.3 times the ordinary."""
    amplitude: float = 1.0
    """Size of gestures; 1 is textbook."""
    elbow_bend_rad: float = 0.12
    """What is added to every elbow that ought to be straight."""
    lag_s: float = 0.0
    """How much later the left arm moves than the right; negative: earlier."""
    side_ratio: float = 1.0
    """Excursion of the left arm over that of the right."""
    forward_rad: float = 0.1
    """How far in front of the shoulders' plane the arms are carried when raised sideways."""
    sloppiness: float = 1.0
    """Scales how much one repetition differs from the next."""
    tremor_rad: float = 0.004
    """Amplitude of the arms' trembling."""
    sway_m: float = 0.010
    """Amplitude of the shift of weight from foot to foot while standing."""
    rest_raise_rad: float = 0.16
    """How far the hanging upper arms stand off the trunk."""
    rest_bend_rad: float = 0.3
    """Elbow bend of the hanging arms."""

    def __post_init__(self) -> None:
        """Check that the body can stand."""
        for name in _SHARES:
            if not getattr(self, name) > 0:
                raise InputError(f"Person.{name} must be a length above 0 m, but got {getattr(self, name)}.")
        if not 0.2 <= self.tempo <= 5:
            raise InputError(f"Person.tempo must lie within 0.2 and 5, but got {self.tempo}.")

    @classmethod
    def random(cls, seed: int) -> Person:
        """Draw a person: stature 1.55 to 1.95 m, limbs, tempo 0.75 to 1.3, habits.

        Example:
            >>> Person.random(3) == Person.random(3), Person.random(3) == Person.random(4)
            (True, False)
        """
        rng = np.random.default_rng([0x9E25, seed])
        height = float(np.clip(rng.normal(1.74, 0.09), 1.55, 1.95))
        # One factor for the legs against the trunk, one for the arms, one for the breadth, then each bone.
        legs, arms, breadth = np.exp(rng.normal(0, [0.025, 0.035, 0.06]))
        group = {
            "upper_arm_m": arms, "forearm_m": arms, "hand_m": arms, "thigh_m": legs, "shin_m": legs,
            "spine_m": 2 - legs, "chest_m": 2 - legs, "shoulder_half_m": breadth, "hip_half_m": breadth,
        }  # fmt: skip
        sizes: dict[str, Any] = {
            name: float(height * share * group.get(name, 1.0) * np.exp(rng.normal(0, 0.02)))
            for name, share in _SHARES.items()
        }
        # However the bones share it, the stature is what was drawn.
        stretch = (1 - _CROWN) * height / sum(sizes[name] for name in _UPRIGHT)
        sizes |= {name: stretch * sizes[name] for name in _UPRIGHT}
        return cls(
            seed=seed,
            height_m=height,
            **sizes,
            stance_half_m=float(height * rng.uniform(0.05, 0.075)),
            handedness="right" if rng.random() < 0.88 else "left",
            tempo=float(np.clip(np.exp(rng.normal(0, 0.15)), 0.75, 1.3)),
            amplitude=float(np.clip(rng.normal(1.0, 0.06), 0.87, 1.12)),
            elbow_bend_rad=float(np.clip(rng.normal(0.14, 0.09), 0.02, 0.40)),
            lag_s=float(np.clip(rng.normal(0, 0.025), -0.06, 0.06)),
            side_ratio=float(np.clip(rng.normal(1, 0.03), 0.92, 1.08)),
            forward_rad=float(np.clip(rng.normal(0.12, 0.09), -0.05, 0.35)),
            sloppiness=float(rng.uniform(0.6, 1.3)),
            tremor_rad=float(rng.uniform(0.001, 0.006)),
            sway_m=float(rng.uniform(0.004, 0.014)),
            rest_raise_rad=float(rng.uniform(0.10, 0.24)),
            rest_bend_rad=float(rng.uniform(0.15, 0.45)),
        )

    @classmethod
    def like(cls, joints: Float[np.ndarray, "frames 20 3"], seed: int = 0) -> Person:
        """Measure a person's limbs on a recorded skeleton: the median length of each bone, sides averaged.

        Args:
            joints: Kinect-20 joints in metres, any rigid frame.
            seed: Names the person; gives clothes and habits.

        Raises:
            InputError: If the array is not (frames, 20, 3) or a bone has no length.
        """
        joints = np.asarray(joints, dtype=np.float64)
        if joints.ndim != 3 or joints.shape[1:] != (20, 3) or len(joints) == 0:
            raise InputError(f"A recorded skeleton must have shape (frames, 20, 3), but got {joints.shape}.")

        def length(a: str, b: str) -> float:
            pairs = [(a, b)] if "*" not in a + b else [(a.replace("*", s), b.replace("*", s)) for s in _SIDES]
            spans = [np.linalg.norm(joints[:, JOINT[p]] - joints[:, JOINT[q]], axis=1) for p, q in pairs]
            return float(np.mean([np.median(span) for span in spans]))

        def drop(reach: float, half: float) -> float:
            return float(np.sqrt(max(reach**2 - half**2, 0.01**2)))

        shoulder_half = length("left_shoulder", "right_shoulder") / 2
        hip_half = length("left_hip", "right_hip") / 2
        sizes: dict[str, Any] = {
            "spine_m": length("hip_center", "spine"),
            "chest_m": length("spine", "shoulder_center"),
            "neck_m": length("shoulder_center", "head"),
            "shoulder_half_m": shoulder_half,
            "shoulder_drop_m": drop(length("shoulder_center", "*_shoulder"), shoulder_half),
            "upper_arm_m": length("*_shoulder", "*_elbow"),
            "forearm_m": length("*_elbow", "*_wrist"),
            "hand_m": length("*_wrist", "*_hand"),
            "hip_half_m": hip_half,
            "hip_drop_m": drop(length("hip_center", "*_hip"), hip_half),
            "thigh_m": length("*_hip", "*_knee"),
            "shin_m": length("*_knee", "*_ankle"),
            "foot_m": length("*_ankle", "*_foot"),
        }
        tall = sizes["spine_m"] + sizes["chest_m"] + sizes["neck_m"] + sizes["hip_drop_m"]
        tall += sizes["thigh_m"] + sizes["shin_m"]
        # Middle of the head down to the ankles is 0.9 of the stature (UTD-MHAD's skeletons).
        height = tall / 0.9
        base = cls.random(seed)
        habits: dict[str, Any] = {
            name: getattr(base, name) for name in cls.__slots__ if name not in (*_SHARES, "seed", "height_m")
        }
        habits["stance_half_m"] = base.stance_half_m * height / base.height_m
        sizes["ankle_height_m"] = _SHARES["ankle_height_m"] * height
        return cls(seed=seed, height_m=height, **sizes, **habits)

    @property
    def leg_m(self) -> float:
        """Hip to ankle, stretched."""
        return self.thigh_m + self.shin_m

    @property
    def hip_center_height_m(self) -> float:
        """Height of the hip centre when standing with knees nearly straight."""
        return self.ankle_height_m + 0.988 * self.leg_m + self.hip_drop_m


_SIDES: tuple[Side, Side] = ("left", "right")
