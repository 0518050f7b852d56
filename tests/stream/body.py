"""A body whose arms move as told."""

import numpy as np

from wigwag.skeleton import Landmark, Pose

REST = np.zeros((13, 3))
REST[:, 2] = 4.0
for landmark, (x, y) in {
    Landmark.NOSE: (0, -0.75), Landmark.LEFT_SHOULDER: (0.2, -0.5), Landmark.RIGHT_SHOULDER: (-0.2, -0.5),
    Landmark.LEFT_ELBOW: (0.25, -0.2), Landmark.RIGHT_ELBOW: (-0.25, -0.2),
    Landmark.LEFT_WRIST: (0.25, 0.05), Landmark.RIGHT_WRIST: (-0.25, 0.05),
    Landmark.LEFT_HIP: (0.12, 0), Landmark.RIGHT_HIP: (-0.12, 0),
    Landmark.LEFT_KNEE: (0.12, 0.45), Landmark.RIGHT_KNEE: (-0.12, 0.45),
    Landmark.LEFT_HEEL: (0.12, 0.9), Landmark.RIGHT_HEEL: (-0.12, 0.9),
}.items():  # fmt: skip
    REST[landmark, :2] = x, y


class Body:
    """Raises and lowers both arms, at any frame rate, with measurement noise."""

    def __init__(self, rate_hz: float = 30.0, noise_m: float = 0.004, seed: int = 0) -> None:
        self.rate_hz, self.noise_m, self.now_s = rate_hz, noise_m, 0.0
        self.random = np.random.default_rng(seed)
        self.raised = 0.0

    def pose(self) -> Pose:
        joints = REST + self.random.normal(0, self.noise_m, REST.shape)
        for elbow, wrist in (
            (Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST),
            (Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST),
        ):
            joints[elbow, 1] -= 0.6 * self.raised
            joints[wrist, 1] -= 1.15 * self.raised
        return Pose(joints, np.ones(13), int(self.now_s * 1e9))

    def go(self, raised: float, seconds: float) -> list[Pose]:
        start, steps = self.raised, max(round(seconds * self.rate_hz), 1)
        poses = []
        for step in range(1, steps + 1):
            self.now_s += 1 / self.rate_hz
            self.raised = start + (raised - start) * step / steps
            poses.append(self.pose())
        return poses
