import numpy as np
import pytest

from tests.datasets.trees import UTD, needs_utd
from tests.evaluate.stream.people import RATE_HZ, swing
from wigwag.datasets.utd_mhad import load_skeletons
from wigwag.errors import InputError
from wigwag.evaluate.stream.moves import cut_to_movement, movement, moves, resampled
from wigwag.skeleton import Clip


@pytest.mark.parametrize("still_s", [(0.8, 0.8), (0.0, 1.5), (2.0, 0.3)])
def test_rest_is_not_part_of_the_movement(still_s: tuple[float, float]) -> None:
    onset, end = movement(swing(still_s=still_s))
    assert onset == pytest.approx(still_s[0] + 0.2, abs=0.2)
    assert end == pytest.approx(still_s[0] + 1.6 - 0.2, abs=0.2)


def test_who_stands_still_does_not_move() -> None:
    clip = swing()
    still = Clip(np.repeat(clip.joints[:1], len(clip), axis=0), clip.stamps_ns)
    assert moves(clip)
    assert not moves(still)
    with pytest.raises(InputError, match="nobody moves"):
        cut_to_movement(still)


def test_it_does_not_depend_on_where_the_person_walks() -> None:
    clip = swing()
    drift = np.zeros((len(clip), 1, 3))
    drift[:, 0, 2] = np.linspace(0, -1, len(clip))
    moved = Clip(clip.joints + drift, clip.stamps_ns, clip.label)
    assert movement(moved) == pytest.approx(movement(clip), abs=1 / RATE_HZ)


def test_a_stray_twitch_is_left_off() -> None:
    clip = swing(still_s=(2.0, 0.8))
    joints = clip.joints.copy()
    joints[6:8, 6, 0] += 0.06
    twitch = Clip(joints, clip.stamps_ns, clip.label)
    assert movement(twitch)[0] == pytest.approx(movement(clip)[0], abs=0.11)


def test_nobody_moves() -> None:
    with pytest.raises(InputError, match=r"stone: nobody moves; no landmark gets faster than 0\.20 m/s"):
        movement(Clip.at_rate(np.ones((30, 13, 3)), 30, name="stone"))


def test_cutting_keeps_the_movement_and_a_little() -> None:
    clip = swing()
    onset, end = movement(clip)
    cut = cut_to_movement(clip)
    assert cut.stamps_ns[0] == 0
    assert end - onset - 1e-6 <= cut.duration_s <= end - onset + 0.21
    assert (cut.label, cut.subject, cut.name) == (clip.label, clip.subject, clip.name)


def test_resampling_goes_through_the_frames_and_does_not_overshoot() -> None:
    clip = swing()
    np.testing.assert_allclose(resampled(clip, clip.times_s), clip.joints, atol=1e-9)
    stamps = clip.stamps_ns.copy()
    stamps[20:] += 10**9
    hole = Clip(clip.joints, stamps)
    between = resampled(hole, np.linspace(0, hole.duration_s, 500))
    assert between.max() <= clip.joints.max() + 1e-9
    assert between.min() >= clip.joints.min() - 1e-9
    np.testing.assert_allclose(resampled(clip, np.array([-1.0, 99.0])), clip.joints[[0, -1]], atol=1e-12)


@needs_utd
def test_every_recording_of_utd_mhad_has_a_movement() -> None:
    lengths = []
    for clip in load_skeletons(UTD, subjects=("s1", "s3")).clips:
        onset, end = movement(clip)
        lengths.append(end - onset)
        assert 0 <= onset < end <= clip.duration_s
    assert min(lengths) > 0.5
