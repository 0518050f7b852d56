import zipfile

import numpy as np
import pytest

from tests.datasets.skeletons import SHARED, msr_arrays, needs, saved, takes
from wigwag.datasets.msr_action3d import ACTIONS, JOINTS, RATE_HZ, knees_in_place, load_skeletons
from wigwag.errors import DataError
from wigwag.skeleton import KINECT20, Landmark, from_kinect20

KNEES = (JOINTS.index("left_knee"), JOINTS.index("right_knee"))


def exchanged(joints: np.ndarray, frames: np.ndarray) -> np.ndarray:
    result = joints.copy()
    for a, b in (KNEES, KNEES[::-1]):
        result[frames, a] = joints[frames, b]
    return result


def walking(frames: int = 40) -> np.ndarray:
    """A person in the set's joint order whose thighs and rigid shanks swing, and cross now and then."""
    joints = np.repeat(next(iter(takes().values()))[:1], frames, axis=0)[
        :, [KINECT20.index(n) for n in JOINTS]
    ]
    names = JOINTS
    swing = 0.5 * np.sin(np.linspace(0, 6, frames))
    for side, sign in (("left", 1), ("right", -1)):
        hip, knee, ankle = (names.index(f"{side}_{part}") for part in ("hip", "knee", "ankle"))
        angle = sign * swing
        inwards = 0.12 * sign * np.clip(np.sin(np.linspace(0, 9, frames)), 0, 1)
        joints[:, knee] = joints[:, hip] + np.stack([inwards, -0.45 * np.cos(angle), 0.45 * np.sin(angle)], 1)
        shank = np.stack([inwards, -np.cos(2 * angle), np.sin(2 * angle)], 1)
        joints[:, ankle] = joints[:, knee] + 0.41 * shank / np.linalg.norm(shank, axis=1, keepdims=True)
    return joints


def test_clips_carry_names_rate_and_landmarks(tmp_path) -> None:
    recorded = takes()
    loaded = load_skeletons(saved(tmp_path / "msr_action3d_x.npz", msr_arrays(recorded)))
    assert [c.name for c in loaded.clips] == [f"a{a:02d}_s{s:02d}_e{t:02d}" for a, s, t in recorded]
    assert loaded.left_out == loaded.repaired == []
    for clip, joints in zip(loaded.clips, recorded.values(), strict=True):
        np.testing.assert_allclose(clip.joints, from_kinect20(joints), atol=1e-6)
        assert (clip.label, clip.subject) == tuple(clip.name.split("_")[:2])
        assert clip.duration_s == pytest.approx((len(joints) - 1) / RATE_HZ)
    upright = loaded.clips[0].joints
    assert (upright[:, Landmark.NOSE, 1] < upright[:, Landmark.LEFT_HEEL, 1]).all(), "y points down"
    assert {c.label for c in load_skeletons(tmp_path, labels=("a02",)).clips} == {"a02"}
    assert {c.subject for c in load_skeletons(tmp_path, subjects=("s03",)).clips} == {"s03"}


def test_official_text_files_give_the_same_clips(tmp_path) -> None:
    recorded = takes(frames=12)
    arrays = msr_arrays(recorded)
    folder = tmp_path / "text" / "MSRAction3DSkeletonReal3D"
    folder.mkdir(parents=True)
    for i, (a, s, t) in enumerate(recorded):
        rows = arrays["frames"][arrays["offset"][i] : arrays["offset"][i + 1]].reshape(-1, 3)
        text = "\n".join(f"{x:.6f} {y:.6f} {z:.6f} 1.0" for x, y, z in rows)
        (folder / f"a{a:02d}_s{s:02d}_e{t:02d}_skeleton3D.txt").write_text(text + "\n")
    with zipfile.ZipFile(tmp_path / "text.zip", "w") as archive:
        for file in folder.iterdir():
            archive.write(file, f"{folder.name}/{file.name}")
    expected = load_skeletons(saved(tmp_path / "m.npz", arrays))
    for path in (tmp_path / "text", folder, tmp_path / "text.zip"):
        loaded = load_skeletons(path)
        assert [c.name for c in loaded.clips] == [c.name for c in expected.clips]
        for one, other in zip(loaded.clips, expected.clips, strict=True):
            np.testing.assert_allclose(one.joints, other.joints, atol=2e-6)
    (folder / "a01_s01_e01_skeleton3D.txt").write_text("1 2 3 4\n" * 41)
    (folder / "a01_s01_e02_skeleton3D.txt").write_text("one two three\n")
    loaded = load_skeletons(tmp_path / "text")
    assert [name for name, _ in loaded.left_out] == ["a01_s01_e01", "a01_s01_e02"]
    assert "20 lines a frame" in loaded.left_out[0][1]
    assert "no table of numbers" in loaded.left_out[1][1]


