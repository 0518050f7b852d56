"""When a look is spoken: sure enough, far enough, once."""

from __future__ import annotations

from dataclasses import replace

import pytest

from wigwag.errors import InputError
from wigwag.stream.config import StreamConfig
from wigwag.stream.speaker import Look, Speaker, Thresholds

S = 10**9
LOOK = Look("wave", 0.9, 0.8, 1 * S, 3 * S, resting=False, far=False, account="")


def speaker(earliness: float = 0.6) -> Speaker:
    return Speaker(StreamConfig(earliness=earliness), Thresholds(going_on=0.8, at_rest=0.6))


def test_a_sure_look_is_spoken_once() -> None:
    one = speaker()
    assert one.hear(LOOK) == LOOK
    assert not one.hear(replace(LOOK, now_ns=round(3.2 * S), progress=0.9))


def test_what_begins_after_it_is_heard_again() -> None:
    one = speaker()
    one.hear(LOOK)
    assert LOOK.end_ns == round(3.5 * S)
    assert one.hear(replace(LOOK, onset_ns=round(3.4 * S), now_ns=5 * S))


@pytest.mark.parametrize(
    ("change", "spoken"),
    [
        ({"probability": 0.79}, False),
        ({"progress": 0.65}, False),
        ({"far": True}, False),
        ({"probability": 0.65, "resting": True}, True),
        ({"progress": 0.5, "resting": True}, True),
        ({"probability": 0.55, "resting": True}, False),
    ],
)
def test_how_sure_and_how_far(change: dict[str, float | bool], spoken: bool) -> None:
    assert (speaker().hear(replace(LOOK, **change)) is not None) is spoken  # type: ignore[arg-type]


def test_the_earlier_the_less_must_have_passed() -> None:
    half = replace(LOOK, progress=0.55)
    assert not speaker(0.6).hear(half)
    assert speaker(1.0).hear(half)
    assert not speaker(0.0).hear(LOOK)


def at(second: float, **change: object) -> Look:
    return replace(LOOK, now_ns=round(second * S), **change)  # type: ignore[arg-type]


def test_what_was_sure_and_never_seemed_far_enough_is_spoken_at_rest() -> None:
    """A larger gesture than those taught: progress stays low, and its end looks like nothing."""
    one = speaker()
    assert one.hear(at(2.0, progress=0.5)) is None
    assert one.hear(at(2.2, progress=0.6)) is None
    said = one.hear(at(2.4, label="other", probability=0.1, resting=True))
    assert said is not None
    # It rests at 2.4 s, which may be a pause: by then 0.6 of it had passed in 1.2 s.
    assert (said.label, said.onset_ns, said.end_ns) == ("wave", LOOK.onset_ns, 3 * S)
    assert one.hear(at(2.6, label="other", probability=0.1, resting=True)) is None
    assert one.hear(at(3.3)) is None  # it began before what was spoken was over


@pytest.mark.parametrize(
    "looks",
    [
        [at(2.2, progress=0.6)],
        [at(2.0, progress=0.6), at(2.2, progress=0.6, label="other")],
        [at(2.0, progress=0.4), at(2.2, progress=0.4)],
        [at(2.0, progress=0.6, far=True), at(2.2, progress=0.6, far=True)],
        [at(2.0, progress=0.6, probability=0.7), at(2.2, progress=0.6, probability=0.7)],
        [at(0.5, progress=0.6), at(0.9, progress=0.6)],
    ],
    ids=["once", "two names", "just begun", "unlike", "unsure", "long ago"],
)
def test_what_waits_for_nothing(looks: list[Look]) -> None:
    one = speaker()
    assert [one.hear(look) for look in looks] == [None] * len(looks)
    assert one.hear(at(3.0, label="other", probability=0.1, resting=True)) is None


def test_what_may_not_be_spoken_does_not_wait() -> None:
    one = Speaker(StreamConfig(commands=("stop",)), Thresholds(0.8, 0.6))
    looks = [at(2.0, progress=0.6), at(2.2), at(3.0, resting=True)]
    assert [one.hear(look) for look in looks] == [None] * 3


def test_settings_out_of_range() -> None:
    with pytest.raises(InputError, match="earliness must be within 0 and 1"):
        StreamConfig(earliness=1.5)
    with pytest.raises(InputError, match="false_per_hour must be 0 or more"):
        StreamConfig(false_per_hour=-1)


def test_the_usual_length_says_most_of_where_a_gesture_lies() -> None:
    assert LOOK.span_ns == (1 * S, round(3.5 * S))
    longer = replace(LOOK, usual_s=4.0)  # 2 of 2.5 s seem to have passed: 3.56 s, ending 0.71 s from now
    onset_ns, end_ns = longer.span_ns
    assert end_ns * 1e-9 == pytest.approx(3.711, abs=0.001)
    assert onset_ns * 1e-9 == pytest.approx((1 + 3.711 - 3.557) / 2, abs=0.001)
    assert replace(LOOK, usual_s=2.5).span_ns == (1 * S, round(3.5 * S))
    assert replace(longer, now_ns=LOOK.onset_ns).span_ns == (1 * S, 1 * S)
