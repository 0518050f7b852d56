"""NTU RGB+D on generated files in the set's form: bodies, identities, tracking states, damage."""

import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from wigwag.datasets.notes import Notes
from wigwag.datasets.ntu import KINECT25, parse_skeleton, read_ntu
from wigwag.errors import DataError
from wigwag.skeleton import LANDMARKS, Landmark

NAME = "S001C002P003R001A023"
BIG = 72057594037931101
"""A tracking id as in the set: as a double it equals its neighbours."""

Seen = tuple[int, np.ndarray, np.ndarray]
"""Identity, joints (25, 3), states (25,)."""


def standing(x: float = 0.0) -> np.ndarray:
    """Kinect frame, metres: y up, the person's right at +x."""
    left = {
        "shoulder": (0.18, 0.45), "elbow": (0.25, 0.2), "wrist": (0.27, -0.05), "hand": (0.27, -0.1),
        "hip": (0.1, 0), "knee": (0.11, -0.4), "ankle": (0.12, -0.8), "foot": (0.12, -0.85),
        "hand_tip": (0.27, -0.2), "thumb": (0.24, -0.12),
    }  # fmt: skip
    middle = {"hip_center": 0.0, "spine": 0.25, "neck": 0.5, "head": 0.65, "shoulder_center": 0.45}
    points = []
    for name in KINECT25:
        side, _, part = name.partition("_")
        if name in middle:
            points.append((x, middle[name], 3.0))
        else:
            points.append((x + left[part][0] * (-1 if side == "left" else 1), left[part][1], 3.0))
    return np.array(points)


def moving(frame: int, x: float = 0.0, by: float = 0.3) -> np.ndarray:
    joints = standing(x)
    joints[KINECT25.index("right_wrist")] += [0, by * np.sin(frame / 4), -by * (1 - np.cos(frame / 4))]
    return joints


def ok() -> np.ndarray:
    return np.full(25, 2)


def content(frames: Sequence[Sequence[Seen]]) -> str:
    lines = [str(len(frames))]
    for bodies in frames:
        lines.append(str(len(bodies)))
        for identity, joints, states in bodies:
            lines += [f"{identity} 0 1 1 1 1 0 0.02 -0.1 2", "25"]
            lines += [
                " ".join(f"{v:.7f}" for v in p) + f" 250.1 190.2 950.3 530.4 -0.2 0.03 0.9 -0.1 {s}"
                for p, s in zip(joints, states, strict=True)
            ]
    return "\r\n".join(lines) + "\r\n"


def read(tmp_path: Path, frames: Sequence[Sequence[Seen]], name: str = NAME):
    (tmp_path / f"{name}.skeleton").write_text(content(frames))
    notes = Notes()
    return list(read_ntu(tmp_path, notes)), notes


def test_landmarks_axes_and_names(tmp_path: Path) -> None:
    [clip], notes = read(tmp_path, [[(BIG, moving(f), ok())] for f in range(30)])
    assert (clip.name, clip.label, clip.subject) == (NAME, "A023", "ntu_p003")
    assert clip.duration_s == pytest.approx(29 / 30)
    assert notes == Notes()
    for frame in (0, 17):
        expected = moving(frame)
        for i, landmark in enumerate(LANDMARKS):
            part = landmark.replace("nose", "head").replace("heel", "ankle")
            x, y, z = expected[KINECT25.index(part)]
            np.testing.assert_allclose(clip.joints[frame, i], [-x, -y, z], atol=1e-6)
    assert clip.joints[0, Landmark.LEFT_HIP, 0] > 0, "facing the camera, the left is on the picture's right"
    assert clip.joints[0, Landmark.LEFT_HEEL, 1] > 0, "y points down"


def test_identities_that_are_one_as_doubles_are_two_bodies() -> None:
    assert float(BIG) == float(BIG + 1)
    bodies = parse_skeleton(content([[(BIG, standing(), ok()), (BIG + 1, standing(1), ok())]] * 3), "x")
    assert [body.identity for body in bodies] == [str(BIG), str(BIG + 1)]


def test_of_several_bodies_the_most_moving_of_the_long_ones(tmp_path: Path) -> None:
    frames = [
        [(1, standing(-1), ok()), (2, moving(f), ok()), *([(3, moving(f, 1.5, by=3), ok())] if f < 8 else [])]
        for f in range(30)
    ]
    [clip], notes = read(tmp_path, frames)
    np.testing.assert_allclose(clip.joints[:, Landmark.NOSE, 0], 0, atol=1e-6)
    [(file, said)] = notes.repaired
    assert file == f"{NAME}.skeleton" and said.startswith(
        "2 of 3 bodies left out: kept the one that moves most"
    )


def test_furniture_counts_only_alone(tmp_path: Path) -> None:
    def chair(f: int) -> np.ndarray:
        jitter = np.random.default_rng(f).normal(0, 0.5, (25, 3))
        return standing(1.0) * [1, 0.1, 1] + jitter * [1.5, 0.2, 1]

    [clip], _ = read(tmp_path, [[(1, chair(f), ok()), (2, moving(f), ok())] for f in range(30)])
    np.testing.assert_allclose(clip.joints[:, Landmark.NOSE, 0], 0, atol=1e-6)
    lying = standing()[:, [1, 0, 2]]
    [clip], _ = read(tmp_path, [[(1, lying, ok())] for f in range(30)])
    assert clip.joints[0, Landmark.NOSE, 0] == pytest.approx(-0.65), "a person who lies is one all the same"


