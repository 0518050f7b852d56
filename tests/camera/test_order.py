from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from wigwag.camera.order import Order

S = 1_000_000_000


def passed(stamps, order=None):
    order = order or Order()
    return [order.admit(stamp) for stamp in stamps]


@given(st.lists(st.integers(-5 * S, 5 * S), max_size=60), st.sets(st.integers(0, 59)))
def test_stamps_rise_strictly_whatever_the_source_does(stamps, restarts):
    order, out = Order(), []
    for i, stamp in enumerate(stamps):
        if i in restarts:
            order.restart()
        out.append(order.admit(stamp))
    kept = [stamp for stamp in out if stamp is not None]
    assert all(a < b for a, b in pairwise(kept))
    assert not stamps or out[0] == stamps[0]


@given(st.lists(st.integers(0, 9 * S), unique=True, max_size=60))
def test_frames_in_order_pass_unchanged(stamps):
    assert passed(sorted(stamps)) == sorted(stamps)


def test_late_and_repeated_frames_are_dropped():
    assert passed([0, 40, 20, 40, 80, 60, 120]) == [0, 40, None, None, 80, None, 120]


def test_a_clock_that_was_set_back_is_followed():
    step = S // 30
    old = [100 * S + i * step for i in range(5)]
    new = [i * step for i in range(6)]
    out = passed(old + new)
    assert out[:5] == old
    assert out[5:7] == [None, None]  # two could be stragglers
    kept = [old[-1], *out[7:]]
    assert [b - a for a, b in pairwise(kept)] == [step] * 4


def test_a_single_straggler_does_not_move_the_clock():
    assert passed([10 * S, 2 * S, 11 * S, 3 * S, 12 * S, 4 * S, 13 * S])[2::2] == [11 * S, 12 * S, 13 * S]


def test_after_a_restart_the_first_frame_counts():
    order = Order()
    passed([10 * S, 10 * S + 5], order)
    order.restart()
    assert passed([0, 7, 7], order) == [10 * S + 10, 10 * S + 17, None]
