"""Spotting, with a body whose arms move as told and a recogniser that only looks at the clip's length."""

from itertools import pairwise

import pytest

from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Pose
from wigwag.stream.segment import Segment, Segmenter, arms_down
from wigwag.stream.spot import Spotter, background

from .body import Body


class ByLength:
    """Calls a clip by its length: what matters here is which clips are cut, not what they hold."""

    def __init__(self) -> None:
        self.clips: list[Clip] = []

    def recognise(self, clip: Clip) -> Gesture:
        self.clips.append(clip)
        if clip.duration_s > 1.9:
            return Gesture("long", 0.9)
        return Gesture("short", 0.6) if clip.duration_s > 1.45 else Gesture(None, 0.0, reason="too short")


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


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
def test_a_movement_is_named_within_three_tenths_of_a_second_of_its_end(rate_hz: float) -> None:
    """The drone waits for it: a rest of a quarter of a second, as in teaching, was half of the delay."""
    body = Body(rate_hz)
    poses = body.go(0, 1.5) + body.go(1, 0.6) + body.go(0, 0.6)
    end_s = body.now_s
    (gesture,) = events(poses + body.go(0, 2.0), Spotter(ByLength()))
    assert 0 < gesture.decided_ns * 1e-9 - end_s <= 0.3


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
    poses = body.go(0, 1) + body.go(0.6, 0.5) + body.go(0, 0.5) + body.go(0, 2)
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


def test_arms_down() -> None:
    body = Body(noise_m=0)
    assert arms_down(body.pose())
    assert not arms_down(body.go(1, 1)[-1])


def test_the_surest_of_what_overlaps_speaks() -> None:
    """Half of a movement is named short (0.6) and the whole of it long (0.9): one event, the long one."""
    body, recogniser = Body(), ByLength()
    spotter = Spotter(recogniser)
    update, whole = spotter.segmenter.update, Segment(1_000_000_000, 2_950_000_000)
    half = Segment(whole.onset_ns, 2_550_000_000)

    def propose(pose: Pose) -> list[Segment]:
        update(pose)
        spotter.segmenter.resting = pose.stamp_ns > 3_200_000_000
        at = {2_600: [half], 3_000: [whole]}
        return at.get(round(pose.stamp_ns * 1e-6 / 100) * 100, [])

    spotter.segmenter.update = propose  # type: ignore[method-assign]  # the proposals are what is fixed here
    (gesture,) = events(body.go(0, 4.0), spotter)
    assert gesture.label == "long"
    assert any(clip.duration_s < 1.9 for clip in recogniser.clips)
    assert any(clip.duration_s > 1.9 for clip in recogniser.clips)


def test_a_gesture_is_spoken_without_rest_when_the_body_moves_on() -> None:
    """Whoever walks off at once after a gesture is understood all the same, within the patience."""
    body, spotter = Body(), Spotter(ByLength())
    poses = body.go(0, 1.0) + body.go(1, 0.7) + body.go(0, 0.7)
    for _ in range(8):
        poses += body.go(0.25, 0.2) + body.go(0.0, 0.2)
    spoken = events(poses, spotter)
    assert not spotter.segmenter.resting
    assert spoken[0].onset_ns * 1e-9 == pytest.approx(1.0, abs=0.2)
    for gesture in spoken:
        assert (gesture.decided_ns - gesture.end_ns) * 1e-9 <= spotter.config.patience_s + 0.1


def test_what_was_spoken_is_not_spoken_again() -> None:
    body = Body()
    poses = body.go(0, 1.0)
    for _ in range(3):
        poses += body.go(1, 0.6) + body.go(0, 0.6) + body.go(0, 0.8)
    spoken = events(poses, Spotter(ByLength()))
    assert [g.label for g in spoken] == ["short"] * 3
    for before, after in pairwise(spoken):
        assert after.onset_ns >= before.end_ns - 0.3e9


def test_reset_forgets_a_gesture_half_shown() -> None:
    body, spotter = Body(), Spotter(ByLength())
    assert events(body.go(0, 1) + body.go(1, 0.6), spotter) == []
    spotter.reset()
    assert [g.label for g in events(body.go(0, 0.6) + body.go(0, 2), spotter)] in ([], [None])


def test_background_is_what_would_be_proposed_and_is_no_gesture() -> None:
    body = Body()
    poses = body.go(0, 1.0) + body.go(1, 0.6) + body.go(0, 0.6) + body.go(0, 1.0)
    poses += body.go(0.7, 0.5) + body.go(0, 0.5) + body.go(0, 1.0)
    stream = Clip.from_poses(poses, label="wave", subject="s9")
    gesture = Segment(int(1.0e9), int(2.2e9))
    everything = [clip.stamps_ns.tolist() for clip in background(stream, [])]
    refused = background(stream, [gesture])
    assert [c.stamps_ns.tolist() for c in refused] == everything[1:], "the first is the gesture, and only it"
    assert gesture.iou(Segment(everything[0][0], everything[0][-1])) > 0.5
    assert {(clip.label, clip.subject) for clip in refused} == {(None, "s9")}
    assert len(background(stream, [gesture], max_iou=1.0)) == len(everything)
