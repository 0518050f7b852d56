import numpy as np
import pytest

from tests.datasets.skeletons import SHARED, needs, precog_arrays, saved, takes
from wigwag.datasets.precog import load_background, load_recordings
from wigwag.errors import DataError, InputError
from wigwag.skeleton import from_kinect20


@pytest.fixture
def file(tmp_path):
    recorded = takes(actions=(1, 2), subjects=(1, 10), trials=(1,), frames=150)
    recorded[2, 10, 1][:] = 0
    return saved(tmp_path / "precog_x.npz", precog_arrays(recorded))


def test_recordings_have_no_label(file) -> None:
    loaded = load_recordings(file.parent)
    assert [c.name for c in loaded.clips] == ["precog_q1_s01", "precog_q1_s10", "precog_q2_s01"]
    assert {c.label for c in loaded.clips} == {None}
    assert loaded.left_out == [("precog_q2_s10", "nobody is seen: every frame is zero")]
    assert loaded.clips[0].duration_s == pytest.approx(149 / 30)
    first = takes(actions=(1,), subjects=(1,), trials=(1,), frames=150)[1, 1, 1]
    np.testing.assert_allclose(loaded.clips[0].joints, from_kinect20(first), atol=1e-6)


def test_background_is_the_recordings_in_pieces(file) -> None:
    whole, pieces = load_recordings(file), load_background(file, length_s=2.0, step_s=1.0)
    assert len(pieces) == 3 * 4
    assert {len(c) for c in pieces.clips} == {60}
    np.testing.assert_array_equal(pieces.clips[2].joints, whole.clips[0].joints[60:120])
    assert pieces.clips[2].subject == "precog_s01"
    assert pieces.left_out == whole.left_out
    assert len(load_background(file, length_s=60.0)) == 3, "a short recording is one piece"
    with pytest.raises(InputError, match="too short"):
        load_background(file, length_s=0.01)


def test_a_set_that_shows_nobody_is_refused(tmp_path) -> None:
    nobody = {key: 0 * joints for key, joints in takes().items()}
    with pytest.raises(DataError, match="shows nobody in any of 8 recordings"):
        load_recordings(saved(tmp_path / "precog.npz", precog_arrays(nobody)))


@needs("precog")
def test_the_recorded_set() -> None:
    loaded = load_recordings(SHARED / "precog")
    assert len(loaded) == 70
    assert [name for name, _ in loaded.left_out] == ["precog_q2_s10", "precog_q4_s10"]
    assert len(load_background(SHARED / "precog")) > 300
