"""Gestures that are no commands stand in for those that nobody teaches."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from wigwag.stream.truth import Showing
from wigwag.stream.untaught import GROUPS, TAUGHT, Untaught
from wigwag.stream.watcher import Hypothesis

SECOND = 1_000_000_000


def stretch(begin_s: float, end_s: float) -> Hypothesis:
    begin, end = round(begin_s * SECOND), round(end_s * SECOND)
    return Hypothesis(begin, end, end_s - begin_s, 1.0, 2.0, 0.1, False, False, (0, 30))


@given(st.integers(1, 30), st.integers(0, 30), st.integers(0, 5))
def test_every_gesture_but_the_commands_is_left_out_once(known: int, commands: int, seed: int) -> None:
    labels = [f"gesture {i}" for i in range(known)]
    spoken = labels[: min(commands, known)]
    untaught = Untaught(labels, spoken, np.random.default_rng(seed))
    groups = dict(zip(labels, untaught.of_label, strict=True))
    assert all(groups[label] == TAUGHT for label in spoken)
    silent = [groups[label] for label in labels if label not in spoken]
    assert untaught.count == min(len(silent), GROUPS)
    assert set(silent) == set(range(untaught.count))
    sizes = np.bincount(silent) if silent else np.zeros(1)
    assert sizes.max() - sizes.min() <= 1


def test_where_all_may_be_spoken_none_is_left_out() -> None:
    untaught = Untaught(["a", "b"], None, np.random.default_rng(0))
    assert untaught.count == 0
    assert list(untaught.of_label) == [TAUGHT, TAUGHT]


def test_a_stretch_belongs_to_what_it_shares_most_time_with() -> None:
    untaught = Untaught(["go", "nod", "wave"], ["go"], np.random.default_rng(0))
    nod, wave = untaught.of_label[1:]
    truth = (
        Showing("nod", 0, SECOND),
        Showing("wave", SECOND, 3 * SECOND),
        Showing("go", 4 * SECOND, 5 * SECOND),
    )
    assert nod != wave
    assert untaught.of(stretch(0.2, 0.9), truth) == nod
    assert untaught.of(stretch(0.8, 2.0), truth) == wave
    assert untaught.of(stretch(3.9, 4.5), truth) == TAUGHT, "a command is always taught"
    assert untaught.of(stretch(3.1, 3.8), truth) == TAUGHT, "nothing is shown"
