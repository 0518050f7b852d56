import numpy as np
import pytest

from wigwag.camera.frame import Frame
from wigwag.camera.watchdog import Sight, Watchdog, WatchdogConfig
from wigwag.errors import InputError

from .fakes import TINY, frame, picture

MS = 1_000_000
STEP = 33 * MS


def run(frames, delay_ns=5 * MS, watchdog=None):
    watchdog = watchdog or Watchdog()
    return [watchdog.see(f, i * STEP + delay_ns) for i, f in enumerate(frames)]


def test_pictures_of_now_are_fresh():
    healths = run([frame(i * STEP, seed=i) for i in range(30)])
    assert {h.sight for h in healths} == {Sight.FRESH}
    assert all(h.usable and h.reason == "" and h.age_s == pytest.approx(0.005) for h in healths)


def test_a_frozen_picture_is_never_a_person_who_stands_still():
    moving = [frame(i * STEP, seed=i) for i in range(5)]
    frozen = [Frame(moving[-1].rgb.copy(), None, TINY, i * STEP) for i in range(5, 30)]
    healths = run(moving + frozen)
    assert not any(h.usable for h in healths[5:])  # not one of them
    sights = [h.sight for h in healths[5:]]
    turn = sights.index(Sight.STALE)
    assert turn * STEP < 0.3e9 <= (turn + 1) * STEP
    assert set(sights[turn:]) == {Sight.STALE}
    assert "same picture" in healths[-1].reason


def test_one_bit_of_noise_is_a_new_picture():
    a = picture(1)
    b = a.copy()
    b[5, 7, 2] ^= 1
    healths = run([Frame(a, None, TINY, 0), Frame(b, None, TINY, STEP)])
    assert healths[1].usable


def test_stamps_that_do_not_move_are_stale_though_the_bytes_change():
    healths = run([frame(0, seed=i) for i in range(15)])
    assert healths[0].usable
    assert not any(h.usable for h in healths[1:])
    assert healths[-1].sight is Sight.STALE
    assert "stamps" in healths[-1].reason


def test_frames_out_of_order_are_not_used():
    healths = run([frame(s * STEP, seed=s) for s in (0, 1, 3, 2, 4)])
    assert [h.usable for h in healths] == [True, True, True, False, True]


def test_a_gap_is_stale_and_the_next_picture_ends_it():
    watchdog = Watchdog()
    assert watchdog.check(0).sight is Sight.STALE
    assert watchdog.check(0).age_s == float("inf")
    watchdog.see(frame(0, seed=1), 5 * MS)
    assert watchdog.check(200 * MS).sight is Sight.REPEATED
    gap = watchdog.check(505 * MS)
    assert gap.sight is Sight.STALE
    assert gap.reason == "no picture for 0.5 s"
    assert gap.age_s == pytest.approx(0.505)
    assert watchdog.see(frame(600 * MS, seed=2), 605 * MS).sight is Sight.FRESH


def test_a_picture_that_comes_late_is_stale():
    health = Watchdog().see(frame(0, seed=1), 2_000 * MS)
    assert health.sight is Sight.STALE
    assert "2.0 s old" in health.reason


def test_a_black_picture_is_dark():
    noise = np.random.default_rng(0).integers(0, 5, (20, 6, 8, 3), dtype=np.uint8)
    healths = run([Frame(rgb, None, TINY, i * STEP) for i, rgb in enumerate(noise)])
    assert {h.sight for h in healths} == {Sight.DARK}
    frozen_black = run([Frame(np.zeros((6, 8, 3), np.uint8), None, TINY, i * STEP) for i in range(20)])
    assert frozen_black[-1].sight is Sight.STALE


def test_a_dark_night_with_a_lamp_is_not_black():
    rgb = np.zeros((6, 8, 3), np.uint8)
    rgb[2, 2] = 200
    assert Watchdog().see(Frame(rgb, None, TINY, 0), 0).usable


def test_depth_that_is_all_zero_is_no_depth_but_the_picture_is_good():
    full = np.full((6, 8), 2000, np.uint16)
    seen = run([frame(0, 1, full), frame(STEP, 2, np.zeros_like(full)), frame(2 * STEP, 3, None)])
    assert [h.depth for h in seen] == [True, False, False]
    assert all(h.usable for h in seen)


def test_frozen_depth_under_a_living_picture_is_no_depth():
    depths = [np.full((6, 8), 2000 + i, np.uint16) for i in range(5)]
    frames = [frame(i * STEP, i, depths[min(i, 4)].copy()) for i in range(20)]
    healths = run(frames)
    assert all(h.usable for h in healths)
    assert [h.depth for h in healths] == [(i - 4) * STEP < 0.3e9 for i in range(20)]
    assert run([*frames, frame(20 * STEP, 20, depths[0])])[-1].depth


def test_limits_that_are_always_met_are_refused():
    with pytest.raises(InputError):
        WatchdogConfig(stale_s=0.0)
    with pytest.raises(InputError):
        WatchdogConfig(late_s=float("nan"))
