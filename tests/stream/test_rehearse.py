"""How sure to be, chosen by hearing streams of people left out."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.stream.config import StreamConfig
from wigwag.stream.rehearse import Rehearsal, choose
from wigwag.stream.sureness import doubted
from wigwag.stream.truth import Showing
from wigwag.stream.watcher import Hypothesis

SECOND = 1_000_000_000
LABELS = ("stop", "wave")


def rehearsal(said: list[tuple[int, float, bool]]) -> tuple[Rehearsal, np.ndarray]:
    """One look every five seconds, at a gesture's end: its label, how sure it is, whether it is shown."""
    looks, showings = [], []
    for number, (label, _, shown) in enumerate(said):
        begin, end = 5 * number * SECOND, (5 * number + 2) * SECOND
        looks.append(
            Hypothesis(begin, end, 2.0, 0.1, 2.0, 0.1, False, True, (150 * number, 150 * number + 60))
        )
        if shown:
            showings.append(Showing(LABELS[label], begin, end))
    signs = np.zeros((len(said), 15))
    signs[:, 3] = 1.0
    return Rehearsal(
        0,
        tuple(showings),
        5.0 * len(said),
        looks,
        signs,
        np.array([label for label, _, _ in said]),
        np.array([shown for _, _, shown in said]),
        np.zeros(len(said), dtype=bool),
    ), np.array([sure for _, sure, _ in said])


def test_one_gesture_that_resembles_everyday_movement_does_not_silence_the_others() -> None:
    said = [(0, 0.75, True)] * 20 + [(1, 0.99, True)] * 10 + [(1, 0.9, False)] * 6
    one, sure = rehearsal(said)
    choice = choose([one], [sure], LABELS, StreamConfig(false_per_hour=1.0))
    assert choice.doubts[0] == 0
    assert choice.doubts[1] > 0
    believed = doubted(sure, choice.doubts[one.decided])
    spoken = believed >= choice.thresholds.going_on
    assert spoken[:30].all(), "everything that is shown"
    assert not spoken[30:].any(), "and nothing else"


def test_nobody_is_doubted_without_need() -> None:
    one, sure = rehearsal([(0, 0.75, True)] * 20 + [(1, 0.99, True)] * 10 + [(1, 0.3, False)] * 6)
    assert not choose([one], [sure], LABELS, StreamConfig(false_per_hour=1.0)).doubts.any()


def test_where_nothing_keeps_to_it_the_fewest_are_said() -> None:
    one, sure = rehearsal([(0, 1.0 - 1e-15, False)] * 10 + [(1, 0.9, True)] * 5)
    choice = choose([one], [sure], LABELS, StreamConfig(false_per_hour=0.0))
    assert np.isfinite(choice.doubts).all()


def test_doubt_lowers_log_odds() -> None:
    assert doubted(np.array([0.5, 1.0, 0.0]), 0.0) == pytest.approx([0.5, 1.0, 0.0])
    assert doubted(np.array([0.5]), np.log(3)) == pytest.approx([0.25])
    extreme = doubted(np.array([0.0, 1.0]), 2.0)
    assert np.isfinite(extreme).all()
    assert extreme[0] < extreme[1]
