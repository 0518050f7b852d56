"""A person of a generated UTD-MHAD: stands still, swings an arm, stands still."""

import numpy as np

from tests.datasets.trees import standing
from wigwag.skeleton import Clip, from_kinect20

RATE_HZ = 18.75


def swing(
    subject: str = "s1",
    label: str = "a1",
    trial: int = 1,
    *,
    still_s: tuple[float, float] = (0.8, 0.8),
    move_s: float = 1.6,
    size: float = 1.0,
) -> Clip:
    """The right arm (odd actions) or the left goes up and down again; ``still_s`` of rest at either end."""
    raw = raw_swing(subject, label, trial, still_s=still_s, move_s=move_s, size=size)
    return Clip.at_rate(from_kinect20(raw), RATE_HZ, label, subject, f"{label}_{subject}_t{trial}")


def raw_swing(
    subject: str = "s1",
    label: str = "a1",
    trial: int = 1,
    *,
    still_s: tuple[float, float] = (0.8, 0.8),
    move_s: float = 1.6,
    size: float = 1.0,
) -> np.ndarray:
    """The same as 20 Kinect joints: metres, Kinect frame, (frames, 20, 3)."""
    rng = np.random.default_rng([trial, int(label[1:]), int(subject[1:])])
    before, moving, after = (round(s * RATE_HZ) for s in (still_s[0], move_s, still_s[1]))
    frames = before + moving + after
    joints = np.repeat(standing()[None], frames, axis=0) * size
    lift = np.zeros(frames)
    lift[before : before + moving] = np.sin(np.linspace(0, np.pi, moving)) ** 2
    arm = slice(9, 12) if int(label[1:]) % 2 else slice(5, 8)
    reach = np.array([[0.2], [0.6], [0.9]]) * size
    direction = np.array([np.cos(int(label[1:])), 1.0, -0.5])
    joints[:, arm] += lift[:, None, None] * reach * direction / np.linalg.norm(direction)
    return joints + rng.normal(0, 0.001, joints.shape)


def walk(
    subject: str = "utkinect_s02", seconds: float = 3.0, towards_m: float = 1.5, size: float = 1.1
) -> Clip:
    """Walk towards the camera; stiff legs swing about the hips."""
    frames = round(seconds * 30)
    times = np.arange(frames) / 30
    joints = np.repeat(standing()[None], frames, axis=0) * size
    joints[..., 2] -= towards_m * times[:, None] / seconds
    for side, sign in ((slice(13, 16), 1), (slice(17, 20), -1)):
        angle = 0.4 * sign * np.sin(2 * np.pi * times)[:, None]
        hip = joints[:, side.start - 1, None]
        leg = joints[:, side] - hip
        joints[:, side, 1] = hip[..., 1] + np.cos(angle) * leg[..., 1] - np.sin(angle) * leg[..., 2]
        joints[:, side, 2] = hip[..., 2] + np.sin(angle) * leg[..., 1] + np.cos(angle) * leg[..., 2]
    return Clip.at_rate(from_kinect20(joints), 30, None, subject, f"walk of {subject}")
