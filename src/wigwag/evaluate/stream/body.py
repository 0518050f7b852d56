"""One body for everything that is shown in a stream: limbs, where it stands, how it keeps still."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Landmark

_LIMBS: tuple[tuple[int, int], ...] = (
    (Landmark.LEFT_SHOULDER, Landmark.LEFT_ELBOW), (Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST),
    (Landmark.RIGHT_SHOULDER, Landmark.RIGHT_ELBOW), (Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST),
    (Landmark.LEFT_HIP, Landmark.LEFT_KNEE), (Landmark.LEFT_KNEE, Landmark.LEFT_HEEL),
    (Landmark.RIGHT_HIP, Landmark.RIGHT_KNEE), (Landmark.RIGHT_KNEE, Landmark.RIGHT_HEEL),
)  # fmt: skip
_HIPS = (Landmark.LEFT_HIP, Landmark.RIGHT_HIP)
_SHOULDERS = (Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER)
_HEELS = (Landmark.LEFT_HEEL, Landmark.RIGHT_HEEL)
_LEVEL = np.array([1.0, 0.0, 1.0])

QUIET_M_S = 0.12
"""A frame in which the fastest landmarks are slower than this shows a person who keeps still."""

SWAY_M = 0.006
"""Standard deviation of how a standing person's head sways, metres. In pauses of 1.5 s and more between the
gestures of MSRC-12 (101 of them) head and wrists wander by 3 to 7 mm, shoulders by 2 to 5, hips by 2 to 4."""

SWAY_S = 0.6
"""How long a sway lasts: the width of the Gaussian that it is smoothed with."""


@dataclass(frozen=True, slots=True)
class Limbs:
    """The lengths of one person's bones, metres."""

    lengths: Float[np.ndarray, 12]
    """The eight limbs (left arm, right arm, left leg, right leg), hips, trunk, shoulders, neck to nose."""

    @classmethod
    def of(cls, clips: Sequence[Clip]) -> Limbs:
        """Measure the median lengths over all frames of a person's clips.

        Raises:
            InputError: If there is no clip.
        """
        if not clips:
            raise InputError("Limbs are measured on one clip or more, but got none.")
        joints = np.concatenate([clip.joints for clip in clips])
        hips, shoulders = _middle(joints, _HIPS), _middle(joints, _SHOULDERS)
        bones = [joints[:, b] - joints[:, a] for a, b in _LIMBS]
        bones += [joints[:, 7] - joints[:, 8], shoulders - hips, joints[:, 1] - joints[:, 2]]
        bones.append(joints[:, Landmark.NOSE] - shoulders)
        return cls(np.array([float(np.median(np.linalg.norm(bone, axis=1))) for bone in bones]))

    @property
    def leg_m(self) -> float:
        """Thigh and shank, mean of both sides."""
        return float(self.lengths[4:8].sum()) / 2

    def wear(self, clip: Clip) -> Clip:
        """Return the movement of a clip in a body with these limbs.

        Every bone keeps its direction and takes the length here; the path of the hips is scaled by the
        length of the legs, so that steps fit.

        Args:
            clip: Another person's.
        """
        joints, own = clip.joints, Limbs.of([clip])
        hips = _middle(joints, _HIPS)
        scale = self.leg_m / max(own.leg_m, 1e-6)
        ground = _ground(joints[0])
        out = np.empty_like(joints)
        center = ground + (hips - ground) * scale
        trunk = _unit(_middle(joints, _SHOULDERS) - hips)
        half_hips = _unit(joints[:, 7] - joints[:, 8]) * self.lengths[8] / 2
        chest = center + trunk * self.lengths[9]
        half_shoulders = _unit(joints[:, 1] - joints[:, 2]) * self.lengths[10] / 2
        out[:, 7], out[:, 8] = center + half_hips, center - half_hips
        out[:, 1], out[:, 2] = chest + half_shoulders, chest - half_shoulders
        neck = _unit(joints[:, Landmark.NOSE] - _middle(joints, _SHOULDERS))
        out[:, Landmark.NOSE] = chest + neck * self.lengths[11]
        for number, (upper, lower) in enumerate(_LIMBS):
            out[:, lower] = out[:, upper] + _unit(joints[:, lower] - joints[:, upper]) * self.lengths[number]
        return Clip(out, clip.stamps_ns, clip.label, clip.subject, clip.name)