def test_lost_frames_are_repaired_or_the_reason_is_given(tmp_path) -> None:
    recorded = takes()
    recorded[1, 1, 1][5:8] = 0
    recorded[1, 1, 2][:] = 0
    loaded = load_skeletons(saved(tmp_path / "m.npz", msr_arrays(recorded)))
    assert loaded.left_out == [("a01_s01_e02", "nobody is seen: every frame is zero")]
    assert loaded.repaired == [("a01_s01_e01", "3 frames without a person filled in")]
    assert np.abs(loaded.clips[0].joints).max(axis=(1, 2)).min() > 0.1
    nobody = {key: np.zeros_like(joints) for key, joints in recorded.items()}
    with pytest.raises(DataError, match=r"no usable recording .* 8 left out, first: .*nobody is seen"):
        load_skeletons(saved(tmp_path / "n.npz", msr_arrays(nobody)))


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8, 1.0])
def test_knees_are_put_back(share: float) -> None:
    joints = walking()
    wrong = np.random.default_rng(1).random(len(joints)) < share
    repaired, count = knees_in_place(exchanged(joints, wrong))
    np.testing.assert_array_equal(repaired, joints)
    assert count == wrong.sum()


def test_knees_without_a_constant_shank_go_by_their_distances() -> None:
    joints = walking() * (1 + 0.1 * np.random.default_rng(0).random((40, 1, 1)))
    wrong = np.arange(40) % 3 == 0
    repaired, _ = knees_in_place(exchanged(joints, wrong))
    assert (repaired == joints).all(axis=(1, 2)).mean() > 0.8
    assert knees_in_place(joints)[1] == 0, "nothing is exchanged that stands right"


def test_repaired_knees_are_said(tmp_path) -> None:
    recorded = {(1, 2, 1): walking()[:, [JOINTS.index(n) for n in KINECT20]]}
    arrays = msr_arrays(recorded)
    arrays["frames"] = exchanged(arrays["frames"], np.arange(40) < 30)
    loaded = load_skeletons(saved(tmp_path / "m.npz", arrays))
    assert loaded.repaired == [("a01_s02_e01", "knees exchanged in 30 of 40 frames")]


@needs("msr_action3d")
def test_the_recorded_set() -> None:
    loaded = load_skeletons(SHARED / "msr_action3d")
    assert len(loaded) + len(loaded.left_out) == 292
    assert ("a13_s09_e02", "nobody is seen: every frame is zero") in loaded.left_out
    assert {c.label for c in loaded.clips} == set(ACTIONS)
    assert not [said for _, said in loaded.repaired if "knees" in said], "of these people none is exchanged"
    heights = [float(np.ptp(c.joints[0, :, 1])) for c in loaded.clips]
    assert 1.2 < np.median(heights) < 2.0, "metres, upright"


@needs("msr_action3d")
def test_knees_of_recorded_people_are_put_back() -> None:
    """The people here stand right; exchange theirs and see."""
    from wigwag.datasets.streams import load_streams

    streams = load_streams(SHARED / "msr_action3d", "*.npz", "")
    rng = np.random.default_rng(0)
    right = []
    for i in range(0, len(streams), 9):
        joints = streams.raw(i)
        repaired, _ = knees_in_place(exchanged(joints, rng.random(len(joints)) < 0.7))
        right.append((repaired == joints).all(axis=(1, 2)))
    assert np.concatenate(right).mean() > 0.99
