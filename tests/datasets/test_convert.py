from pathlib import Path

import numpy as np
import pytest

from tests.datasets.test_bvh import clip
from tests.datasets.test_ntu import NAME, content, moving, ok
from tests.datasets.trees import tree, zipped
from wigwag.datasets.convert import convert
from wigwag.datasets.folder import load_folder, save_clip
from wigwag.datasets.formats import READERS, WRITERS, Options, reader_for, writer_for
from wigwag.datasets.notes import Notes
from wigwag.errors import DataError, InputError
from wigwag.skeleton import Clip


@pytest.fixture(autouse=True)
def _arrow() -> None:
    pytest.importorskip("pyarrow", reason="needs the extra parquet")


def folder(root: Path, count: int = 3) -> Path:
    for seed in range(count):
        save_clip(clip(seed), root)
    return root


def everything(root: Path) -> dict[str, bytes]:
    return {str(p.relative_to(root)): p.read_bytes() for p in sorted(root.rglob("*")) if p.is_file()}


def test_round_all_forms_and_back_byte_for_byte(tmp_path: Path) -> None:
    a = folder(tmp_path / "a")
    convert(a, tmp_path / "b.parquet")
    convert(tmp_path / "b.parquet", tmp_path / "c", target_format="bvh")
    convert(tmp_path / "c", tmp_path / "d.parquet")
    done = convert(tmp_path / "d.parquet", tmp_path / "e")
    assert (done.source_format, done.target_format, done.clips, done.frames) == ("parquet", "folder", 3, 18)
    assert done.notes == Notes()
    assert everything(tmp_path / "e") == everything(a)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b.parquet", "c", "d.parquet", "e"]


def test_each_set_is_known_by_its_files(tmp_path: Path) -> None:
    utd = tree(tmp_path / "utd")
    ntu = tmp_path / "ntu"
    ntu.mkdir()
    (ntu / f"{NAME}.skeleton").write_text(content([[(1, moving(f), ok())] for f in range(20)]))
    a = folder(tmp_path / "a")
    convert(a, tmp_path / "t.parquet")
    convert(a, tmp_path / "bvh", target_format="bvh")
    paths = {
        utd: "utd-mhad",
        utd / "Skeleton": "utd-mhad",
        zipped(utd, tmp_path / "Skeleton.zip"): "utd-mhad",
        ntu: "ntu",
        ntu / f"{NAME}.skeleton": "ntu",
        a: "folder",
        tmp_path / "t.parquet": "parquet",
        tmp_path / "bvh": "bvh",
        next((tmp_path / "bvh").rglob("*.bvh")): "bvh",
    }
    for path, name in paths.items():
        assert reader_for(path) == name, path
        notes = Notes()
        clips = list(READERS[name].read(path, notes, Options()))
        assert clips and all(isinstance(c, Clip) for c in clips)
    assert set(paths.values()) == set(READERS)


def test_left_and_right_are_the_same_in_every_form(tmp_path: Path) -> None:
    """A Kinect's, BVH's and wigwag's axes: the left of who faces the camera is at +x, the head at -y."""
    ntu = tmp_path / f"{NAME}.skeleton"
    ntu.write_text(content([[(1, moving(f), ok())] for f in range(20)]))
    utd = tree(tmp_path / "utd")
    convert(folder(tmp_path / "a"), tmp_path / "bvh", target_format="bvh")
    for path in (ntu, utd, tmp_path / "bvh"):
        for one in READERS[reader_for(path)].read(path, Notes(), Options()):
            assert (one.joints[:, 1, 0] > one.joints[:, 2, 0]).all(), "left shoulder right in the picture"
            assert (one.joints[:, 0, 1] < one.joints[:, 7, 1]).all(), "head above hips"


