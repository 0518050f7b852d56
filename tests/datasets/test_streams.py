import numpy as np
import pytest

from tests.datasets.skeletons import msr_arrays, precog_arrays, saved, takes
from wigwag.datasets.streams import KINECT_SDK, load_streams
from wigwag.errors import DataError
from wigwag.skeleton import KINECT20, from_kinect20

HINT = "Fetch it."


def test_joint_order_of_the_file_does_not_matter(tmp_path) -> None:
    recorded = takes()
    expected = [from_kinect20(joints) for joints in recorded.values()]
    named = load_streams(saved(tmp_path / "a.npz", msr_arrays(recorded)), "*.npz", HINT)
    bare = load_streams(saved(tmp_path / "b.npz", precog_arrays(recorded)), "*.npz", HINT, KINECT_SDK)
    for streams in (named, bare):
        assert len(streams) == len(expected)
        for i, joints in enumerate(expected):
            np.testing.assert_allclose(streams.joints(i), joints, atol=1e-6)


def test_millimetres_become_metres(tmp_path) -> None:
    arrays = msr_arrays(takes())
    metres = arrays.pop("frames")
    arrays["frames_mm"] = np.round(metres * 1000).astype(np.int16)
    streams = load_streams(saved(tmp_path / "a.npz", arrays), "*.npz", HINT)
    np.testing.assert_allclose(streams.frames, metres, atol=0.0006)


def test_every_other_array_is_kept(tmp_path) -> None:
    arrays = msr_arrays(takes()) | {"events": np.array([[0, 1, 2]])}
    streams = load_streams(saved(tmp_path / "a.npz", arrays), "*.npz", HINT)
    assert streams.column("events", 1).tolist() == [[0, 1, 2]]
    assert streams.column("subject").tolist() == [1, 1, 3, 3, 1, 1, 3, 3]
    with pytest.raises(DataError, match=r"a\.npz: events must have 8 entries, but got 1"):
        streams.column("events")
    with pytest.raises(DataError, match=r"has no array 'gesture', which is expected there; it holds action"):
        streams.column("gesture")


def test_the_folder_will_do(tmp_path) -> None:
    saved(tmp_path / "set_dev.npz", msr_arrays(takes()))
    assert len(load_streams(tmp_path, "set*.npz", HINT)) == 8


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"offset": np.array([0, 5])}, "offset must rise from 0 to the 192 rows"),
        ({"offset": np.array([0, 100, 50, 192])}, "offset must rise"),
        ({"joint_names": np.array([*KINECT20[:19], "tail"])}, "joint_names must be"),
        ({"frames": np.zeros((192, 19, 3))}, r"frames must be numbers of shape \(rows, 20, 3\)"),
        ({"frames": np.full((192, 20, 3), "x")}, "frames must be numbers"),
    ],
)
def test_what_does_not_belong_together_is_refused(tmp_path, change, message) -> None:
    with pytest.raises(DataError, match=message):
        load_streams(saved(tmp_path / "a.npz", msr_arrays(takes()) | change), "*.npz", HINT)


def test_what_is_no_such_file_is_refused(tmp_path) -> None:
    with pytest.raises(DataError, match=r"nowhere: no such file or folder\. Fetch it\."):
        load_streams(tmp_path / "nowhere", "*.npz", HINT)
    with pytest.raises(DataError, match=r"holds no set\*\.npz\. Fetch it\."):
        load_streams(tmp_path, "set*.npz", HINT)
    (tmp_path / "text.npz").write_text("no numbers")
    with pytest.raises(DataError, match=r"text\.npz: is no readable \.npz file"):
        load_streams(tmp_path / "text.npz", "*.npz", HINT)
    np.save(tmp_path / "one.npy", np.zeros(3))
    with pytest.raises(DataError, match=r"one\.npy: holds one array"):
        load_streams(tmp_path / "one.npy", "*.npz", HINT)
    arrays = precog_arrays(takes())
    with pytest.raises(DataError, match="joint_names must be"):
        load_streams(saved(tmp_path / "bare.npz", arrays), "*.npz", HINT)
    arrays.pop("offset")
    with pytest.raises(DataError, match="needs 'offset' and 'frames'"):
        load_streams(saved(tmp_path / "a.npz", arrays), "*.npz", HINT, KINECT_SDK)


def test_a_cut_file_is_refused(tmp_path) -> None:
    whole = saved(tmp_path / "a.npz", msr_arrays(takes())).read_bytes()
    for share in (0.1, 0.5, 0.99):
        (tmp_path / "cut.npz").write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(DataError, match=r"cut\.npz"):
            load_streams(tmp_path / "cut.npz", "*.npz", HINT)
