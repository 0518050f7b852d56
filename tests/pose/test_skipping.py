"""A camera that is faster than the pose engine: what is handed on is young, and nothing piles up."""

from __future__ import annotations

import gc
import sys
from dataclasses import replace

import numpy as np

from tests.camera.fakes import Metronome
from wigwag.camera.frame import Frame
from wigwag.camera.live import LiveCamera
from wigwag.evaluate.chain import Slowed
from wigwag.pose.body import Body
from wigwag.pose.estimator import PoseConfig, PoseEstimator

SOURCE_HZ, ENGINE_HZ, MINUTES = 120, 15, 10
SECOND_NS = 1_000_000_000


class Deep(Metronome):
    """The metronome with a wall at two metres behind everything."""

    def read(self) -> Frame | None:
        frame = super().read()
        return frame and replace(frame, depth_mm=np.full(frame.rgb.shape[:2], 2000, np.uint16))


class Standing:
    """An engine that sees somebody who stands still."""

    def __init__(self) -> None:
        points = np.linspace([3.0, 1.0], [4.0, 5.0], 33)
        self.body = Body(points, np.ones(33), np.zeros((33, 3)), 1.0, 1.0)

    def detect(self, rgb: np.ndarray) -> Body | None:
        return self.body

    def track(self, rgb: np.ndarray) -> Body | None:
        return self.body

    def reset(self) -> None:
        pass


def test_the_pose_is_no_older_than_one_engine_period_and_a_frame_for_ten_minutes() -> None:
    source = Deep(SOURCE_HZ)
    engine = Slowed(
        Standing(),
        1 / ENGINE_HZ,
        clock=lambda: source.now_ns / SECOND_NS,
        wait=lambda seconds: source.go_to(source.now_ns + round(seconds * SECOND_NS)),
    )
    bound_ns = SECOND_NS // ENGINE_HZ + SECOND_NS // SOURCE_HZ + 1000  # of rounding
    estimator, oldest_ns, before_ns, blocks = PoseEstimator(PoseConfig.alone(), tracker=engine), 0, 0, []
    with LiveCamera(source) as camera:
        source.go_to(source.period_ns)
        for k in range(MINUTES * 60 * ENGINE_HZ):
            frame = camera.latest()
            assert frame is not None
            pose = estimator(frame)
            assert pose is not None
            assert before_ns < pose.stamp_ns == frame.stamp_ns
            before_ns = pose.stamp_ns
            oldest_ns = max(oldest_ns, source.now_ns - pose.stamp_ns)
            if (k + 1) % (60 * ENGINE_HZ) == 0:
                gc.collect()
                blocks.append(sys.getallocatedblocks())
        counts = camera.counts
    assert 0 < oldest_ns <= bound_ns
    assert counts.handed == MINUTES * 60 * ENGINE_HZ
    assert counts.skipped >= 0.85 * counts.received, "seven of eight frames come while the engine works"
    assert source.most_alive <= 4, "pictures held at a time"
    assert blocks[-1] - blocks[1] < 540, f"one a second more would be seen; held after each minute: {blocks}"