def test_a_track_lost_and_found_again_is_one_person(tmp_path: Path) -> None:
    frames: list[list[Seen]] = [[(1, moving(f), ok())] for f in range(12)]
    frames += [[] for _ in range(3)]
    frames += [[(7, moving(f), ok())] for f in range(15, 30)]
    [clip], notes = read(tmp_path, frames)
    assert len(clip) == 30
    [(_, said)] = notes.repaired
    assert said == "2 tracks joined into one person, 3 frames without a person filled in"


def test_another_person_elsewhere_is_not_joined(tmp_path: Path) -> None:
    frames: list[list[Seen]] = [[(1, moving(f), ok())] for f in range(14)]
    frames += [[(7, moving(f, x=1.2), ok())] for f in range(14, 30)]
    [clip], notes = read(tmp_path, frames)
    assert len(clip) in {14, 16} and "1 of 2 bodies left out" in notes.repaired[0][1]
    assert np.ptp(clip.joints[:, Landmark.NOSE, 0]) < 1e-6


def test_joints_that_are_not_tracked_are_filled_in(tmp_path: Path) -> None:
    wrist = KINECT25.index("right_wrist")
    frames = []
    for f in range(30):
        joints, states = moving(f), ok()
        if 10 <= f < 14:
            joints[wrist] = 0
            states[wrist] = 0
        states[KINECT25.index("left_ankle")] = 1
        frames.append([(1, joints, states)])
    [clip], notes = read(tmp_path, frames)
    path = clip.joints[:, Landmark.RIGHT_WRIST]
    expected = path[9] + (path[14] - path[9]) * 2 / 5
    np.testing.assert_allclose(path[11], expected, atol=1e-6)
    assert notes.repaired[0][1] == "4 joints that were not tracked filled in"


def test_a_joint_that_is_hardly_ever_tracked(tmp_path: Path) -> None:
    states = ok()
    states[KINECT25.index("left_knee")] = 0
    clips, notes = read(tmp_path, [[(1, moving(f), states if f > 5 else ok())] for f in range(30)])
    assert clips == []
    assert notes.left_out == [(f"{NAME}.skeleton", "left_knee is not tracked in 24 of 30 frames")]


@pytest.mark.parametrize("frames", [[], [[], [], []]])
def test_empty_recordings_are_left_out_by_name(tmp_path: Path, frames: list) -> None:
    clips, notes = read(tmp_path, frames)
    assert clips == [] and "nobody is seen" in notes.left_out[0][1]


def test_damage_says_where() -> None:
    whole = content([[(1, standing(), ok())]] * 3)
    words = whole.split()
    for text, said in (
        (" ".join(words[:-5]), "x: ends within frame 2; it was cut off"),
        ("", "x: ends within the number of frames"),
        (whole + " 1", "x: goes on after the 3 frames"),
        ("two", "x: the number of frames must be a whole number, but got 'two'"),
        (whole.replace("0.6500000", "zero", 1), "x: frame 0 holds what is no number"),
        (whole.replace("\n25", "\n20", 1), "x: frame 0 has a body of 20 joints"),
        (whole.replace("3\r\n1\r\n", "3\r\n-1\r\n", 1), "x: the number of bodies of frame 0"),
    ):
        with pytest.raises(DataError, match=said):
            parse_skeleton(text, "x")


def test_file_folder_zip_and_strange_names(tmp_path: Path) -> None:
    text = content([[(1, moving(f), ok())] for f in range(12)])
    folder = tmp_path / "nturgb+d_skeletons"
    folder.mkdir()
    for name in ("S001C001P002R001A001", "S001C001P001R001A002"):
        (folder / f"{name}.skeleton").write_text(text)
    with zipfile.ZipFile(tmp_path / "nturgbd_skeletons_s001_to_s017.zip", "w") as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, f"nturgb+d_skeletons/{file.name}")
    for path in (folder, tmp_path, tmp_path / "nturgbd_skeletons_s001_to_s017.zip"):
        names = [clip.name for clip in read_ntu(path, Notes())]
        assert names == ["S001C001P001R001A002", "S001C001P002R001A001"]
    assert [c.label for c in read_ntu(folder, Notes(), labels=("A001",))] == ["A001"]
    assert [c.subject for c in read_ntu(folder, Notes(), subjects=("ntu_p001",))] == ["ntu_p001"]
    assert len(list(read_ntu(folder / "S001C001P002R001A001.skeleton", Notes()))) == 1
    (tmp_path / "mine.skeleton").write_text(text)
    notes = Notes()
    assert list(read_ntu(tmp_path / "mine.skeleton", notes)) == []
    assert "has a name that is not NTU's" in notes.left_out[0][1]
    with pytest.raises(DataError, match="NTU RGB"):
        list(read_ntu(tmp_path / "nowhere", Notes()))
