"""When a body moves, relative to its own rest; and where movements may have begun."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.skeleton import Pose
from wigwag.stream.motion import Motion, MotionConfig

from .body import Body


def follow(motion: Motion, poses: list[Pose]) -> list[bool]:
    moving = []
    for pose in poses:
        motion.update(pose.joints)
        moving.append(not motion.resting)
    return moving


def test_a_movement_is_one_stretch_with_its_beginning_among_the_onsets() -> None:
    body, motion = Body(), Motion()
    moving = follow(motion, body.go(0, 2.0))
    assert not any(moving)
    moving = follow(motion, body.go(1, 0.6) + body.go(0, 0.6))
    assert moving[-1]
    assert min(abs(onset.row - 60) for onset in motion.onsets) <= 6
    assert not follow(motion, body.go(0, 1.0))[-1]


def test_what_is_rest_is_learned_from_the_person() -> None:
    still, shaky = Motion(), Motion()
    follow(still, Body(noise_m=0.002).go(0, 8.0))
    follow(shaky, Body(noise_m=0.012, seed=1).go(0, 8.0))
    assert still.on_m_s < 0.35 < shaky.on_m_s
    assert not any(follow(shaky, Body(noise_m=0.012, seed=2).go(0, 8.0)))


def test_a_hole_keeps_the_rest_level_and_a_new_person_does_not() -> None:
    motion = Motion()
    follow(motion, Body(noise_m=0.02).go(0, 8.0))
    learned = motion.on_m_s
    motion.reset()
    assert motion.on_m_s == learned
    motion.forget()
    assert motion.on_m_s == Motion().on_m_s


def test_onsets_are_few_and_recent_however_long_the_body_moves() -> None:
    config = MotionConfig()
    body, motion = Body(), Motion(config)
    for turn in range(40):
        for pose in body.go(turn % 2, 0.5):
            motion.update(pose.joints)
            assert len(motion.onsets) <= config.most
            assert all(motion.row - onset.row <= config.longest_s * 30 for onset in motion.onsets)
    assert len(motion.onsets) >= 3


def test_a_pause_within_a_movement_keeps_its_beginning() -> None:
    """Arms up, held for a second, down: the gesture began before the hold."""
    body, motion = Body(), Motion()
    follow(motion, body.go(0, 2.0) + body.go(1, 0.6) + body.go(1, 1.0) + body.go(0, 0.4))
    assert min(abs(onset.row - 60) for onset in motion.onsets) <= 6


def test_a_posture_that_is_held_may_be_a_beginning() -> None:
    onsets = []
    for postures in (False, True):
        body, motion = Body(), Motion(MotionConfig(postures=postures))
        follow(motion, body.go(0, 2.0) + body.go(1, 0.6) + body.go(1, 1.0))
        onsets.append({onset.row for onset in motion.onsets})
    (held,) = onsets[1] - onsets[0]
    assert 78 <= held <= 90


def test_the_peak_is_that_since_a_row() -> None:
    body, motion = Body(), Motion()
    follow(motion, body.go(0, 1.0) + body.go(1, 0.4))
    fast = motion.peak_m_s(30)
    follow(motion, body.go(1, 1.0))
    assert motion.peak_m_s(30) >= fast > 1.0
    assert motion.peak_m_s(motion.row) == pytest.approx(motion.activity_m_s)
    assert np.isfinite(motion.peak_m_s(-1000))