@dataclass(frozen=True, slots=True)
class Stance:
    """Where a person stands and which way they face."""

    ground: Float[np.ndarray, 3]
    """Between the feet, metres, camera optical frame; in height, the lower foot."""
    facing_rad: float
    """About the vertical; 0: facing the camera."""

    @classmethod
    def of(cls, joints: Float[np.ndarray, "13 3"]) -> Stance:
        """Read it off one frame."""
        return cls(_ground(joints), facing(joints))

    def put(
        self, joints: Float[np.ndarray, "frames 13 3"], turn_rad: float = 0.0, first: int = 0
    ) -> Float[np.ndarray, "frames 13 3"]:
        """Move and turn a sequence so that its frame ``first`` stands here.

        Args:
            joints: Metres, camera optical frame.
            turn_rad: Turned so much further than this stance.
            first: Which frame.
        """
        other = Stance.of(joints[first])
        turned = turn(joints - other.ground, self.facing_rad + turn_rad - other.facing_rad)
        return np.asarray(turned + self.ground)


def facing(joints: Float[np.ndarray, "13 3"]) -> float:
    """Return the angle of right-to-left across shoulders and hips from the camera's x axis, radians."""
    across = joints[1] - joints[2] + joints[7] - joints[8]
    return float(np.arctan2(across[2], across[0]))


def turn(joints: Float[np.ndarray, "*n 3"], angle_rad: float) -> Float[np.ndarray, "*n 3"]:
    """Turn about the vertical through the origin, so that :func:`facing` grows by the angle."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, z = joints[..., 0], joints[..., 2]
    return np.stack([c * x - s * z, joints[..., 1], s * x + c * z], axis=-1)


def activity(
    joints: Float[np.ndarray, "frames 13 3"], rate_hz: float, smooth_s: float = 0.08, fastest: int = 3
) -> Float[np.ndarray, " frames"]:
    """Return the mean speed of the fastest landmarks relative to the hips, m/s.

    Sideways and in depth the hips are the origin, frame by frame; in height they move too when a person
    sits or squats, and count.
    """
    relative = joints - _middle(joints, _HIPS)[:, None] * _LEVEL
    smooth = gaussian_filter1d(relative, smooth_s * rate_hz, axis=0, mode="nearest")
    speeds = np.linalg.norm(np.gradient(smooth, axis=0), axis=2) * rate_hz
    return np.asarray(np.sort(speeds, axis=1)[:, -fastest:].mean(axis=1))


def upright(joints: Float[np.ndarray, "13 3"], limbs: Limbs) -> bool:
    """Say whether a person stands with lowered arms: nothing that a gesture begins with by itself."""
    hips = float((joints[7, 1] + joints[8, 1]) / 2)
    shoulders = float((joints[1, 1] + joints[2, 1]) / 2)
    sunk = limbs.leg_m - (float(joints[[11, 12], 1].max()) - hips)
    wrists_low = float(min(joints[5, 1], joints[6, 1])) > (hips + shoulders) / 2
    return sunk < 0.08 and wrists_low


@dataclass(frozen=True, slots=True)
class Stillness:
    """How one person keeps still before the sensor: its jitter, and the body's sway.

    The jitter is measured on the quiet frames at the beginnings and ends of the person's own recordings.
    """

    jitter_m: Float[np.ndarray, "13 3"]
    """Standard deviation of what a landmark is off by from one moment to the next."""
    persistence: float
    """Correlation of a landmark's jitter between two frames of the recording, 0 to 1."""
    rate_hz: float
    """Frames a second of the recording."""

    @classmethod
    def of(cls, clips: Sequence[Clip], rate_hz: float) -> Stillness:
        """Measure it on a person's clips.

        Raises:
            InputError: If nowhere five frames in a row are quiet.
        """
        residuals, products, squares = [], 0.0, 0.0
        for clip in clips:
            for part in quiet_ends(clip.joints, rate_hz):
                steps = np.linspace(-1.0, 1.0, len(part))
                middle = part.mean(axis=0)
                slope = np.tensordot(steps, part - middle, axes=(0, 0)) / float(steps @ steps)
                rest = part - middle - steps[:, None, None] * slope
                residuals.append(rest * np.sqrt(len(part) / (len(part) - 2)))
                products += float((rest[1:] * rest[:-1]).sum()) / (len(part) - 1)
                squares += float((rest * rest).sum()) / len(part)
        if not residuals:
            raise InputError(
                f"Nobody keeps still for five frames at the ends of {len(clips)} clips: jitter is unknown."
            )
        return cls(
            np.sqrt((np.concatenate(residuals) ** 2).mean(axis=0)),
            float(np.clip(products / max(squares, 1e-12), 0.0, 0.95)),
            rate_hz,
        )

    def around(
        self, posture: Float[np.ndarray, "frames 13 3"], rate_hz: float, rng: np.random.Generator
    ) -> Float[np.ndarray, "frames 13 3"]:
        """Let a posture, or a slow path of postures, sway and jitter.

        Args:
            posture: Metres.
            rate_hz: Its frames a second.
            rng: Chooses the noise.
        """
        frames = len(posture)
        keep = self.persistence ** (self.rate_hz / rate_hz)
        fresh = rng.normal(size=(frames, 13, 3)) * np.sqrt(1 - keep**2)
        fresh[0] /= np.sqrt(1 - keep**2)
        jitter = np.empty_like(fresh)
        jitter[0] = fresh[0]
        for i in range(1, frames):
            jitter[i] = keep * jitter[i - 1] + fresh[i]
        return np.asarray(posture + jitter * self.jitter_m + _sway(posture, rate_hz, rng))


