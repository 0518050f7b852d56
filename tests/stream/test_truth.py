"""What a stretch truly is, by where it begins and how much of a gesture has passed."""

from __future__ import annotations

import pytest

from wigwag.errors import InputError
from wigwag.stream.truth import Showing, meaning
from wigwag.stream.watcher import Hypothesis

S = 10**9
GESTURE = Showing("wave", 10 * S, 12 * S)


def stretch(onset_s: float, now_s: float) -> Hypothesis:
    onset, now = round(onset_s * S), round(now_s * S)
    return Hypothesis(onset, now, now_s - onset_s, 1.0, 1.0, 0.1, False, False, (0, 1))


@pytest.mark.parametrize(
    ("onset_s", "now_s", "showing", "doubtful"),
    [
        (10.0, 11.4, 0, False),
        (10.3, 12.3, 0, False),
        (10.0, 10.5, None, True),
        (10.0, 10.2, None, False),
        (10.6, 12.0, None, True),
        (11.0, 12.0, None, False),
        (10.0, 13.0, None, False),
        (4.0, 6.0, None, False),
    ],
)
def test_meaning(onset_s: float, now_s: float, showing: int | None, doubtful: bool) -> None:
    found = meaning(stretch(onset_s, now_s), [GESTURE])
    assert (found.showing, found.doubtful) == (showing, doubtful)


def test_progress_is_the_share_that_has_passed() -> None:
    assert meaning(stretch(10.0, 11.4), [GESTURE]).progress == pytest.approx(0.7)


def test_a_showing_does_not_end_before_it_begins() -> None:
    with pytest.raises(InputError, match="must not end before it begins"):
        Showing("wave", 2, 1)
