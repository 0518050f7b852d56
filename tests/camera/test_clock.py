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


def test_a_clock_that_runs_slow_is_followed_by_its_answers_and_by_nothing_else():
    asked, deaf = DeviceClock(), DeviceClock()
    for ms in range(0, 60_000, 100):
        device_ns = int(0.9 * ms * MS)
        told = asked.to_host(device_ns, (ms + 5) * MS), deaf.to_host(device_ns, (ms + 5) * MS)
        asked.answered((ms - 3) * MS, device_ns)
        assert ms * MS - 15 * MS <= told[0] <= (ms + 5) * MS
    assert told[1] < (ms - 300) * MS, "stamps alone could as well be late"


@pytest.mark.parametrize("off_ms", [-10_000_000, 1_000, 10_000_000])
def test_an_answer_by_another_clock_is_left_alone(off_ms):
    clock = DeviceClock()
    clock.answered(5 * MS, 5 * MS)
    before = clock.to_host(100 * MS, 110 * MS)
    clock.answered(110 * MS, 100 * MS - off_ms * MS)
    assert clock.to_host(133 * MS, 143 * MS) == pytest.approx(before + 33 * MS, abs=0.01 * MS)
