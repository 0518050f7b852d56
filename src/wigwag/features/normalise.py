"""Where the person stands, how large they are and how they are turned is taken out of a clip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Landmark

UP = np.array([0.0, -1.0, 0.0])
"""Up in the camera optical frame, whose y axis points down."""

_LEFT_SIDE = [Landmark.LEFT_SHOULDER, Landmark.LEFT_HIP]
_RIGHT_SIDE = [Landmark.RIGHT_SHOULDER, Landmark.RIGHT_HIP]
_LIMBS = (
    (Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW), (Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST),
    (Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW), (Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Normalisation:
    """The three stages of the paper's section 2, and named alternatives to each.

    The result stays in camera axes (x right, y down, z forward), without unit: it is measured in body
    sizes. ``Normalisation.paper()`` is the paper's form.

    Raises:
        InputError: If a setting is not one of those named.
    """

    origin: Literal["hips", "start", "drift"] = "drift"
    """``"hips"``: the midpoint of the hips, frame by frame (paper). ``"start"``: the midpoint of the hips
    over the first frames, so that walking and sitting down stay visible. ``"drift"``: frame by frame
    sideways and in depth, of the first frames in height: sitting down stays visible, a drifting camera
    does not."""
    size: Literal["torso", "arms"] = "arms"
    """``"torso"``: the larger of torso length times ``torso_multiplier`` and the largest distance of a
    landmark from the origin (paper). ``"arms"``: four times the mean length of upper arm and forearm,
    which depends neither on where a pose network puts the hips nor on how far the arms reach."""
    size_over: Literal["frame", "clip"] = "clip"
    """Divide each frame by its own size (paper), or the clip by the median over its frames."""
    upright: Literal["no", "frame", "clip"] = "no"
    """Turn hip centre -> shoulder centre to point up: not at all, frame by frame, or all frames by the
    one turn that does it for the first frames."""
    face_camera: bool = True
    """Turn the clip about the vertical so that the shoulders and hips of its first frames stand square
    to the camera."""
    torso_multiplier: float = 2.5
    """How many torso lengths a body is large."""
    first_s: float = 0.3
    """How long 'the first frames' last, seconds."""

    def __post_init__(self) -> None:
        """Check the settings."""
        for field, value, known in (
            ("origin", self.origin, ("hips", "start", "drift")),
            ("size", self.size, ("torso", "arms")),
            ("size_over", self.size_over, ("frame", "clip")),
            ("upright", self.upright, ("no", "frame", "clip")),
        ):
            if value not in known:
                raise InputError(f"Normalisation.{field} must be one of {known}, but got {value!r}.")
        if not self.torso_multiplier > 0:
            raise InputError(
                f"Normalisation.torso_multiplier must be positive, but got {self.torso_multiplier}."
            )

    @classmethod
    def paper(cls, *, upright: bool = False) -> Normalisation:
        """Return the paper's form: every stage frame by frame, the optional third one on request."""
        turn: Literal["no", "frame"] = "frame" if upright else "no"
        return cls(origin="hips", size="torso", size_over="frame", upright=turn, face_camera=False)

    def apply(self, clip: Clip) -> Clip:
        """Return the normalised clip; stamps, label, subject and name stay."""
        joints = np.asarray(clip.joints, dtype=np.float64)
        first = clip.times_s <= self.first_s
        joints = joints - self._origin(joints, first)
        joints = joints / self._size(joints)
        if self.upright != "no":
            joints = self._stand_upright(joints, first)
        if self.face_camera:
            joints = _face_camera(joints, first)
        return Clip(joints, clip.stamps_ns, clip.label, clip.subject, clip.name)

    def _origin(
        self, joints: Float[np.ndarray, "frames 13 3"], first: np.ndarray
    ) -> Float[np.ndarray, "any 1 3"]:
        hips = _hip_center(joints)[:, None, :]  # eq. translation: the midpoint of the hips
        if self.origin == "hips":
            return hips
        start = hips[first].mean(axis=0, keepdims=True)
        if self.origin == "start":
            return np.asarray(start)
        hips = hips.copy()
        hips[:, :, 1] = start[:, :, 1]
        return hips

    def _size(self, joints: Float[np.ndarray, "frames 13 3"]) -> Float[np.ndarray, "any 1 1"]:
        if self.size == "torso":
            torso = np.linalg.norm(_shoulder_center(joints) - _hip_center(joints), axis=1)
            # Distances from the hips, not from the origin of the clip: walking must not shrink a person.
            reach = np.linalg.norm(joints - _hip_center(joints)[:, None, :], axis=2).max(axis=1)
            size = np.maximum(torso * self.torso_multiplier, reach)  # eq. scale
        else:
            start, stop = np.array(_LIMBS).T
            size = 4.0 * np.linalg.norm(joints[:, stop] - joints[:, start], axis=2).mean(axis=1)
        if self.size_over == "clip":
            size = np.median(size, keepdims=True)
        # A body without extent (all landmarks in one point) stays in one point.
        return np.asarray(np.where(size > 1e-9, size, 1.0)[:, None, None])

    def _stand_upright(
        self, joints: Float[np.ndarray, "frames 13 3"], first: np.ndarray
    ) -> Float[np.ndarray, "frames 13 3"]:
        spine = _shoulder_center(joints) - _hip_center(joints)
        if self.upright == "clip":
            spine = spine[first].mean(axis=0, keepdims=True)
        turn = _rotation_between(spine, UP)  # eq. orientation: hip centre -> shoulder centre points up
        hips = _hip_center(joints)[:, None, :] if self.upright == "frame" else 0.0
        return np.asarray(np.matmul(joints - hips, turn.transpose(0, 2, 1)) + hips)


