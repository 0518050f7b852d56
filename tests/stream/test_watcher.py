"""Which stretches are looked at: at most one a pose, each of bounded length, none at rest."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.skeleton import Pose
from wigwag.stream.watcher import Hypothesis, Watcher

from .body import Body


def watch(poses: list[Pose], watcher: Watcher) -> list[Hypothesis]:
    return [h for pose in poses if (h := watcher.update(pose)) is not None]


def test_nothing_is_looked_at_at_rest() -> None:
    assert watch(Body().go(0, 20.0), Watcher()) == []


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
def test_a_movement_is_looked_at_while_it_goes_on_and_when_it_is_over(rate_hz: float) -> None:
    body, watcher = Body(rate_hz), Watcher()
    poses = body.go(0, 2.0) + body.go(1, 0.7) + body.go(0, 0.7) + body.go(0, 1.5)
    seen = [h for h in watch(poses, watcher) if abs(h.onset_ns * 1e-9 - 2.0) < 0.25]
    lengths = [h.length_s for h in seen if not h.resting]
    assert len(lengths) >= 4
    assert lengths == sorted(lengths)
    assert any(h.resting and abs(h.now_ns * 1e-9 - 3.75) < 0.4 for h in seen)


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0.2, 1.2)), min_size=1, max_size=10), st.integers(0, 9))
def test_stretches_lie_in_the_past_and_have_a_clip(moves: list[tuple[float, float]], seed: int) -> None:
    body, watcher = Body(seed=seed), Watcher()
    for raised, seconds in [(0.0, 0.5), *moves, (0.0, 1.0)]:
        for pose in body.go(raised, seconds):
            hypothesis = watcher.update(pose)
            if hypothesis is None:
                continue
            assert hypothesis.onset_ns <= hypothesis.now_ns <= pose.stamp_ns
            assert 0 <= hypothesis.length_s <= 5.1
            clip = watcher.clip(hypothesis)
            assert clip.duration_s >= hypothesis.length_s


def test_what_is_blocked_is_not_looked_at_again() -> None:
    body, watcher = Body(), Watcher()
    watch(body.go(0, 2.0) + body.go(1, 0.7), watcher)
    watcher.block(round(2.7e9))
    later = watch(body.go(0, 0.7) + body.go(1, 0.7) + body.go(0, 2.0), watcher)
    assert later
    assert all(h.onset_ns >= 2.65e9 for h in later)


def test_after_a_hole_nothing_before_it_counts() -> None:
    body, watcher = Body(), Watcher()
    watch(body.go(0, 2.0) + body.go(1, 0.5), watcher)
    body.now_s += 2.0
    later = watch(body.go(1, 0.5) + body.go(0, 0.6) + body.go(0, 1.0), watcher)
    assert all(h.onset_ns >= 4.4e9 for h in later)
