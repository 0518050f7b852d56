"""UTKinect from its NumPy file and from its official files, with their defects."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.datasets.skeletons import SHARED, needs, saved
from tests.datasets.trees import movement
from wigwag.datasets.streams import KINECT_SDK
from wigwag.datasets.utkinect import ACTIONS, COUNTS_HZ, load_recordings
from wigwag.errors import DataError
from wigwag.skeleton import KINECT20, from_kinect20

FRAMES = 40
ORDER = [KINECT20.index(name) for name in KINECT_SDK]
NUMBERS = 100 + np.cumsum(2 + 2 * (np.arange(FRAMES) % 3))
SEGMENTS = [("walk", 110, 150), ("carry", 160, 200), ("push", 210, 250)]


def joints(subject: int) -> np.ndarray:
    return movement(1, subject, 1, FRAMES).transpose(2, 0, 1)


def arrays(segments: list[tuple[str, int, int]] = SEGMENTS) -> dict[str, np.ndarray]:
    rows = [[i, ACTIONS.index(a), s, e, 0, 0] for i in range(2) for a, s, e in segments]
    return {
        "subject": np.array([2, 1]),
        "episode": np.array([1, 2]),
        "offset": np.array([0, FRAMES, 2 * FRAMES]),
        "frames": np.concatenate([joints(2), joints(1)])[:, ORDER].astype(np.float32),
        "frame_index": np.tile(NUMBERS, 2),
        "segments": np.array(rows),
        "action_names": np.array(ACTIONS),
        "joint_names": np.array(KINECT_SDK),
    }


def official(root: Path, labels: str, numbers: np.ndarray = NUMBERS) -> Path:
    (root / "joints").mkdir(parents=True)
    for name, subject in (("s01_e02", 1), ("s02_e01", 2)):
        lines = [
            f"{n} " + " ".join(f"{v:.6f}" for v in frame.ravel())
            for n, frame in zip(numbers, joints(subject)[:, ORDER], strict=True)
        ]
        (root / "joints" / f"joints_{name}.txt").write_text("\n".join(lines) + "\n")
    (root / "actionLabel.txt").write_text(labels)
    return root


def labels(extra: str = "") -> str:
    block = "".join(f"{a}: {s} {e} \n" for a, s, e in SEGMENTS)
    return f"s01_e02 \n{block}{extra}s02_e01\n{block}"


def test_actions_are_scenes_and_time_is_irregular(tmp_path: Path) -> None:
    loaded = load_recordings(saved(tmp_path / "utkinect.npz", arrays()))
    assert [r.stream.name for r in loaded.recordings] == ["utkinect_s01_e02", "utkinect_s02_e01"]
    one = loaded.recordings[0]
    assert (one.stream.subject, one.marks) == ("utkinect_s01", ())
    np.testing.assert_allclose(one.stream.joints, from_kinect20(joints(1)), atol=1e-6)
    np.testing.assert_allclose(one.stream.times_s, (NUMBERS - NUMBERS[0]) / COUNTS_HZ, atol=1e-9)
    assert [s.label for s in one.scenes] == ["walk", "carry", "push"]
    assert one.scenes[0].onset_ns * 1e-9 == pytest.approx((110 - NUMBERS[0]) / COUNTS_HZ)
    assert one.scenes[0].duration_s == pytest.approx(40 / COUNTS_HZ)
    assert len(load_recordings(tmp_path, subjects=("utkinect_s02",))) == 1


def test_official_files_give_the_same_streams(tmp_path: Path) -> None:
    expected = load_recordings(saved(tmp_path / "utkinect.npz", arrays()))
    root = official(tmp_path / "text", labels())
    packed = tmp_path / "UTKinect.zip"
    with zipfile.ZipFile(packed, "w") as archive:
        for file in (*sorted((root / "joints").iterdir()), root / "actionLabel.txt"):
            archive.write(file, file.relative_to(root))
    for path in (root, root / "joints", packed):
        loaded = load_recordings(path)
        for one, other in zip(loaded.recordings, expected.recordings, strict=True):
            assert (one.stream.name, one.scenes) == (other.stream.name, other.scenes)
            np.testing.assert_allclose(one.stream.joints, other.stream.joints, atol=2e-6)
            np.testing.assert_array_equal(one.stream.stamps_ns, other.stream.stamps_ns)


def test_known_defects_are_named_and_left_out(tmp_path: Path) -> None:
    """An action that was not recorded (NaN), one that ends before it starts, frames written twice."""
    numbers = NUMBERS.copy()
    numbers[10] = numbers[9]
    root = official(tmp_path / "t", labels("pull: NaN NaN\nthrow: 260 240\nwaveHands: 900 950\n"), numbers)
    loaded = load_recordings(root)
    assert [s.label for s in loaded.recordings[0].scenes] == ["walk", "carry", "push"]
    assert dict(loaded.left_out) == {
        "utkinect_s01_e02: pull": "not recorded",
        "utkinect_s01_e02: throw": "ends at frame 240, before it starts at 260",
        "utkinect_s01_e02: waveHands": "lies outside of the stream",
    }
    assert [len(r.stream) for r in loaded.recordings] == [FRAMES - 1, FRAMES - 1]
    assert loaded.repaired[0][1] == "1 frames without a person or repeated left out"


def test_damaged_files_are_left_out_by_name(tmp_path: Path) -> None:
    root = official(tmp_path / "t", labels())
    (root / "joints" / "joints_s01_e02.txt").write_text("1 2 3\n4 5 6\n")
    assert load_recordings(root).left_out[0][0] == "utkinect_s01_e02"
    (root / "joints" / "joints_s01_e02.txt").write_text("a b\n")
    assert "no table of numbers" in load_recordings(root).left_out[0][1]
    (root / "actionLabel.txt").write_text("s02_e01\nwalk: 110 150\n")
    (root / "joints" / "joints_s01_e02.txt").write_text((root / "joints" / "joints_s02_e01.txt").read_text())
    assert "no actions of s01_e02" in load_recordings(root).left_out[0][1]
    (root / "actionLabel.txt").unlink()
    with pytest.raises(DataError, match=r"no actionLabel\.txt"):
        load_recordings(root)


def test_a_stream_that_shows_nobody_is_refused(tmp_path: Path) -> None:
    content = arrays()
    content["frames"] *= 0
    with pytest.raises(DataError, match="no usable recording of anyone; 2 left out"):
        load_recordings(saved(tmp_path / "utkinect.npz", content))
    del content["segments"]
    with pytest.raises(DataError, match="no arrays 'segments'"):
        load_recordings(saved(tmp_path / "utkinect.npz", content))


@needs("utkinect")
def test_the_recorded_set() -> None:
    loaded = load_recordings(SHARED / "utkinect")
    assert len(loaded) == 10
    assert {r.stream.subject for r in loaded.recordings} == {f"utkinect_s0{i}" for i in range(1, 6)}
    assert {s.label for r in loaded.recordings for s in r.scenes} == set(ACTIONS)
    steps = np.concatenate([np.diff(r.stream.times_s) for r in loaded.recordings])
    assert 1 / 15 <= np.median(steps) <= 1 / 10