def test_what_is_damaged_is_named_and_the_rest_converted(tmp_path: Path) -> None:
    a = folder(tmp_path / "a")
    (a / "land" / "bad.json").write_text('{"format": "wigwag-clip", "version": 1}')
    done = convert(a, tmp_path / "b.parquet")
    assert done.clips == 3
    [(name, reason)] = done.notes.left_out
    assert name == str(Path("land", "bad.json")) and "units must be" in reason


def test_clips_of_one_name_do_not_replace_each_other(tmp_path: Path) -> None:
    twins = [clip(0), Clip(clip(1).joints, clip(1).stamps_ns, "LAND", "bo", "TAKE0"), clip(2)]
    twins[2] = Clip(twins[2].joints, twins[2].stamps_ns, "land", "cy", "take0")
    for i, one in enumerate(twins):
        save_clip(one, tmp_path / "in" / str(i))
    done = convert(tmp_path / "in", tmp_path / "out")
    assert [c.subject for c in load_folder(tmp_path / "out").clips] == ["bo", "ann", "cy"]
    assert sorted(said for _, said in done.notes.repaired) == [
        "written as TAKE0_2: the name was taken",
        "written as take0_3: the name was taken",
    ]


def test_a_folder_is_added_to_and_nothing_is_replaced_unasked(tmp_path: Path) -> None:
    a, b = folder(tmp_path / "a", 1), folder(tmp_path / "b", 2)
    (b / "land" / "take0.json").unlink()
    convert(b, a)
    before = everything(a)
    assert len(before) == 2
    save_clip(clip(5), b)
    with pytest.raises(InputError, match="already"):
        convert(b, a)
    assert everything(a) == before, "not even the new one: a folder is written whole or not at all"
    convert(b, a, overwrite=True)
    assert len(everything(a)) == 3


def test_one_clip_a_bvh_file(tmp_path: Path) -> None:
    convert(folder(tmp_path / "a", 1), tmp_path / "one.bvh")
    [back] = READERS["bvh"].read(tmp_path / "one.bvh", Notes(), Options(unit_m=0.01))
    np.testing.assert_allclose(back.joints, np.round(clip(0).joints, 4), atol=1e-9)
    with pytest.raises(InputError, match="a BVH file holds one clip, but there are more"):
        convert(folder(tmp_path / "b", 2), tmp_path / "two.bvh")
    assert not (tmp_path / "two.bvh").exists()


def test_wrong_use_says_what_to_do(tmp_path: Path) -> None:
    a = folder(tmp_path / "a", 1)
    empty = tmp_path / "empty"
    empty.mkdir()
    (a / "x.bvh").write_text("")
    for call, said in (
        (lambda: reader_for(tmp_path / "nowhere"), "no such file or folder"),
        (lambda: reader_for(empty), "is of no known form. Say which with --source-format. Known: folder"),
        (lambda: reader_for(a), "could be folder or bvh. Say which with --source-format"),
        (lambda: reader_for(a, "msr"), "source format must be one of folder, parquet, bvh, ntu, utd-mhad"),
        (lambda: writer_for(Path("x.csv")), "no form is known by the ending .csv"),
        (lambda: writer_for(Path("x"), "ntu"), "target format must be one of folder, parquet, bvh"),
        (lambda: convert(a, a, source_format="folder"), "is the source as well"),
        (lambda: convert(empty, tmp_path / "o", source_format="bvh"), "holds no usable clip"),
        (lambda: convert(a, tmp_path / "o", source_format="bvh"), "first of 1 left out: x.bvh: is no BVH"),
    ):
        with pytest.raises((InputError, DataError)) as caught:
            call()
        assert said in str(caught.value)
    assert not (tmp_path / "o").exists()


def test_targets_by_ending(tmp_path: Path) -> None:
    names = {"clips": "folder", "a.parquet": "parquet", "a.BVH": "bvh"}
    assert {name: writer_for(tmp_path / name) for name in names} == names
    (tmp_path / "v1.0").mkdir()
    assert writer_for(tmp_path / "v1.0") == "folder"
    assert set(names.values()) == set(WRITERS)
