from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from tests.datasets.trees import UTD, mat, movement, needs_depth, needs_utd, tree, zipped
from wigwag.datasets import utd_mhad
from wigwag.datasets.utd_mhad import (
    ACTIONS,
    DEPTH_DELAY_FRAMES,
    DEPTH_INTRINSICS,
    KNOWN_MISSING,
    load_depth,
    load_raw20,
    load_skeleton,
    load_skeletons,
)
from wigwag.errors import DataError
from wigwag.skeleton import from_kinect20

ONLY = {"labels": ("a1", "a6"), "subjects": ("s1", "s2")}


def broken(root: Path, content: bytes, name: str = "a6_s1_t1") -> tuple[str, str]:
    """Put ``content`` in place of one recording; return what the loader says of it."""
    (root / "Skeleton" / f"{name}_skeleton.mat").write_bytes(content)
    loaded = load_skeletons(root, **ONLY)
    found = [entry for entry in loaded.left_out if entry[0] == f"{name}_skeleton.mat"]
    assert len(found) == 1
    assert name not in {clip.name for clip in loaded.clips}
    assert len(loaded.clips) == 7, "the other recordings are loaded all the same"
    with pytest.raises(DataError, match=rf"^{name}_skeleton\.mat: "):
        load_skeleton(root, name)
    return found[0]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return tree(tmp_path / "utd")


def test_reads_folder_zip_and_bare_folder_alike(root: Path, tmp_path: Path) -> None:
    packed = tmp_path / "packed"
    packed.mkdir()
    archive = zipped(root, packed / "Skeleton.zip")
    loaded = [load_skeletons(p, **ONLY) for p in (root, root / "Skeleton", archive, packed)]
    for other in loaded[1:]:
        assert [c.name for c in other.clips] == [c.name for c in loaded[0].clips]
        for a, b in zip(other.clips, loaded[0].clips, strict=True):
            np.testing.assert_array_equal(a.joints, b.joints)


def test_labels_people_axes_and_time(root: Path) -> None:
    clip = load_skeletons(root, labels=("a6",), subjects=("s2",)).clips[0]
    assert (clip.name, clip.label, clip.subject) == ("a6_s2_t1", "a6", "s2")
    raw = movement(6, 2, 1)
    np.testing.assert_allclose(clip.joints, from_kinect20(raw.transpose(2, 0, 1)))
    assert clip.duration_s == pytest.approx((raw.shape[2] - 1) / 18.75)
    assert clip.joints[0, 0, 1] < clip.joints[0, 11, 1], "y points down: the head is above the heels"
    assert clip.joints[0, 2, 0] < clip.joints[0, 1, 0], "the right shoulder is on the picture's left"


def test_names_what_is_missing_but_not_what_was_never_published(root: Path) -> None:
    loaded = load_skeletons(root, labels=("a1", "a8"), subjects=("s1",))
    missing = {name for name, reason in loaded.left_out if reason == "missing"}
    expected = {"a1_s1_t3", "a1_s1_t4", "a8_s1_t1", "a8_s1_t2", "a8_s1_t3"}
    assert missing == {f"{name}_skeleton.mat" for name in expected}


def test_raw20_is_the_file_as_it_is(root: Path) -> None:
    np.testing.assert_allclose(load_raw20(root, "a1_s1_t2"), movement(1, 1, 2).transpose(2, 0, 1))