def _hip_center(joints: Float[np.ndarray, "frames 13 3"]) -> Float[np.ndarray, "frames 3"]:
    return np.asarray((joints[:, Landmark.LEFT_HIP] + joints[:, Landmark.RIGHT_HIP]) / 2)


def _shoulder_center(joints: Float[np.ndarray, "frames 13 3"]) -> Float[np.ndarray, "frames 3"]:
    return np.asarray((joints[:, Landmark.LEFT_SHOULDER] + joints[:, Landmark.RIGHT_SHOULDER]) / 2)


def _rotation_between(
    start: Float[np.ndarray, "frames 3"], stop: Float[np.ndarray, " 3"]
) -> Float[np.ndarray, "frames 3 3"]:
    """Return the smallest rotation that turns each vector to the unit vector ``stop`` (Rodrigues).

    A vector of no length is left alone; an opposite one is turned half way round the z axis (over one
    shoulder), since every axis across it would do.
    """
    length = np.linalg.norm(start, axis=1, keepdims=True)
    unit = np.where(length > 1e-9, start / np.maximum(length, 1e-9), stop)
    axis = np.cross(unit, stop)
    cosine = unit @ stop
    cross = np.zeros((len(start), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = axis
    cross -= cross.transpose(0, 2, 1)
    opposite = cosine < -1 + 1e-9
    factor = 1 / np.where(opposite, 1.0, 1 + cosine)
    turn = np.eye(3) + cross + cross @ cross * factor[:, None, None]
    turn[opposite] = np.diag([-1.0, -1.0, 1.0])
    return turn


def _face_camera(
    joints: Float[np.ndarray, "frames 13 3"], first: np.ndarray
) -> Float[np.ndarray, "frames 13 3"]:
    """Turn about the vertical until right -> left of shoulders and hips has no depth."""
    across = (joints[:, _LEFT_SIDE] - joints[:, _RIGHT_SIDE])[first].mean(axis=(0, 1))
    length = float(np.hypot(across[0], across[2]))
    if length < 1e-9:
        return joints
    # A person who faces the camera has their left side at +x.
    cosine, sine = across[0] / length, across[2] / length
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return np.asarray(joints @ turn.T)
