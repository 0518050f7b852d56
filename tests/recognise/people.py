"""A few people who move their arms in a few ways: enough to tell gestures apart, quick to learn from."""

import numpy as np

from wigwag.skeleton import Clip, Landmark

STANDING = np.array(
    [
        [0.0, -0.65, 3.0], [0.18, -0.45, 3.0], [-0.18, -0.45, 3.0], [0.22, -0.18, 3.0], [-0.22, -0.18, 3.0],
        [0.24, 0.06, 2.98], [-0.24, 0.06, 2.98], [0.1, 0.05, 3.0], [-0.1, 0.05, 3.0], [0.11, 0.45, 3.0],
        [-0.11, 0.45, 3.0], [0.12, 0.85, 3.05], [-0.12, 0.85, 3.05],
    ]
)  # fmt: skip
L, R = Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST
LE, RE = Landmark.LEFT_ELBOW, Landmark.RIGHT_ELBOW


def _move(kind: str, phase: np.ndarray) -> np.ndarray:
    """Displacements (frames, 13, 3) of a movement, metres."""
    up, turn = np.sin(np.pi * phase), 2 * np.pi * phase
    d = np.zeros((len(phase), 13, 3))
    if kind == "raise_left":
        d[:, L, 1], d[:, LE, 1] = -0.8 * up, -0.3 * up
    elif kind == "raise_right":
        d[:, R, 1], d[:, RE, 1] = -0.8 * up, -0.3 * up
    elif kind == "circle_left":
        d[:, L, 0], d[:, L, 1] = 0.4 * np.sin(turn), -0.4 * (1 - np.cos(turn))
    elif kind == "spread":
        d[:, L, 0], d[:, R, 0] = 0.5 * up, -0.5 * up
        d[:, [L, R], 1] = -0.4 * up[:, None]
    elif kind == "bow":
        d[:, :5, 1], d[:, :5, 2] = 0.3 * up[:, None], -0.4 * up[:, None]
    return d


def clip(kind: str, person: int, take: int, label: str | None = "", rate_hz: float = 20.0) -> Clip:
    """One take: people differ in size, tempo, place and amplitude; takes differ in noise and tempo."""
    rng = np.random.default_rng([person, take, sum(map(ord, kind))])
    who = np.random.default_rng(person)
    size, tempo, wide = who.uniform(0.85, 1.15), who.uniform(1.2, 2.0), who.uniform(0.85, 1.15)
    seconds = tempo * rng.uniform(0.9, 1.1)
    phase = np.linspace(0, 1, int(seconds * rate_hz))
    joints = size * (STANDING + wide * _move(kind, phase)) + who.uniform(-1, 1, 3)
    joints = joints + rng.normal(0, 0.006, joints.shape)
    name = f"{kind}_p{person}_t{take}"
    return Clip.at_rate(joints, rate_hz, kind if label == "" else label, f"p{person}", name)


def clips(kinds, people, takes=2, label="") -> list[Clip]:
    """All takes of all kinds by all people."""
    return [clip(kind, p, t, label) for kind in kinds for p in people for t in range(takes)]


GESTURES = ("raise_left", "raise_right", "circle_left")
