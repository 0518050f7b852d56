"""People of different size and tempo who show three gestures of the arms, and movements that are none."""

from __future__ import annotations

import numpy as np

from wigwag.skeleton import Clip, Landmark, Pose
from wigwag.stream.truth import LabelledStream, Showing

from .body import REST

RATE_HZ = 30.0
GESTURES = ("left", "right", "both")

_ARMS = {
    "left": (Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST),
    "right": (Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST),
}


class Actor:
    """Shows movements one after another; remembers what was a gesture and when."""

    def __init__(self, number: int, rate_hz: float = RATE_HZ) -> None:
        self.rng = np.random.default_rng([0xAC, number])
        self.name = f"actor {number}"
        self.rate_hz = rate_hz
        self.size = float(self.rng.uniform(0.9, 1.15))
        self.tempo = float(self.rng.uniform(0.85, 1.2))
        self.frames: list[np.ndarray] = []
        self.showings: list[Showing] = []

    @property
    def now_ns(self) -> int:
        return round(len(self.frames) * 1e9 / self.rate_hz)

    def rest(self, seconds: float) -> None:
        for _ in range(round(seconds * self.rate_hz)):
            self._add({})

    def show(self, what: str) -> None:
        """Show a gesture, or ``"squat"`` or ``"shake"``, which are none."""
        onset = self.now_ns
        lasts_s = 1.6 / self.tempo * float(np.exp(self.rng.normal(0, 0.05)))
        high = float(self.rng.uniform(0.9, 1.1))
        count = round(lasts_s * self.rate_hz)
        for i in range(1, count + 1):
            phase = i / count
            up = high * np.sin(np.pi * phase) ** 2
            match what:
                case "squat":
                    self._add({}, down=0.35 * up)
                case "shake":
                    swing = 0.15 * np.sin(6 * np.pi * phase)
                    self._add({Landmark.LEFT_WRIST: (swing, 0), Landmark.RIGHT_WRIST: (-swing, 0)})
                case _:
                    sides = ("left", "right") if what == "both" else (what,)
                    self._add(
                        {j: (0, -0.9 * up * (0.5 + k * 0.5)) for s in sides for k, j in enumerate(_ARMS[s])}
                    )
        if what in GESTURES:
            self.showings.append(Showing(what, onset, self.now_ns))

    def _add(self, moved: dict[Landmark, tuple[float, float]], down: float = 0.0) -> None:
        joints = REST.copy()
        for joint, (x, y) in moved.items():
            joints[joint, :2] += x, y
        joints[:9, 1] += down
        joints[9:11, 2] -= 0.5 * down
        joints = (joints - REST.mean(axis=0)) * self.size + REST.mean(axis=0)
        self.frames.append(joints + self.rng.normal(0, 0.004, (13, 3)))

    def stream(self) -> LabelledStream:
        stamps = np.round(np.arange(len(self.frames)) * (1e9 / self.rate_hz)).astype(np.int64)
        clip = Clip(np.stack(self.frames), stamps, None, self.name, f"stream of {self.name}")
        return LabelledStream(clip, tuple(self.showings))

    def poses(self) -> list[Pose]:
        clip = self.stream().stream
        return [Pose(j, np.ones(13), int(s)) for j, s in zip(clip.joints, clip.stamps_ns, strict=True)]


def session(number: int, rate_hz: float = RATE_HZ, rounds: int = 2) -> Actor:
    """Let an actor show every gesture, with other movements between."""
    actor = Actor(number, rate_hz)
    actor.rest(2.0)
    for _ in range(rounds):
        for what in actor.rng.permutation([*GESTURES, "squat", "shake"]):
            actor.show(str(what))
            actor.rest(float(actor.rng.uniform(0.7, 1.5)))
    actor.rest(1.0)
    return actor


def examples(number: int) -> list[Clip]:
    """Return one cut example of each gesture."""
    clips = []
    for what in GESTURES:
        actor = Actor(number)
        actor.show(what)
        stream = actor.stream().stream
        clips.append(Clip(stream.joints, stream.stamps_ns, what, actor.name, f"{what} of {actor.name}"))
    return clips
