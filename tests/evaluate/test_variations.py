"""Variations of clips: seeded, of the same body, near what they come from."""

import numpy as np
import pytest

from wigwag.evaluate.variations import Spread, Variations
from wigwag.features import Normalisation
from wigwag.skeleton import Clip, Landmark

NONE = Spread(bone=0, yaw_rad=0, warp=0, crop=0, noise=0)


@pytest.fixture(scope="module")
def clips():
    """Bodies that sway, each about its own pose."""
    rng = np.random.default_rng(0)
    body = rng.normal(size=(13, 3))
    body[Landmark.LEFT_SHOULDER] = [0.3, -0.5, 0]
    body[Landmark.RIGHT_SHOULDER] = [-0.3, -0.5, 0]
    walks = 0.05 * rng.normal(size=(6, 40, 13, 3)).cumsum(axis=1)
    return [Normalisation().apply(Clip.at_rate(body + 0.5 * rng.normal(size=(13, 3)) + w, 20)) for w in walks]


def drawn(clips, count=200, seed=0, spread=None, frames=24):
    batches = list(Variations(clips, frames, spread).batches(count, seed, batch=64))
    return np.concatenate([x for x, _ in batches]), np.concatenate([o for _, o in batches])


def test_without_spread_they_are_the_clips(clips):
    joints, origin = drawn(clips, spread=NONE, frames=40)
    assert joints.shape == (200, 40, 39)
    for value, number in zip(joints[:20], origin, strict=False):
        np.testing.assert_allclose(value, clips[number].joints.reshape(40, 39), atol=1e-5)
    np.testing.assert_allclose(
        Variations(clips, 40).plain(), [c.joints.reshape(40, 39) for c in clips], atol=1e-5
    )


def test_seeded(clips):
    np.testing.assert_array_equal(drawn(clips)[0], drawn(clips)[0])
    assert not np.allclose(drawn(clips)[0], drawn(clips, seed=1)[0])


def test_no_two_are_alike_and_each_is_nearest_to_its_own_clip(clips):
    joints, origin = drawn(clips)
    assert len(np.unique(joints.reshape(200, -1), axis=0)) == 200
    gaps = np.linalg.norm(joints[:, None] - Variations(clips).plain()[None], axis=(2, 3))
    assert (gaps.argmin(axis=1) == origin).mean() > 0.9
    assert set(origin.tolist()) == set(range(6))


def test_both_sides_of_a_body_get_the_same_lengths(clips):
    joints, origin = drawn(clips, spread=Spread(bone=0.3, yaw_rad=0, warp=0, crop=0, noise=0), frames=40)
    joints = joints.reshape(-1, 40, 13, 3)

    def thigh(x, hip, knee):
        return np.linalg.norm(x[..., knee, :] - x[..., hip, :], axis=-1)[..., 0]

    left, right = (
        thigh(joints, hip, knee) / thigh(np.stack([c.joints for c in clips]), hip, knee)[origin]
        for hip, knee in (
            (Landmark.LEFT_HIP, Landmark.LEFT_KNEE), (Landmark.RIGHT_HIP, Landmark.RIGHT_KNEE),
        )
    )  # fmt: skip
    assert left.std() > 0.1
    np.testing.assert_allclose(left, right, rtol=1e-3)


def test_they_are_normalised_again(clips):
    joints = drawn(clips, spread=Spread(bone=0.3, noise=0))[0].reshape(-1, 24, 13, 3)
    limbs = ((1, 3), (3, 5), (2, 4), (4, 6))
    lengths = np.mean([np.linalg.norm(joints[:, :, a] - joints[:, :, b], axis=2) for a, b in limbs], axis=0)
    np.testing.assert_allclose(4 * np.median(lengths, axis=1), 1, rtol=1e-3)
