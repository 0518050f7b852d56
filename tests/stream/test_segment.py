"""Which stretches are proposed: between lulls, arms down, within the lengths allowed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.skeleton import Landmark, Pose
from wigwag.stream.segment import Segment, SegmentConfig, Segmenter, arms_down

from .body import REST, Body


def proposals(poses: list[Pose], segmenter: Segmenter) -> list[Segment]:
    return [segment for pose in poses for segment in segmenter.update(pose)]


def test_a_movement_between_two_rests_is_proposed_once_when_it_is_over() -> None:
    body, segmenter = Body(), Segmenter()
    assert proposals(body.go(0, 1.5) + body.go(1, 0.6) + body.go(0, 0.4), segmenter) == []
    assert not segmenter.resting
    (segment,) = proposals(body.go(0, 0.2) + body.go(0, 2.0), segmenter)
    assert segment.onset_ns * 1e-9 == pytest.approx(1.5, abs=0.2)
    assert segment.end_ns * 1e-9 == pytest.approx(2.7, abs=0.25)
    assert segmenter.resting


def test_each_lull_is_joined_with_those_before_it_longest_last() -> None:
    """Up, a slow moment on the way, down: what begins at either lull ends at the rest."""
    body, segmenter = Body(), Segmenter()
    proposals(body.go(0, 1.0) + body.go(1, 0.6) + body.go(0.2, 0.6), segmenter)
    segments = proposals(body.go(0.15, 0.2) + body.go(0.9, 0.5) + body.go(0, 0.5) + body.go(0, 1), segmenter)
    last = [s for s in segments if s.end_ns == segments[-1].end_ns]
    assert len(last) >= 2
    lengths = [s.duration_s for s in last]
    assert lengths == sorted(lengths)
    assert last[-1].onset_ns * 1e-9 == pytest.approx(1.0, abs=0.2)


def test_nothing_is_proposed_that_ends_with_an_arm_up() -> None:
    body, segmenter = Body(), Segmenter()
    assert proposals(body.go(0, 1) + body.go(1, 0.9) + body.go(1, 3.0), segmenter) == []
    assert segmenter.resting


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0.2, 1.2)), min_size=1, max_size=8), st.integers(0, 9))
def test_proposals_have_the_lengths_allowed_and_end_in_the_past_with_arms_down(
    moves: list[tuple[float, float]], seed: int
) -> None:
    config = SegmentConfig()
    body, segmenter = Body(seed=seed), Segmenter(config)
    by_stamp = {}
    for raised, seconds in [(0.0, 0.5), *moves, (0.0, 0.5), (0.0, 1.0)]:
        for pose in body.go(raised, seconds):
            by_stamp[pose.stamp_ns] = pose
            segments = segmenter.update(pose)
            assert len(segments) <= config.max_proposals
            for segment in segments:
                assert config.min_s <= segment.duration_s <= config.max_s
                assert segment.end_ns <= pose.stamp_ns
                assert arms_down(by_stamp[segment.end_ns])


def test_walking_alone_does_not_move_the_joints_relative_to_the_hips() -> None:
    """The whole body carried along, as by a drone that flies past, is no movement."""
    segmenter = Segmenter()
    for k in range(90):
        segmenter.update(Pose(REST + np.array([0.05 * k, 0, 0]), np.ones(13), k * 33_333_333))
    assert segmenter.activity_m_s == pytest.approx(0, abs=1e-9)
    assert segmenter.resting


def test_a_clip_holds_what_is_remembered_and_nothing_else() -> None:
    body, segmenter = Body(), Segmenter()
    poses = body.go(0, 1.0)
    proposals(poses, segmenter)
    clip = segmenter.clip(poses[5].stamp_ns, poses[20].stamp_ns)
    assert clip is not None
    assert list(clip.stamps_ns) == [p.stamp_ns for p in poses[5:21]]
    assert segmenter.clip(poses[5].stamp_ns, poses[7].stamp_ns) is None, "three poses are no movement"
    segmenter.reset()
    assert segmenter.clip(poses[5].stamp_ns, poses[20].stamp_ns) is None


@given(*[st.integers(0, 100)] * 4)
def test_iou_is_symmetric_within_0_and_1_and_1_on_itself(a: int, b: int, c: int, d: int) -> None:
    one, other = Segment(min(a, b), max(a, b) + 1), Segment(min(c, d), max(c, d) + 1)
    assert one.iou(other) == other.iou(one)
    assert 0 <= one.iou(other) <= 1
    assert one.iou(one) == 1


def test_arms_down_looks_at_both_wrists() -> None:
    for wrist in (Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST):
        joints = REST.copy()
        joints[wrist, 1] = -0.6
        assert not arms_down(Pose(joints, np.ones(13), 0))
