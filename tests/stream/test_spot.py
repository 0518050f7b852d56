"""Spotting, with a body whose arms move as told and a recogniser that only looks at the clip's length."""

import numpy as np
import pytest

from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Landmark, Pose
from wigwag.stream.segment import Segmenter
from wigwag.stream.spot import Spotter, arms_hang

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


class ByLength:
    """Calls a clip by its length: what matters here is which clips are cut, not what they hold."""

    def __init__(self) -> None:
        self.clips: list[Clip] = []

    def recognise(self, clip: Clip) -> Gesture:
        self.clips.append(clip)
        if clip.duration_s > 1.9:
            return Gesture("long", 0.9)
        return Gesture("short", 0.6) if clip.duration_s > 1.2 else Gesture(None, 0.0, reason="too short")


def events(poses: list[Pose], spotter: Spotter) -> list[Gesture]:
    return [gesture for pose in poses if (gesture := spotter.update(pose)) is not None]


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
def test_one_movement_is_one_event(rate_hz: float) -> None:
    body = Body(rate_hz)
    poses = body.go(0, 1.5) + body.go(1, 0.6) + body.go(0, 0.6) + body.go(0, 2.0)
    (gesture,) = events(poses, Spotter(ByLength()))
    assert gesture.label == "short"
    assert gesture.onset_ns * 1e-9 == pytest.approx(1.5, abs=0.25)
    assert gesture.end_ns * 1e-9 == pytest.approx(2.7, abs=0.3)
    assert gesture.decided_ns * 1e-9 < 2.7 + 0.8


def test_a_held_arm_joins_both_halves() -> None:
    body = Body()
    poses = body.go(0, 1.5) + body.go(1, 0.6) + body.go(1, 0.6) + body.go(0, 0.8) + body.go(0, 2)
    (gesture,) = events(poses, Spotter(ByLength()))
    assert gesture.label == "long"


def test_standing_still_says_nothing_and_calls_nobody() -> None:
    recogniser = ByLength()
    assert events(Body().go(0, 20), Spotter(recogniser)) == []
    assert recogniser.clips == []


def test_a_refused_movement_comes_out_as_the_null_gesture() -> None:
    body = Body()
    poses = body.go(0, 1) + body.go(0.4, 0.3) + body.go(0, 0.3) + body.go(0, 2)
    (gesture,) = events(poses, Spotter(ByLength()))
    assert (gesture.label, gesture.reason) == (None, "too short")


def test_a_gap_ends_what_was_going_on() -> None:
    body = Body()
    poses = body.go(0, 1) + body.go(1, 0.5)
    body.now_s += 3.0
    spotter = Spotter(ByLength())
    assert events(poses + body.go(1, 2.0), spotter) == []
    assert len(spotter.segmenter._poses) <= 61


def test_repeated_and_backward_stamps_are_ignored() -> None:
    body = Body()
    poses = body.go(0, 1.5) + body.go(1, 0.6) + body.go(0, 0.6) + body.go(0, 2.0)
    shuffled = [p for i, pose in enumerate(poses) for p in (pose, pose, poses[max(i - 3, 0)])]
    assert len(events(shuffled, Spotter(ByLength()))) == 1


def test_memory_is_bounded() -> None:
    segmenter, body = Segmenter(), Body()
    for _ in range(40):
        for pose in body.go(1, 0.5) + body.go(0, 0.5):
            segmenter.update(pose)
    assert len(segmenter._poses) <= 8 * 30 + 2


def test_arms_hang() -> None:
    body = Body(noise_m=0)
    assert arms_hang(body.pose())
    assert not arms_hang(body.go(1, 1)[-1])