def quiet_ends(
    joints: Float[np.ndarray, "frames 13 3"], rate_hz: float, least: int = 5
) -> list[Float[np.ndarray, "quiet 13 3"]]:
    """Return the frames before a recording's first movement and after its last, if ``least`` or more."""
    moving = np.flatnonzero(activity(joints, rate_hz) > QUIET_M_S)
    if len(moving) == 0:
        return [joints] if len(joints) >= least else []
    ends = [joints[: moving[0]], joints[moving[-1] + 1 :]]
    return [end for end in ends if len(end) >= least]


def _sway(posture: np.ndarray, rate_hz: float, rng: np.random.Generator) -> np.ndarray:
    """Move the body above the feet slowly to and fro: more the higher a landmark is."""
    frames = len(posture)
    width = SWAY_S * rate_hz
    lead = int(4 * width)
    slow = gaussian_filter1d(rng.normal(size=(frames + 2 * lead, 4, 3)), width, axis=0, mode="wrap")
    slow = slow[lead : lead + frames] * np.sqrt(2 * np.sqrt(np.pi) * width) * SWAY_M
    slow[..., 1] *= 0.2
    ground = posture[..., 1].max(axis=1, keepdims=True)
    height = np.clip(
        (ground - posture[..., 1]) / np.maximum(np.ptp(posture[..., 1], axis=1), 1e-6)[:, None], 0, 1
    )
    body = height[..., None] * slow[:, :1]
    for column, joints in ((1, (3, 5)), (2, (4, 6)), (3, (0,))):
        body[:, joints] += 0.7 * slow[:, column : column + 1]
    return np.asarray(body)


def _middle(joints: Float[np.ndarray, "frames 13 3"], pair: tuple[int, int]) -> Float[np.ndarray, "frames 3"]:
    return np.asarray((joints[..., pair[0], :] + joints[..., pair[1], :]) / 2)


def _ground(joints: Float[np.ndarray, "13 3"]) -> Float[np.ndarray, 3]:
    point = _middle(joints, _HEELS)
    point[1] = max(joints[_HEELS[0], 1], joints[_HEELS[1], 1])
    return point


def _unit(vectors: Float[np.ndarray, "frames 3"]) -> Float[np.ndarray, "frames 3"]:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))


__all__ = [
    "QUIET_M_S", "SWAY_M", "SWAY_S", "Limbs", "Stance", "Stillness", "activity", "facing", "quiet_ends",
    "turn", "upright",
]  # fmt: skip
