import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.datasets import parquet
from wigwag.datasets.notes import Notes
from wigwag.datasets.parquet import COLUMNS, read_parquet, write_parquet
from wigwag.errors import DataError, InputError, MissingExtraError
from wigwag.skeleton import Clip

arrow = pytest.importorskip("pyarrow", reason="needs the extra parquet")
pq = pytest.importorskip("pyarrow.parquet", reason="needs the extra parquet")


def clip(seed: int, **fields: object) -> Clip:
    rng = np.random.default_rng(seed)
    frames = int(rng.integers(2, 9))
    stamps = np.cumsum(rng.integers(1, 10**9, frames)) + 2**62
    known = {"label": "land", "subject": "ann", "name": f"take{seed}"} | fields
    return Clip(rng.normal(0, 2, (frames, 13, 3)), stamps, **known)


def written(path: Path, clips: list[Clip]) -> Path:
    with write_parquet(path) as add:
        for one in clips:
            add(one)
    return path


def same(a: Clip, b: Clip) -> None:
    assert (a.name, a.label, a.subject) == (b.name, b.label, b.subject)
    assert a.joints.dtype == np.float64 and a.joints.tobytes() == np.ascontiguousarray(b.joints).tobytes()
    assert a.stamps_ns.dtype == np.int64
    np.testing.assert_array_equal(a.stamps_ns, b.stamps_ns)


@given(seeds=st.lists(st.integers(0, 99), min_size=1, max_size=6), label=st.none() | st.text(max_size=5))
def test_every_bit_comes_back(
    tmp_path_factory: pytest.TempPathFactory, seeds: list[int], label: str | None
) -> None:
    clips = [clip(seed, label=label, subject=None if seed % 2 else "ö") for seed in seeds]
    back = list(read_parquet(written(tmp_path_factory.mktemp("p") / "c.parquet", clips)))
    assert len(back) == len(clips)
    for one, other in zip(back, clips, strict=True):
        same(one, other)


def test_row_groups_are_seamless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parquet, "_ROWS_A_GROUP", 10)
    path = written(tmp_path / "c.parquet", [clip(seed) for seed in range(9)])
    assert pq.ParquetFile(path).num_row_groups > 2
    for one, other in zip(read_parquet(path), map(clip, range(9)), strict=True):
        same(one, other)


def test_the_table_is_what_a_data_frame_wants(tmp_path: Path) -> None:
    table = pq.read_table(written(tmp_path / "c.parquet", [clip(0), clip(1)]))
    assert table.column_names == ["clip", "name", "label", "subject", "frame", "stamp_ns", *COLUMNS]
    assert len(COLUMNS) == 39 and COLUMNS[:4] == ("nose_x", "nose_y", "nose_z", "left_shoulder_x")
    assert table.num_rows == len(clip(0)) + len(clip(1))
    assert table.column("right_heel_z")[0].as_py() == clip(0).joints[0, 12, 2]
    header = json.loads(table.schema.metadata[b"wigwag"])
    assert (header["format"], header["version"], header["units"]) == ("wigwag-clips", 1, "metre")


def test_a_table_that_was_shuffled_joined_and_lost_its_header(tmp_path: Path) -> None:
    tables = [pq.read_table(written(tmp_path / f"{i}.parquet", [clip(i)])) for i in range(2)]
    joined = arrow.concat_tables(tables)  # both clips have the number 0
    order = np.random.default_rng(0).permutation(joined.num_rows)
    pq.write_table(joined.take(order).replace_schema_metadata(None), tmp_path / "j.parquet")
    notes = Notes()
    back = sorted(read_parquet(tmp_path / "j.parquet", notes), key=lambda c: c.name)
    for i in range(2):
        same(back[i], clip(i))
    assert notes.repaired == [("j.parquet", "has no header of wigwag's; read as version 1")]


def test_one_bad_clip_does_not_hide_the_others(tmp_path: Path) -> None:
    table = pq.read_table(written(tmp_path / "c.parquet", [clip(0), clip(1)]))
    values = table.column("nose_x").to_numpy().copy()
    values[1] = np.nan
    at = table.column_names.index("nose_x")
    pq.write_table(table.set_column(at, "nose_x", arrow.array(values)), tmp_path / "bad.parquet")
    notes = Notes()
    assert [c.name for c in read_parquet(tmp_path / "bad.parquet", notes)] == ["take1"]
    [(file, reason)] = notes.left_out
    assert file == "bad.parquet: clip take0" and "NaN or infinity, first in frame 1" in reason
    with pytest.raises(DataError, match=r"bad\.parquet: clip take0: joints hold NaN"):
        list(read_parquet(tmp_path / "bad.parquet"))


def test_damage_is_named(tmp_path: Path) -> None:
    good = written(tmp_path / "c.parquet", [clip(0)])
    table = pq.read_table(good)
    header = json.loads(table.schema.metadata[b"wigwag"])
    cut = tmp_path / "cut.parquet"
    cut.write_bytes(good.read_bytes()[:-40])
    cases = {"cut.parquet": "is no readable Parquet file"}
    for name, changed, said in (
        ("col", table.drop_columns(["left_hip_y", "frame"]), "lacks the column 'frame' and 1 more"),
        (
            "new",
            table.replace_schema_metadata({"wigwag": json.dumps(header | {"version": 2})}),
            "version is 2",
        ),
        (
            "unit",
            table.replace_schema_metadata({"wigwag": json.dumps(header | {"units": "mm"})}),
            "units must be",
        ),
        ("head", table.replace_schema_metadata({"wigwag": "{"}), "metadata 'wigwag' is no header"),
        (
            "other",
            table.replace_schema_metadata({"wigwag": json.dumps(header | {"format": "x"})}),
            "format must be",
        ),
        (
            "time",
            table.set_column(5, "stamp_ns", arrow.array(np.linspace(0, 1, table.num_rows))),
            "column stamp_ns must hold whole numbers",
        ),
        (
            "text",
            table.set_column(6, "nose_x", arrow.array(["x"] * table.num_rows)),
            "column nose_x must hold numbers",
        ),
    ):
        pq.write_table(changed, tmp_path / f"{name}.parquet")
        cases[f"{name}.parquet"] = said
    cases["nowhere.parquet"] = "no such file"
    for file, said in cases.items():
        with pytest.raises(DataError, match=said) as caught:
            list(read_parquet(tmp_path / file))
        assert str(caught.value).startswith(str(tmp_path / file))


def test_a_failure_leaves_the_old_file(tmp_path: Path) -> None:
    path = written(tmp_path / "c.parquet", [clip(0)])
    with pytest.raises(InputError, match="is there already"), write_parquet(path):
        pass
    with pytest.raises(RuntimeError), write_parquet(path, overwrite=True) as add:
        add(clip(1))
        raise RuntimeError
    same(next(read_parquet(path)), clip(0))
    assert [p.name for p in tmp_path.iterdir()] == ["c.parquet"]


def test_without_pyarrow_it_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with (
        pytest.raises(MissingExtraError, match=r"pip install 'wigwag\[parquet\]'"),
        write_parquet(tmp_path / "c"),
    ):
        pass
    assert list(tmp_path.iterdir()) == []
