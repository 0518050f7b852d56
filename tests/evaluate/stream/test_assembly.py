from itertools import pairwise

import numpy as np
import pytest

from tests.evaluate.stream.people import RATE_HZ, swing, walk
from wigwag.datasets.recording import Recording
from wigwag.errors import InputError
from wigwag.evaluate.stream.assembly import Body, Shown, StreamConfig, assemble
from wigwag.evaluate.stream.body import Limbs, activity, facing
from wigwag.evaluate.stream.moves import movement
from wigwag.skeleton import Clip, Landmark

CLIPS = [swing(label=label, trial=t) for label in ("a1", "a2") for t in (1, 2)]
BODY = Body.of(CLIPS, RATE_HZ)
GESTURES = [[Shown(c, f"utd:{c.label}", c.label)] for c in CLIPS]
EVERYDAY = [Shown(walk(), "utkinect:walk"), Shown(walk("utkinect_s04", size=0.9), "utkinect:walk")]


def made(seed: int = 0, **settings: object) -> Recording:
    return assemble(BODY, GESTURES, EVERYDAY, StreamConfig(**settings), seed=seed)  # type: ignore[arg-type]


def test_every_recording_is_shown_once_and_marked() -> None:
    recording = made()
    assert sorted(m.label for m in recording.marks) == ["a1", "a1", "a2", "a2"]
    assert [s.label for s in recording.scenes] == ["utkinect:walk"] * 2
    assert recording.stream.subject == "s1"
    assert recording.stream.label is None
    spans = sorted([*recording.marks, *recording.scenes], key=lambda m: m.onset_ns)
    for before, after in pairwise(spans):
        assert after.onset_ns > before.end_ns + 0.5e9, "rest lies between"


def test_marks_stand_where_the_recorded_movement_is() -> None:
    """The recording is found again under its mark, frame by frame, wherever the person stands."""
    recording = made()
    for mark in recording.marks:
        clip = next(c for c in CLIPS if c.label == mark.label and shown_at(recording, mark.onset_ns, c))
        onset, end = movement(clip)
        assert mark.duration_s == pytest.approx(end - onset, abs=1e-6)


def shown_at(recording: Recording, onset_ns: int, clip: Clip) -> bool:
    """Say whether a clip's movement plays from ``onset_ns`` on: the wrists above the shoulders, all along."""
    stream = recording.stream
    begin_s = onset_ns * 1e-9 - movement(clip)[0]
    low, high = np.searchsorted(stream.times_s, [begin_s, begin_s + clip.duration_s])
    played, own = (joints[:, 5:7, 1] - joints[:, 1:3, 1] for joints in (stream.joints[low:high], clip.joints))
    at = stream.times_s[low:high] - begin_s
    expected = np.stack([np.interp(at, clip.times_s, own[:, side]) for side in (0, 1)], axis=1)
    return bool(np.abs(played - expected).max() < 0.02)


def test_between_movements_the_person_is_at_rest_but_alive() -> None:
    recording = made()
    stream = recording.stream
    speed = activity(np.asarray(stream.joints, dtype=float), 30)
    lead = speed[: round(2.5 * 30)]
    assert lead.max() < 0.3
    assert lead[lead < 0.12].size > 0.5 * lead.size
    steps = np.linalg.norm(np.diff(stream.joints, axis=0), axis=2)
    assert (steps.max(axis=1) > 0).all(), "no frozen frame"


def test_nothing_jumps() -> None:
    for seed in range(4):
        stream = made(seed).stream
        steps = np.linalg.norm(np.diff(stream.joints, axis=0), axis=2) * 30
        assert steps.max() < 5.0, "no landmark is faster than the swing and the turn"


def test_it_is_one_body_all_along() -> None:
    stream = made().stream
    limbs = BODY.limbs.lengths
    worn = Limbs.of([stream]).lengths
    np.testing.assert_allclose(worn, limbs, rtol=0.05)


def test_who_walks_away_comes_back() -> None:
    walks = [Shown(walk(f"utkinect_s{i:02d}"), "utkinect:walk") for i in range(10)]
    stream = assemble(BODY, [], walks, StreamConfig(), seed=1).stream
    place = stream.joints[:, Landmark.LEFT_HEEL] - np.array([0.0, 1.0, 3.0])
    assert np.hypot(place[:, 0], place[:, 2]).max() < 3.5
    turned = [abs(facing(j)) for j in stream.joints[::30]]
    assert max(turned) > 1.0, "they turn for it"


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
def test_the_rate_changes_the_poses_and_not_the_truth(rate_hz: float) -> None:
    recording, usual = made(rate_hz=rate_hz), made()
    assert recording.marks == usual.marks
    assert len(recording.stream) / recording.stream.duration_s == pytest.approx(rate_hz, rel=0.01)
    for joint in (Landmark.RIGHT_WRIST, Landmark.NOSE):
        again = [
            np.interp(np.arange(1, 20), r.stream.times_s, r.stream.joints[:, joint, 1])
            for r in (recording, usual)
        ]
        np.testing.assert_allclose(*again, atol=0.02)


def test_a_seed_chooses_order_and_rest() -> None:
    assert made(3).marks == made(3).marks
    np.testing.assert_array_equal(made(3).stream.joints, made(3).stream.joints)
    assert made(3).marks != made(4).marks


def test_a_group_is_shown_in_its_order_without_everyday_life_between() -> None:
    pair = [Shown(CLIPS[0], "utd:a1", "a1"), Shown(CLIPS[2], "utd:a2", "a2")]
    recording = assemble(BODY, [pair, pair], EVERYDAY, StreamConfig(), seed=0)
    assert [m.label for m in recording.marks] == ["a1", "a2", "a1", "a2"]
    for scene in recording.scenes:
        assert not recording.marks[0].end_ns < scene.onset_ns < recording.marks[1].onset_ns


def test_who_begins_seated_sits_down_and_waits_before() -> None:
    seated = CLIPS[0].joints.copy()
    seated[:, :9, 1] += 0.3
    seated[:, 9:11, 2] -= 0.2
    clip = Clip(seated, CLIPS[0].stamps_ns, "a24", "s1", "seated")
    recording = assemble(BODY, [[Shown(clip, "utd:a24", "a24")]], [], StreamConfig(), seed=0)
    hips = recording.stream.joints[:, Landmark.LEFT_HIP, 1]
    begin = recording.marks[0].onset_ns * 1e-9
    before = hips[(recording.stream.times_s > begin - 1.0) & (recording.stream.times_s < begin)]
    assert np.ptp(before) < 0.05, "sits still"
    assert before.mean() - np.median(hips[:60]) == pytest.approx(0.3, abs=0.05)


def test_faults() -> None:
    with pytest.raises(InputError, match="rate_hz must be within 10 and 60"):
        StreamConfig(rate_hz=5)
    with pytest.raises(InputError, match="everyday_share"):
        StreamConfig(everyday_share=2)
    with pytest.raises(InputError, match="nothing to show"):
        assemble(BODY, [], [])
    raised = [swing(still_s=(0.8, 0.8)) for _ in range(1)]
    lifted = raised[0].joints.copy()
    lifted[:, 5:7, 1] -= 0.6
    with pytest.raises(InputError, match="never stands with lowered arms"):
        Body.of([Clip(lifted, raised[0].stamps_ns, "a1", "s1")], RATE_HZ)
