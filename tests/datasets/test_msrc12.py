"""MSRC-12 from its NumPy file and from its official files."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.datasets.skeletons import SHARED, needs, saved
from tests.datasets.trees import movement
from wigwag.datasets.msrc12 import GESTURES, load_recordings
from wigwag.datasets.streams import KINECT_SDK
from wigwag.errors import DataError
from wigwag.skeleton import KINECT20, Landmark, from_kinect20

FRAMES = 60


def recorded(gesture: int, subject: int) -> np.ndarray:
    """Joints (frames, 20, 3), metres, KINECT20 order, whole millimetres."""
    return np.round(movement(gesture, subject, 1, FRAMES).transpose(2, 0, 1), 3)


def stamps(subject: int) -> np.ndarray:
    steps = 33_000 + 500 * (np.arange(FRAMES) % 3)
    return 2_700_000_000 + 1_000_000 * subject + np.cumsum(steps)


def arrays(takes: dict[tuple[int, int], np.ndarray], events: list[list[int]]) -> dict[str, np.ndarray]:
    order = [KINECT20.index(name) for name in KINECT_SDK]
    return {
        "name": np.array([f"P1_1_{g}_p{s:02d}" for g, s in takes]),
        "offset": np.arange(0, FRAMES * len(takes) + 1, FRAMES),
        "timestamp_us": np.concatenate([stamps(s) for _, s in takes]),
        "frames_mm": np.round(1000 * np.concatenate(list(takes.values()))[:, order]).astype(np.int16),
        "events": np.array(events),
        "joint_names": np.array(KINECT_SDK),
    }


def official(folder: Path, takes: dict[tuple[int, int], np.ndarray], events: list[list[int]]) -> Path:
    """Write ``.csv`` and ``.tagstream`` files as Microsoft Research gave them out."""
    folder.mkdir(parents=True)
    order = [KINECT20.index(name) for name in KINECT_SDK]
    for number, ((gesture, subject), joints) in enumerate(takes.items()):
        name = f"P1_1_{gesture}_p{subject:02d}"
        lines = []
        for at, frame in zip(stamps(subject), joints[:, order], strict=True):
            seen = 1.0 if frame.any() else 0.0
            lines.append(f"{at} " + " ".join(f"{x:.6f} {y:.6f} {z:.6f} {seen}" for x, y, z in frame))
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
        tags = ["XQPCTick;Tag"]
        for _, g, row in (e for e in events if e[0] == number):
            # The console's counter: 49 875 ticks a millisecond of the skeleton's clock, times 1000.
            tags.append(f"{int(stamps(subject)[row]) * 49_875 // 1000};G{g} {GESTURES.get(f'g{g}', '?')}")
        (folder / f"{name}.tagstream").write_text("\r\n".join(tags) + "\r\n")
    return folder


TAKES = {(1, 6): recorded(1, 6), (12, 9): recorded(12, 9)}
EVENTS = [[0, 1, 20], [0, 1, 45], [1, 12, 30]]


def test_streams_carry_names_stamps_and_action_points(tmp_path: Path) -> None:
    loaded = load_recordings(saved(tmp_path / "msrc12_x.npz", arrays(TAKES, EVENTS)))
    assert [r.stream.name for r in loaded.recordings] == ["P1_1_12_p09", "P1_1_1_p06"], (
        "in order of the names"
    )
    assert loaded.left_out == loaded.repaired == []
    one = loaded.recordings[1]
    assert (one.stream.subject, one.stream.label) == ("msrc12_p06", None)
    np.testing.assert_allclose(one.stream.joints, from_kinect20(TAKES[1, 6]), atol=1e-6)
    np.testing.assert_array_equal(one.stream.stamps_ns, (stamps(6) - stamps(6)[0]) * 1000)
    assert [(m.label, m.onset_ns) for m in one.marks] == [
        ("g1", int(one.stream.stamps_ns[i])) for i in (20, 45)
    ]
    assert all(m.duration_s == 0 for m in one.marks)
    upright = one.stream.joints
    assert (upright[:, Landmark.NOSE, 1] < upright[:, Landmark.LEFT_HEEL, 1]).all(), "y points down"
    assert [r.stream.subject for r in load_recordings(tmp_path, labels=("g12",)).recordings] == ["msrc12_p09"]
    assert len(load_recordings(tmp_path, subjects=("msrc12_p06",))) == 1


def test_official_files_give_the_same_streams(tmp_path: Path) -> None:
    expected = load_recordings(saved(tmp_path / "msrc12.npz", arrays(TAKES, EVENTS)))
    root = tmp_path / "official" / "MicrosoftGestureDataset-RC"
    data = official(root / "data", TAKES, EVENTS)
    packed = tmp_path / "MicrosoftGestureDataset-RC.zip"
    with zipfile.ZipFile(packed, "w") as archive:
        for file in sorted(data.iterdir()):
            archive.write(file, f"MicrosoftGestureDataset-RC/data/{file.name}")
    for path in (root.parent, root, data, packed):
        loaded = load_recordings(path)
        assert [r.stream.name for r in loaded.recordings] == [r.stream.name for r in expected.recordings]
        for one, other in zip(loaded.recordings, expected.recordings, strict=True):
            np.testing.assert_allclose(one.stream.joints, other.stream.joints, atol=1e-6)
            np.testing.assert_array_equal(one.stream.stamps_ns, other.stream.stamps_ns)
            assert [m.label for m in one.marks] == [m.label for m in other.marks]
            for mark, wanted in zip(one.marks, other.marks, strict=True):
                assert abs(mark.onset_ns - wanted.onset_ns) <= 2000, "ticks are rounded to the microsecond"


def test_frames_without_a_person_leave_a_hole(tmp_path: Path) -> None:
    takes = {(1, 6): TAKES[1, 6].copy(), (12, 9): 0 * TAKES[12, 9]}
    takes[1, 6][:3] = 0
    takes[1, 6][30:40] = 0
    content = arrays(takes, EVENTS)
    content["timestamp_us"][50] = content["timestamp_us"][48]
    loaded = load_recordings(saved(tmp_path / "msrc12.npz", content))
    (one,) = loaded.recordings
    assert len(one.stream) == FRAMES - 14
    assert np.diff(one.stream.stamps_ns).max() > 0.3e9
    assert one.marks[0].onset_ns == (stamps(6)[20] - stamps(6)[3]) * 1000
    said = "13 frames without a person left out, 1 frames that run back in time left out"
    assert loaded.repaired == [("P1_1_1_p06", said)]
    assert loaded.left_out == [("P1_1_12_p09", f"the person is seen in 0 of {FRAMES} frames only")]


def test_a_tag_that_makes_no_sense_is_named(tmp_path: Path) -> None:
    data = official(tmp_path / "data", TAKES, [*EVENTS, [0, 13, 5]])
    tags = data / "P1_1_12_p09.tagstream"
    tags.write_text(tags.read_text() + "later;G12 kick\n99999999999999;G12 kick\n")
    loaded = load_recordings(tmp_path)
    assert [len(r.marks) for r in loaded.recordings] == [1, 2]
    assert [name for name, _ in loaded.left_out] == ["P1_1_12_p09: 2 tag(s)", "P1_1_1_p06: 1 tag(s)"]


@pytest.mark.parametrize(
    ("content", "message"),
    [("one two\n", "no table of numbers"), ("1 2 3\n1 2 3\n", r"20 times x y z w a line"), ("", "20 times")],
)
def test_a_damaged_file_is_left_out_by_name(tmp_path: Path, content: str, message: str) -> None:
    data = official(tmp_path / "data", TAKES, EVENTS)
    (data / "P1_1_1_p06.csv").write_text(content)
    (data / "P1_1_2_p06.csv").write_text((data / "P1_1_12_p09.csv").read_text())
    loaded = load_recordings(tmp_path)
    assert [r.stream.name for r in loaded.recordings] == ["P1_1_12_p09"]
    reasons = dict(loaded.left_out)
    assert message in reasons["P1_1_1_p06"]
    assert "P1_1_2_p06.tagstream: not found" in reasons["P1_1_2_p06"]


def test_nothing_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="MicrosoftGestureDataset-RC"):
        load_recordings(tmp_path)
    with pytest.raises(DataError, match="no such file or folder"):
        load_recordings(tmp_path / "nowhere")
    content = arrays(TAKES, EVENTS)
    del content["events"]
    with pytest.raises(DataError, match="no array 'events'"):
        load_recordings(saved(tmp_path / "msrc12.npz", content))


@needs("msrc12")
def test_the_recorded_set() -> None:
    loaded = load_recordings(SHARED / "msrc12")
    assert len(loaded) == 197
    assert {m.label for r in loaded.recordings for m in r.marks} == set(GESTURES)
    assert sum(len(r.marks) for r in loaded.recordings) == 2116
    assert [why for _, why in loaded.left_out] == 2 * ["not within the stream, or of no known gesture"]
    assert sum(r.hours for r in loaded.recordings) == pytest.approx(2.37, abs=0.01)
