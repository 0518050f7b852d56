import numpy as np
import pytest

from wigwag.camera.clock import DeviceClock

MS = 1_000_000


@pytest.mark.parametrize("drift", [-50e-6, 0.0, 50e-6])
def test_stamps_are_even_again_though_frames_arrive_unevenly_and_clocks_drift(drift):
    rng = np.random.default_rng(3)
    true_ns = np.arange(9000) * 33_333_333  # five minutes
    device_ns = (true_ns * (1 + drift)).astype(np.int64) + 1_700_000_000 * 10**9
    late_ns = (4 + rng.exponential(6, len(true_ns))) * MS
    clock = DeviceClock()
    host = [clock.to_host(int(d), int(t + w)) for d, t, w in zip(device_ns, true_ns, late_ns, strict=True)]
    error = (np.array(host) - true_ns)[300:] / MS
    assert error.min() > 3.9
    assert error.max() < 5.5  # the shortest way, 4 ms, and little more
    assert all(h <= t + w for h, t, w in zip(host, true_ns, late_ns, strict=True))


def test_a_device_that_was_reset_is_followed_at_once():
    clock = DeviceClock()
    clock.to_host(900_000 * MS, 5_000 * MS)
    assert clock.to_host(3 * MS, 6_000 * MS) == 6_000 * MS
    assert clock.to_host(36 * MS, 6_040 * MS) == pytest.approx(6_033 * MS, abs=0.01 * MS)
