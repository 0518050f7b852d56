"""Votes, k, confidence and threshold, from distances made by hand."""

import numpy as np
import pytest

from wigwag.recognise.confidence import BACKGROUND, Confidence, Evidence, choose_k, held_out, weigh


def test_majority_decides_and_a_tie_goes_to_the_nearer():
    distances = np.array([1.0, 2.0, 2.5, 9.0])
    numbers = np.array([0, 1, 1, 2])
    evidence = weigh(distances, numbers, np.array([0, 1, 2]), distances[:3])
    assert evidence == Evidence(decided=1, share=2 / 3, nearest=2.0, rival=1.0)
    tie = weigh(distances, numbers, np.array([0, 1]), distances[:2])
    assert tie.decided == 0
    alone = weigh(distances[1:3], numbers[1:3], np.array([0]), distances[1:2])
    assert alone.rival == np.inf


def test_nobody_is_judged_by_their_own_clips():
    distances = np.zeros((4, 4))
    by_person = held_out(distances, ["a", "a", "b", None])
    assert by_person.tolist() == [
        [False, False, True, True],
        [False, False, True, True],
        [True, True, False, True],
        [True, True, True, False],
    ]
    assert held_out(distances, ["a"] * 4).tolist() == (~np.eye(4, dtype=bool)).tolist()


def world(people=6, takes=4, classes=4, spread=0.15, seed=0):
    """Points in a plane; distances between them stand for those between clips."""
    rng = np.random.default_rng(seed)
    numbers = np.tile(np.arange(classes), people * takes)
    subjects = [f"p{i}" for i in range(people) for _ in range(takes * classes)]
    centers = rng.normal(size=(classes, 2)) * 2
    points = centers[numbers] + rng.normal(0, spread, (len(numbers), 2))
    return np.linalg.norm(points[:, None] - points[None], axis=2), numbers, subjects


def test_k_is_the_smallest_that_is_not_clearly_worse():
    distances, numbers, subjects = world()
    k, scores = choose_k(distances, numbers, held_out(distances, subjects), (1, 3, 5))
    assert (k, scores[1]) == (1, 1.0)
    rng = np.random.default_rng(1)
    wrong = numbers.copy()
    flipped = rng.choice(len(numbers), len(numbers) // 5, replace=False)
    wrong[flipped] = rng.integers(0, 4, len(flipped))  # one example in five is mislabelled
    k, scores = choose_k(distances, wrong, held_out(distances, subjects), (1, 3, 5, 7))
    assert k > 1
    assert scores[k] > scores[1] + 0.03


@pytest.mark.parametrize("spread", [0.05, 0.15, 0.3, 0.4, 0.6, 2.0])
@pytest.mark.parametrize("k", [1, 3])
def test_confidence_never_rises_with_the_rival_or_with_novelty_or_dissent(spread, k):
    distances, numbers, subjects = world(spread=spread)
    confidence = Confidence().fit(distances, numbers, held_out(distances, subjects), k)
    usual = float(confidence.typical_[0])
    by_rival = [confidence(Evidence(0, 1.0, usual, r * usual)) for r in (10, 2, 1.05, 0.9)]
    by_novelty = [confidence(Evidence(0, 1.0, n * usual, 2 * n * usual)) for n in (0.5, 1, 2, 8)]
    by_share = [confidence(Evidence(0, share, usual, 2 * usual)) for share in (1, 2 / 3, 1 / 3)]
    for series in (by_rival, by_novelty, by_share):
        assert series == sorted(series, reverse=True)
    if spread < 1:  # beyond, the classes lie on top of each other and nothing tells right from wrong
        assert by_novelty[-1] < by_novelty[0]


def test_clear_cases_are_near_certain():
    distances, numbers, subjects = world(spread=0.1)
    confidence = Confidence().fit(distances, numbers, held_out(distances, subjects), 1)
    usual = float(confidence.typical_[0])
    assert confidence(Evidence(0, 1.0, usual, 10 * usual)) > 0.9
    assert confidence(Evidence(0, 1.0, 20 * usual, 21 * usual)) < 0.1


@pytest.mark.parametrize(("false_accept", "false_reject"), [(0.02, 1.0), (0.0, 1.0), (0.2, 1.0), (0.0, 0.1)])
def test_threshold_keeps_the_rates_it_was_asked_for(false_accept, false_reject):
    distances, numbers, subjects = world(spread=0.5, seed=2)
    confidence = Confidence(false_accept, false_reject)
    confidence.fit(distances, numbers, held_out(distances, subjects), 1)
    rates = confidence.rates_
    assert rates["false_reject"] <= false_reject + 0.01
    if false_reject == 1.0:
        assert rates["false_accept"] <= false_accept


def test_background_is_never_accepted_as_itself():
    distances, numbers, subjects = world()
    numbers = np.where(numbers == 3, BACKGROUND, numbers)
    confidence = Confidence().fit(distances, numbers, held_out(distances, subjects), 1)
    assert len(confidence.typical_) == 3
