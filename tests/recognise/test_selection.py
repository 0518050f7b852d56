"""Settings chosen by leaving training people out."""

import numpy as np
import pytest

from tests.recognise.test_doubt import lesson
from wigwag.recognise.acceptance import BACKGROUND
from wigwag.recognise.doubt import targets_of
from wigwag.recognise.selection import RIDGES, WIDTHS, choose


def features_at(relative: np.ndarray, views: int = 7):
    return lambda width: np.repeat(np.exp(-relative / views / (3 * width)), views, axis=1)


def by_hand(features, numbers, people, ridge) -> np.ndarray:
    """Scores of everybody who is left out in turn, by plain normal equations; one row a clip."""
    scores = np.empty((len(numbers), int(numbers.max()) + 1))
    for person in np.unique(people):
        kept = people != person
        taught = features[np.ix_(kept, np.repeat(kept, 7))].astype(np.float64)
        gram = taught.T @ taught + ridge * kept.sum() * np.eye(taught.shape[1])
        weights = np.linalg.solve(gram, taught.T @ targets_of(numbers[kept], scores.shape[1]))
        scores[~kept] = (features[np.ix_(~kept, np.repeat(kept, 7))] @ weights)[:, :-1]
    return scores


def test_the_pair_that_forecasts_people_best_who_are_left_out():
    _, relative, numbers, people, _ = lesson(0, 4, 4, spread=1.2)
    width, ridge, losses = choose(features_at(relative), numbers, people)
    assert set(losses) == {(w, r) for w in WIDTHS for r in RIDGES}
    assert losses[width, ridge] == min(losses.values())
    for pair in ((WIDTHS[0], RIDGES[0]), (WIDTHS[2], RIDGES[3])):
        scores = by_hand(features_at(relative)(pair[0]), numbers, people, pair[1])
        found = []
        for sharpness in (2.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0):
            odds = np.exp(sharpness * scores)
            odds /= odds.sum(axis=1, keepdims=True)
            found.append(-np.mean(np.log(odds[np.arange(len(numbers)), numbers])))
        assert losses[pair] == pytest.approx(min(found), rel=1e-4)


def test_noise_asks_for_a_stronger_penalty():
    _, relative, numbers, people, _ = lesson(1, 5, 6, spread=1.5)
    rng = np.random.default_rng(0)

    def noisy(_: float) -> np.ndarray:
        features = features_at(relative)(1.0)
        return features + rng.normal(0, 0.3, features.shape)

    _, ridge, _ = choose(noisy, numbers, people, (1.0,), (1e-6, 1.0))
    assert ridge == 1.0


def test_what_is_no_gesture_is_learned_from_but_not_forecast():
    _, relative, numbers, people, _ = lesson(2, 3, 4, background=1)
    assert (numbers == BACKGROUND).any()
    _, _, losses = choose(features_at(relative), numbers, people)
    assert np.isfinite(list(losses.values())).all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("alone", [True, False], ids=["one person", "nothing in common"])
def test_where_nobody_can_be_left_out_the_middle_candidates_are_taken(alone):
    """Bug: of people who show nothing in common, an empty list was joined."""
    _, relative, numbers, people, _ = lesson(3, 4, 1, 1)
    people = people if alone else np.arange(4)
    assert choose(features_at(relative), numbers, people) == (WIDTHS[1], RIDGES[2], {})
