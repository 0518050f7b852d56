import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.sim.exposure import Exposure, ExposureConfig

GREY = np.full((120, 160, 3), 160, np.uint8)


def linear(display: np.ndarray) -> np.ndarray:
    x = display / 255
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def test_in_daylight_the_picture_is_as_it_was_but_for_shot_noise():
    seen = Exposure(ExposureConfig(), seed=1).apply(GREY)
    assert abs(float(seen.mean()) - 160) < 1.0
    assert float(seen.std()) < 2.5


@pytest.mark.parametrize("light", [0.5, 0.1, 0.02, 0.005])
def test_gain_makes_up_for_the_light_as_far_as_it_goes(light):
    c = ExposureConfig(light=light)
    seen = linear(Exposure(c, seed=1).apply(GREY))
    bright = float(linear(np.array(160.0)))
    assert seen.mean() == pytest.approx(bright * min(c.max_gain * light, 1.0), rel=0.05)


@pytest.mark.parametrize("light", [0.5, 0.1, 0.02])
def test_noise_is_that_of_the_photons_and_the_electronics(light):
    """Poisson: the deviation of N electrons is the root of N."""
    c = ExposureConfig(light=light)
    seen = linear(Exposure(c, seed=2).apply(GREY))
    electrons = float(linear(np.array(160.0))) * c.full_well * light
    want = np.sqrt(electrons + c.read_noise**2) / electrons
    assert seen.std() / seen.mean() == pytest.approx(want, rel=0.1)


def test_noise_differs_from_frame_to_frame_and_follows_the_seed():
    one, again = (Exposure(ExposureConfig(light=0.02), seed=3) for _ in range(2))
    first, second = one.apply(GREY), one.apply(GREY)
    assert not np.array_equal(first, second)
    assert np.array_equal(first, again.apply(GREY))
    assert (GREY == 160).all(), "the input stays as it is"


@pytest.mark.parametrize(
    "changes", [{"light": 0.0}, {"light": 1.5}, {"light": float("nan")}, {"max_gain": 0.5}]
)
def test_light_and_gain_out_of_range_are_errors(changes):
    with pytest.raises(InputError, match="ExposureConfig"):
        ExposureConfig(**changes)
