import numpy as np
import pytest

from wigwag.camera.frame import Intrinsics
from wigwag.sim.noise import SensorNoise, SensorNoiseConfig

K = Intrinsics()
GREY = np.full((480, 640, 3), 128, np.uint8)


def flat(metres):
    return np.full((480, 640), round(1000 * metres), np.uint16)


@pytest.mark.parametrize("z_m", [1.0, 2.0, 4.0, 6.0])
def test_depth_errs_with_the_square_of_the_distance(z_m):
    c = SensorNoiseConfig()
    _, depth = SensorNoise(c, K, seed=1).apply(GREY, flat(z_m))
    seen = depth[depth > 0] / 1000.0
    sigma = z_m**2 / (K.fx * c.baseline_m) * np.hypot(c.subpixel, c.disparity_step / np.sqrt(12))
    assert np.std(seen) == pytest.approx(sigma, rel=0.15)
    assert abs(np.mean(seen) - z_m) < 0.25 * sigma


def test_depth_comes_in_steps_of_disparity():
    c = SensorNoiseConfig()
    _, depth = SensorNoise(c, K, seed=1).apply(GREY, flat(4.0))
    disparities = K.fx * c.baseline_m / (np.unique(depth[depth > 0]) / 1000.0) / c.disparity_step
    assert np.abs(disparities - np.round(disparities)).max() < 0.1


def test_holes_cover_about_the_share_that_is_asked_for():
    c = SensorNoiseConfig(blobs=0.02)
    shares = []
    noise = SensorNoise(c, K, seed=3)
    for _ in range(10):
        _, depth = noise.apply(GREY, flat(3.0))
        shares.append((depth == 0).mean())
    assert np.mean(shares) == pytest.approx(0.02, rel=0.4)
    assert len(set(shares)) > 5  # they wander from frame to frame


def test_a_near_thing_casts_a_shadow_on_its_left_only():
    c = SensorNoiseConfig(subpixel=0.0, blobs=0.0, edge_loss=0.0)
    truth = flat(5.0)
    truth[:, 300:400] = 2000
    _, depth = SensorNoise(c, K, seed=0).apply(GREY, truth)
    width = K.fx * c.baseline_m * (1 / 2.0 - 1 / 5.0)
    holes = (depth == 0).sum(axis=1)
    assert holes == pytest.approx(width, abs=1.5)
    assert (depth[:, round(300 - width) + 1 : 300] == 0).all()
    assert (depth[:, 300:] > 0).all()


def test_depth_beyond_the_range_is_not_reported():
    for z in (0.2, 12.0):
        assert not SensorNoise(intrinsics=K).apply(GREY, flat(z))[1].any()
    assert not SensorNoise(intrinsics=K).apply(GREY, flat(0.0))[1].any()


def test_colour_gets_noise_of_the_stated_size_and_stays_in_range():
    noise = SensorNoise(SensorNoiseConfig(colour=3.0), K, seed=2)
    rgb, _ = noise.apply(GREY, flat(3.0))
    assert np.std(rgb.astype(int) - 128) == pytest.approx(3.0, rel=0.05)
    dark = np.zeros_like(GREY)
    assert noise.apply(dark, flat(3.0))[0].max() < 30


def test_noise_is_fresh_each_frame_and_the_same_for_the_same_seed():
    one, two = SensorNoise(intrinsics=K, seed=5), SensorNoise(intrinsics=K, seed=5)
    a, b = one.apply(GREY, flat(3.0)), two.apply(GREY, flat(3.0))
    assert np.array_equal(a[0], b[0])
    assert np.array_equal(a[1], b[1])
    assert not np.array_equal(a[1], one.apply(GREY, flat(3.0))[1])
    assert np.all(GREY == 128)  # the input stays as it is
