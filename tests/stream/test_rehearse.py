"""Thresholds, chosen by what came of hearing people who took no part in teaching."""

from __future__ import annotations

import numpy as np

from wigwag.stream.config import StreamConfig
from wigwag.stream.rehearse import Rehearsal, choose
from wigwag.stream.truth import Showing
from wigwag.stream.watcher import Hypothesis

S = 10**9
PROGRESS = 3
"""Its place among the signs."""


def look_at(onset_s: float, now_s: float) -> Hypothesis:
    length = now_s - onset_s
    return Hypothesis(round(onset_s * S), round(now_s * S), length, 1.0, 2.0, 0.1, False, False, (0, 30))


def rehearsal(looks: list[Hypothesis]) -> Rehearsal:
    """One stream of ten minutes with one gesture, from 10 to 12 s; each look sees it nearly over."""
    signs = np.zeros((len(looks), 15))
    signs[:, PROGRESS] = 0.9
    decided, right = np.zeros(len(looks), dtype=np.int64), np.ones(len(looks), dtype=bool)
    return Rehearsal(0, (Showing("wave", 10 * S, 12 * S),), 600.0, looks, signs, decided, right, ~right)


def test_of_thresholds_that_are_equally_good_the_middle_ones_are_taken() -> None:
    one = rehearsal([look_at(10, 11.8)])
    chosen = choose([one], [np.array([0.951])], ["wave"], StreamConfig())
    assert chosen.going_on == 0.8  # of 0.5 to 0.95
    assert chosen.at_rest == 0.8  # nothing rests: of all


def test_what_would_be_spoken_of_nothing_is_no_longer_equally_good() -> None:
    one = rehearsal([look_at(10, 11.8), look_at(100, 101.8)])
    chosen = choose([one], [np.array([0.951, 0.65])], ["wave"], StreamConfig())
    assert chosen.going_on == 0.85  # of 0.7 to 0.95
    loud = choose([one], [np.array([0.951, 0.96])], ["wave"], StreamConfig())
    assert loud.going_on == 0.985  # of 0.97 to 0.995: rather nothing than one false in ten minutes


def test_who_shows_nothing_is_heard_with_the_middle_of_all() -> None:
    chosen = choose([], [], ["wave"], StreamConfig())
    assert (chosen.going_on, chosen.at_rest) == (0.93, 0.8)


def test_deliberate_movement_counts_by_what_it_costs_and_not_by_the_hour() -> None:
    config, sure = StreamConfig(), [np.array([0.951]), np.array([0.96])]
    one, other = rehearsal([look_at(10, 11.8)]), rehearsal([look_at(100, 101.8)])
    other.truth = ()
    everyday = choose([one, other], sure, ["wave"], config)
    assert everyday.going_on == 0.985  # of 0.97 to 0.995: rather nothing than three false an hour
    other.deliberate = True
    beside = choose([one, other], sure, ["wave"], config)
    assert beside.going_on < 0.951  # found, at the price of one false command that nobody says by the way
