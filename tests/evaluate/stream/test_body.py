import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.evaluate.stream.people import RATE_HZ, swing, walk
from wigwag.errors import InputError
from wigwag.evaluate.stream.body import (
    Limbs,
    Stance,
    Stillness,
    activity,
    facing,
    quiet_ends,
    turn,
    upright,
)
from wigwag.skeleton import BONES, Landmark


def test_another_body_makes_the_same_movement_with_its_own_limbs() -> None:
    """What someone else did, in this body: bones as long as here, each as it was directed."""
    own, other = swing("s1"), walk(size=1.3)
    limbs = Limbs.of([own])
    worn = limbs.wear(other)
    np.testing.assert_allclose(Limbs.of([worn]).lengths, limbs.lengths, rtol=0.02)
    for a, b in BONES:
        if {a, b} & {0} or (a, b) in {(1, 7), (2, 8)}:  # not bones of their own: they follow from the others
            continue
        bones = [c.joints[:, b] - c.joints[:, a] for c in (worn, other)]
        one, two = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in bones)
        np.testing.assert_allclose((one * two).sum(axis=1), 1.0, atol=1e-6)
    assert (worn.label, worn.subject, worn.name) == (other.label, other.subject, other.name)


def test_steps_are_scaled_by_the_legs() -> None:
    own, other = swing("s1"), walk(size=1.3, towards_m=1.5)
    limbs = Limbs.of([own])
    path = np.ptp(limbs.wear(other).joints[:, Landmark.LEFT_HIP, 2])
    walked = np.ptp(other.joints[:, Landmark.LEFT_HIP, 2])
    assert path == pytest.approx(walked * limbs.leg_m / Limbs.of([other]).leg_m, rel=1e-6)


def test_a_body_in_its_own_limbs_does_not_change() -> None:
    clip = walk()
    np.testing.assert_allclose(Limbs.of([clip]).wear(clip).joints, clip.joints, atol=1e-9)
    with pytest.raises(InputError, match="one clip or more"):
        Limbs.of([])


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_turning_turns(one: float, other: float) -> None:
    joints = swing().joints[0]
    turned = turn(joints, one)
    change = (facing(turned) - facing(joints) - one + np.pi) % (2 * np.pi) - np.pi
    assert abs(change) < 1e-9
    np.testing.assert_allclose(turn(turned, other), turn(joints, one + other), atol=1e-9)
    np.testing.assert_allclose(turned[:, 1], joints[:, 1])


def test_putting_moves_feet_and_facing() -> None:
    clip = walk()
    stance = Stance(np.array([0.5, 1.0, 4.0]), 0.7)
    put = stance.put(clip.joints)
    there = Stance.of(put[0])
    np.testing.assert_allclose(there.ground, stance.ground, atol=1e-9)
    assert there.facing_rad == pytest.approx(0.7)
    steps = [np.linalg.norm(np.diff(j, axis=0), axis=2) for j in (put, clip.joints)]
    np.testing.assert_allclose(steps[0], steps[1], atol=1e-9)


def test_quiet_ends_are_those_before_and_after_the_movement() -> None:
    clip = swing(still_s=(0.8, 1.2))
    before, after = quiet_ends(clip.joints, RATE_HZ)
    assert 0.5 <= len(before) / RATE_HZ <= 0.95
    assert 0.9 <= len(after) / RATE_HZ <= 1.35
    assert quiet_ends(swing(still_s=(0.0, 0.0)).joints, RATE_HZ) == []


def test_jitter_is_measured_and_made_again() -> None:
    clips = [swing(trial=t) for t in range(1, 9)]
    stillness = Stillness.of(clips, RATE_HZ)
    assert np.median(stillness.jitter_m) == pytest.approx(0.001, rel=0.1), (
        "what the recordings were made with"
    )
    assert stillness.persistence < 0.15
    still = np.repeat(clips[0].joints[:1], 900, axis=0)
    alive = stillness.around(still, 30, np.random.default_rng(0))
    quick = np.diff(alive - still, axis=0).std() / np.sqrt(2)
    assert quick == pytest.approx(0.001, rel=0.2)
    feet, head = (np.std((alive - still)[:, i, 0]) for i in (Landmark.LEFT_HEEL, Landmark.NOSE))
    assert feet < 0.0015, "the feet stand"
    assert 0.004 < head < 0.012, "the head sways"
    assert activity(alive, 30).max() < 0.1, "nobody moves"


def test_who_never_keeps_still_has_no_jitter() -> None:
    with pytest.raises(InputError, match="Nobody keeps still"):
        Stillness.of([swing(still_s=(0.0, 0.0))], RATE_HZ)


def test_upright_is_standing_with_lowered_arms() -> None:
    clip = swing()
    limbs = Limbs.of([clip])
    assert upright(clip.joints[0], limbs)
    assert not upright(clip.joints[len(clip) // 2], limbs), "an arm is up"
    sunk = clip.joints[0].copy()
    sunk[[i for i in range(13) if i < 9], 1] += 0.3
    assert not upright(sunk, limbs)
