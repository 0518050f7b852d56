"""Recorded skeletons drive the operator: resampled, smoothed, stood on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

from wigwag.errors import InputError
from wigwag.sim.gestures import TABLE_HZ
from wigwag.sim.person import JOINT

_INTO_BODY = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Kinect (the person's right +x, y up, z away from the camera) to body (forward, left, up): the person
who faces the camera looks along -z."""

_SINKING_M_S = 0.6
"""Greatest speed of the hips when the operator sits down to begin a recording."""


@dataclass(frozen=True, slots=True)
class Replay:
    """A recording made ready to be shown: the operator moves into it, shows it, and moves out of it."""

    name: str
    """Where it comes from."""
    joints: Float[np.ndarray, "rows 20 3"]
    """Metres, ``TABLE_HZ`` rows a second; x towards where the recording camera stood, y to the person's
    left, z up, the ground at 0, the hip centre of the first row above the origin."""
    blend_s: tuple[float, float] = (0.4, 0.4)
    """Seconds of moving from standing into the first row, and out of the last."""
    hold_s: tuple[float, float] = (0.0, 0.0)
    """Seconds of keeping still in the first row, and in the last."""

    @property
    def recording_s(self) -> float:
        """Length of the recording itself."""
        return (len(self.joints) - 1) / TABLE_HZ

    @property
    def lead_s(self) -> float:
        """Seconds before the recording begins."""
        return self.blend_s[0] + self.hold_s[0]

    @property
    def duration_s(self) -> float:
        """Seconds from standing to standing."""
        return self.lead_s + self.recording_s + self.hold_s[1] + self.blend_s[1]

    def at(self, since_s: float) -> Float[np.ndarray, "20 3"]:
        """Return the recorded body ``since_s`` seconds after its start, held at either end."""
        place = float(np.clip((since_s - self.lead_s) * TABLE_HZ, 0, len(self.joints) - 1))
        row = min(int(place), len(self.joints) - 2)
        part = place - row
        return np.asarray((1 - part) * self.joints[row] + part * self.joints[row + 1])

    def weight(self, since_s: float) -> float:
        """How much of the recording and how little of standing is in the body now, 0 to 1."""
        rising = since_s / self.blend_s[0]
        falling = (self.duration_s - since_s) / self.blend_s[1]
        phase = float(np.clip(min(rising, falling), 0, 1))
        return phase**3 * (10 - 15 * phase + 6 * phase**2)


def replay(
    joints: Float[np.ndarray, "frames 20 3"],
    rate_hz: float = 18.75,
    name: str = "recording",
    *,
    smooth_s: float = 0.04,
    blend_s: float = 0.4,
    settle_s: float = 0.7,
) -> Replay:
    """Make a recorded skeleton ready to be shown.

    Args:
        joints: Kinect-20 joints in ``wigwag.skeleton.KINECT20``'s order, metres, Kinect frame: y up, z
            away from the camera, the person's right side at +x.
        rate_hz: Frames a second of the recording; UTD-MHAD's true rate is about 18.75.
        name: For error messages.
        smooth_s: Standard deviation of the Gaussian that takes out the sensor's jitter; 0: none.
        blend_s: Time for moving from standing into the recording and back. An end at which the recorded
            person sits or stoops takes longer, as long as sitting down does.
        settle_s: Seconds of stillness at an end of that kind, as people sit before they stand up.

    Raises:
        InputError: If the shape is wrong, there are fewer than two frames, or a joint is not finite.
    """
    joints = np.asarray(joints, dtype=np.float64)
    if joints.ndim != 3 or joints.shape[1:] != (20, 3) or len(joints) < 2:
        raise InputError(f"{name}: a recording must have shape (2 or more, 20, 3), but got {joints.shape}.")
    if not np.isfinite(joints).all():
        bad = int(np.argmin(np.isfinite(joints).all(axis=(1, 2))))
        raise InputError(f"{name}: joints hold NaN or infinity, first in frame {bad}. Drop such recordings.")
    if rate_hz <= 0:
        raise InputError(f"{name}: rate_hz must be above 0, but got {rate_hz}.")
    body = joints @ _INTO_BODY.T
    if smooth_s > 0:
        body = gaussian_filter1d(body, smooth_s * rate_hz, axis=0, mode="nearest")
    times = np.arange(len(body)) / rate_hz
    rows = np.arange(int(np.floor(times[-1] * TABLE_HZ)) + 1) / TABLE_HZ
    table = CubicSpline(times, body, axis=0)(rows)
    table[..., :2] -= table[0, JOINT["hip_center"], :2]
    table[..., 2] -= _ground(table)
    sunk = [_sunk_m(table, row) for row in (0, -1)]
    blends = [max(blend_s, 1.875 * depth / _SINKING_M_S) for depth in sunk]  # min-jerk peaks at 1.875 x mean
    holds = [settle_s if depth > 0.12 else 0.0 for depth in sunk]
    # Half the memory: a person has a hundred of them.
    return Replay(name, table.astype(np.float32), (blends[0], blends[1]), (holds[0], holds[1]))


def _sunk_m(table: Float[np.ndarray, "rows 20 3"], row: int) -> float:
    """How much lower the hips are in a row than the recording's legs would hold them, metres."""
    legs, height = 0.0, 0.0
    for side in ("left", "right"):
        hip, knee, ankle = (table[:, JOINT[f"{side}_{name}"]] for name in ("hip", "knee", "ankle"))
        lengths = np.linalg.norm(hip - knee, axis=1) + np.linalg.norm(knee - ankle, axis=1)
        legs += float(np.median(lengths)) / 2
        height += float(hip[row, 2] - ankle[row, 2]) / 2
    return max(0.0, legs - height)


def _ground(table: Float[np.ndarray, "rows 20 3"]) -> float:
    """Height of the floor: where the lower foot is nearly always, and a sole's thickness below it."""
    feet = table[:, [JOINT["left_foot"], JOINT["right_foot"]], 2].min(axis=1)
    return float(np.quantile(feet, 0.2)) - 0.03