def test_progress_reaches_the_total(root: Path) -> None:
    seen: list[tuple[int, int]] = []
    load_skeletons(root, **ONLY, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (16, 16)
    assert [done for done, _ in seen] == list(range(1, 17))


def test_corrupt_file_is_left_out(root: Path) -> None:
    assert "no readable MATLAB file" in broken(root, b"MATLAB 5.0 MAT-file" + bytes(200))[1]


@pytest.mark.parametrize("content", [b"", b"not a mat", bytes(128)])
def test_file_that_is_none_is_left_out(root: Path, content: bytes) -> None:
    assert broken(root, content)[1]


def test_truncated_file_is_left_out(root: Path) -> None:
    whole = mat("d_skel", movement(6, 1, 1))
    assert broken(root, whole[: len(whole) // 2])[1]


def test_wrong_variable_is_named(root: Path) -> None:
    reason = broken(root, mat("skel", movement(6, 1, 1)))[1]
    assert "'d_skel'" in reason
    assert "it holds skel" in reason


def test_nan_is_named_with_its_frame(root: Path) -> None:
    joints = movement(6, 1, 1)
    joints[3, 1, 7] = np.nan
    assert "first in frame 7" in broken(root, mat("d_skel", joints))[1]


def test_nineteen_joints_are_refused(root: Path) -> None:
    assert "(19, 3, 24)" in broken(root, mat("d_skel", movement(6, 1, 1)[:19]))[1]


@pytest.mark.parametrize("frames", [0, 1])
def test_too_few_frames_are_refused(root: Path, frames: int) -> None:
    reason = broken(root, mat("d_skel", movement(6, 1, 1)[:, :, :frames]))[1]
    assert f"at least 2 frames, but got {frames}" in reason


def test_text_instead_of_numbers_is_refused(root: Path) -> None:
    assert "real numbers" in broken(root, mat("d_skel", np.array(["a", "b"])))[1]


def test_strange_name_is_left_out(root: Path) -> None:
    (root / "Skeleton" / "a28_s1_t1_skeleton.mat").write_bytes(mat("d_skel", movement(28, 1, 1)))
    loaded = load_skeletons(root, **ONLY)
    assert ("a28_s1_t1_skeleton.mat", "has a name that is not UTD-MHAD's (a1-a27, s1-s8, t1-t4)") in (
        loaded.left_out
    )


def test_damaged_zip_member_is_left_out(root: Path, tmp_path: Path) -> None:
    archive = zipped(root, tmp_path / "Skeleton.zip")
    content = bytearray(archive.read_bytes())
    start = content.index(b"a6_s1_t1_skeleton.mat") + 200
    content[start : start + 50] = bytes(50)
    archive.write_bytes(content)
    loaded = load_skeletons(archive, **ONLY)
    assert "a6_s1_t1_skeleton.mat" in {name for name, reason in loaded.left_out if reason != "missing"}
    assert len(loaded.clips) == 7


def test_says_what_is_expected_where_there_is_nothing(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"nowhere: no such file or folder.*Skeleton\.zip"):
        load_skeletons(tmp_path / "nowhere")
    with pytest.raises(DataError, match=r"holds none of Skeleton/, Skeleton\.zip.*UTD-MHAD"):
        load_skeletons(tmp_path)
    (tmp_path / "Skeleton.zip").write_bytes(b"no zip")
    with pytest.raises(DataError, match=r"Skeleton\.zip: is not a readable zip file"):
        load_skeletons(tmp_path)
    with pytest.raises(DataError, match="depth part"):
        next(load_depth(tmp_path))


def test_no_recording_of_what_was_asked_for(root: Path) -> None:
    with pytest.raises(DataError, match="no usable recording"):
        load_skeletons(root, labels=("a27",))


def test_single_load_of_a_missing_recording(root: Path) -> None:
    with pytest.raises(DataError, match=r"a9_s1_t1_skeleton\.mat: not found"):
        load_raw20(root, "a9_s1_t1")


def test_depth_is_turned_the_right_way_round(tmp_path: Path) -> None:
    folder = tmp_path / "Depth"
    folder.mkdir()
    depth = np.zeros((240, 320, 3), dtype=np.uint16)
    depth[10, 0] = [1000, 2000, 3000]  # column 0 of the mirrored picture is the right edge
    savemat(folder / "a1_s1_t1_depth.mat", {"d_depth": depth})
    savemat(folder / "a1_s2_t1_depth.mat", {"d_depth": depth.astype(np.float64)})
    left_out: list[tuple[str, str]] = []
    clips = list(load_depth(tmp_path, left_out=left_out))
    assert [c.name for c in clips] == ["a1_s1_t1"]
    assert clips[0].depth_mm.shape == (3, 240, 320)
    assert clips[0].depth_mm[:, 10, 319].tolist() == [1000, 2000, 3000]
    assert left_out[0][0] == "a1_s2_t1_depth.mat"
    assert "uint16" in left_out[0][1]
    with pytest.raises(DataError, match=r"a1_s2_t1_depth\.mat"):
        list(load_depth(tmp_path))


@needs_utd
def test_the_published_set() -> None:
    loaded = load_skeletons(UTD)
    assert loaded.left_out == []
    names = {clip.name for clip in loaded.clips}
    assert len(names) == len(loaded.clips) == 861
    whole = {f"{a}_s{s}_t{t}" for a in ACTIONS for s in range(1, 9) for t in range(1, 5)}
    assert whole - names == KNOWN_MISSING == {"a8_s1_t4", "a23_s6_t4", "a27_s8_t4"}
    assert Counter(c.subject for c in loaded.clips) == {
        f"s{i}": 107 if i in (1, 6, 8) else 108 for i in range(1, 9)
    }
    assert sorted(len(c) for c in loaded.clips)[430] == 67
    assert min(map(len, loaded.clips)) == 41
    assert max(map(len, loaded.clips)) == 125


@needs_depth
def test_projected_skeletons_land_on_the_person() -> None:
    inside = []
    for depth in load_depth(UTD, labels=("a6",), subjects=("s1", "s2")):
        joints = load_skeleton(UTD, depth.name).joints
        for t in range(DEPTH_DELAY_FRAMES, len(depth), 10):
            u, v = np.rint(DEPTH_INTRINSICS.project(joints[t - DEPTH_DELAY_FRAMES])).astype(int).T
            inside.append(depth.depth_mm[t][v, u] > 0)
    assert np.mean(inside) > 0.98


def test_every_action_has_a_name_of_its_own() -> None:
    assert list(ACTIONS) == [f"a{i}" for i in range(1, 28)]
    assert len(set(ACTIONS.values())) == 27
    assert utd_mhad.RATE_HZ == 18.75
