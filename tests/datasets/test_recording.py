import numpy as np
import pytest

from wigwag.datasets.recording import Mark, Recording, Recordings
from wigwag.errors import InputError
from wigwag.skeleton import Clip


def test_a_mark_does_not_end_before_it_begins() -> None:
    assert Mark("g1", 5, 5).duration_s == 0
    with pytest.raises(InputError, match="'g1' must not end before it begins, but ends 2 ns earlier"):
        Mark("g1", 5, 3)


def test_recordings_are_counted_and_give_their_streams() -> None:
    stream = Clip.at_rate(np.zeros((61, 13, 3)), 30)
    loaded = Recordings([Recording(stream)])
    assert (len(loaded), loaded.clips) == (1, [stream])
    assert loaded.recordings[0].hours == pytest.approx(2 / 3600)
