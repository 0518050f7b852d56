"""Every figure of merit against cases that can be counted by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.datasets.recording import Mark
from wigwag.errors import InputError
from wigwag.evaluate.stream.metrics import (
    Watched,
    delays,
    f1,
    iou,
    jaccard,
    match_by_decision,
    match_by_moment,
    match_by_overlap,
    poisson_interval,
)
from wigwag.gesture import Gesture

S = 1_000_000_000


def mark(label: str, onset: float, end: float) -> Mark:
    return Mark(label, round(onset * S), round(end * S))


def said(label: str, onset: float, end: float, decided: float | None = None) -> Gesture:
    at = end if decided is None else decided
    return Gesture(label, 0.9, round(onset * S), round(end * S), round(at * S))


def seen(marks: list[Mark], events: list[Gesture], duration_s: float = 60.0) -> Watched:
    return Watched(duration_s, tuple(marks), tuple(events))


TRUTH = [mark("a", 10, 12), mark("b", 20, 22), mark("a", 30, 32)]


def test_a_perfect_run() -> None:
    watched = seen(TRUTH, [said(m.label, m.onset_ns / S, m.end_ns / S) for m in TRUTH])
    for match in (match_by_overlap, match_by_decision, match_by_moment):
        matched = match(watched)
        assert (len(matched.found), matched.missed, matched.false) == (3, (), ())
        assert f1([matched]) == 1.0
    assert jaccard([watched]) == 1.0


def test_each_way_of_being_wrong_is_counted_once() -> None:
    events = [
        said("a", 10, 12),
        said("a", 11.5, 12.4),  # the same gesture again
        said("c", 20, 22),  # a wrong name
        said("a", 40, 42),  # on nothing
    ]
    for match in (match_by_overlap, match_by_decision):
        matched = match(seen(TRUTH, events))
        assert [m.onset_ns // S for m, _ in matched.found] == [10]
        assert [m.onset_ns // S for m in matched.missed] == [20, 30]
        assert [e.label for e in matched.false] == ["a", "c", "a"]
        assert f1([matched]) == pytest.approx(2 / (2 + 2 + 3))


def test_overlap_counts_from_one_half_and_decision_from_a_touch() -> None:
    half = said("a", 10, 11)
    assert iou(TRUTH[0], half) == 0.5
    assert len(match_by_overlap(seen(TRUTH, [half])).found) == 1
    less = said("a", 10, 10.9)
    assert match_by_overlap(seen(TRUTH, [less])).found == ()
    assert len(match_by_decision(seen(TRUTH, [less])).found) == 1
    assert match_by_decision(seen(TRUTH, [said("a", 12.1, 13)])).found == ()


def test_one_event_answers_one_gesture() -> None:
    twice = [mark("a", 0, 2), mark("a", 2, 4)]
    matched = match_by_overlap(seen(twice, [said("a", 0, 4)]))
    assert (len(matched.found), len(matched.missed)) == (1, 1)
    better = match_by_overlap(seen([mark("a", 0, 4)], [said("a", 0, 3), said("a", 0, 4)]))
    assert better.found[0][1].end_ns == 4 * S, "the pair that overlaps most comes first"
    first = match_by_decision(seen([mark("a", 0, 4)], [said("a", 0, 4), said("a", 0, 3)]))
    assert first.found[0][1].decided_ns == 3 * S, "the earliest decision is the command"


def test_an_early_decision_is_about_the_gesture_that_goes_on() -> None:
    early = said("a", 9.9, 9.95, decided=9.97)
    assert match_by_decision(seen(TRUTH, [early])).found == (), "over before the gesture began"
    ahead = said("a", 9.9, 12, decided=9.97)
    assert len(match_by_decision(seen(TRUTH, [ahead])).found) == 1, "its end is foreseen within the gesture"


def test_action_points_are_met_within_a_third_of_a_second() -> None:
    points = [mark("a", 10, 10), mark("a", 20, 20)]
    events = [said("a", 9, 10, decided=10.3), said("a", 19, 20, decided=20.4), said("a", 30, 31)]
    matched = match_by_moment(seen(points, events))
    assert [e.decided_ns for _, e in matched.found] == [round(10.3 * S)]
    assert f1([matched]) == pytest.approx(2 / (2 + 1 + 2))
    nearest = match_by_moment(seen(points[:1], [said("a", 9, 9.8), said("a", 9, 10.1)]))
    assert nearest.found[0][1].decided_ns == round(10.1 * S)


def test_streams_are_counted_together() -> None:
    right = match_by_overlap(seen(TRUTH[:1], [said("a", 10, 12)]))
    silent = match_by_overlap(seen(TRUTH[1:], []))
    assert f1([right, silent]) == pytest.approx(2 / (2 + 2))
    assert f1([match_by_overlap(seen([], []))]) is None
    assert f1([match_by_overlap(seen([], [said("a", 1, 2)]))]) == 0.0


def test_jaccard_is_a_mean_over_classes_of_time_covered() -> None:
    half = seen([mark("a", 0, 2)], [said("a", 1, 3)])
    assert jaccard([half]) == pytest.approx(1 / 3)
    both = seen([mark("a", 0, 2), mark("b", 5, 6)], [said("a", 1, 3), said("c", 5, 6)])
    assert jaccard([both]) == pytest.approx((1 / 3 + 0 + 0) / 3)
    twice = seen([mark("a", 0, 2)], [said("a", 0, 1.5), said("a", 1, 2)])
    assert jaccard([twice]) == 1.0, "time that two events cover counts once"
    assert jaccard([seen([], [])]) is None


def test_delays_are_measured_from_either_end() -> None:
    found = delays([match_by_decision(seen(TRUTH, [said("a", 10, 12, 11), said("b", 20, 22, 22.5)]))])
    np.testing.assert_allclose(found.from_end_s, [-1.0, 0.5])
    np.testing.assert_allclose(found.from_onset_s, [1.0, 2.5])
    np.testing.assert_allclose(found.share_seen, [0.5, 1.0])
    assert len(delays([]).from_end_s) == 0


def test_poisson_interval_is_garwoods() -> None:
    """Limits for 1, 10 and 100 events as they stand in tables of the Poisson distribution."""
    assert poisson_interval(1, 1) == pytest.approx((0.0253, 5.572), abs=1e-3)
    assert poisson_interval(10, 1) == pytest.approx((4.795, 18.391), abs=1e-3)
    assert poisson_interval(100, 10) == pytest.approx((8.136, 12.163), abs=1e-3)
    assert poisson_interval(0, 3)[1] == pytest.approx(3.689 / 3, abs=1e-3)
    for count, hours in ((-1, 1.0), (1, 0.0)):
        with pytest.raises(InputError, match="count from 0 and hours above 0"):
            poisson_interval(count, hours)


@given(st.floats(0, 50), st.floats(0.1, 10), st.floats(1, 9))
def test_material_shown_again_tells_no_more(count: float, hours: float, repeats: float) -> None:
    once = poisson_interval(count, hours)
    again = poisson_interval(count * repeats, hours * repeats)
    assert once[0] <= count / hours <= once[1]
    assert again[1] - again[0] <= once[1] - once[0] + 1e-9, "counted as if it were new, it would seem to"


intervals = st.tuples(st.sampled_from("ab"), st.floats(0, 50), st.floats(0.1, 5))


@given(st.lists(intervals, max_size=8), st.lists(intervals, max_size=8))
def test_nothing_is_lost_or_counted_twice(truth: list, answers: list) -> None:
    watched = seen([mark(n, t, t + d) for n, t, d in truth], [said(n, t, t + d) for n, t, d in answers])
    for match in (match_by_overlap, match_by_decision, match_by_moment):
        matched = match(watched)
        assert len(matched.found) + len(matched.missed) == len(truth)
        assert len(matched.found) + len(matched.false) == len(answers)
        assert all(m.label == e.label for m, e in matched.found)
    value = jaccard([watched])
    assert value is None or 0 <= value <= 1


def test_what_is_no_command_is_refused() -> None:
    with pytest.raises(InputError, match="event without a label"):
        Watched(1.0, (), (Gesture(None, 0.5),))
    with pytest.raises(InputError, match="duration_s must be positive"):
        Watched(0.0, (), ())
