import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import wigwag
from wigwag.errors import InputError
from wigwag.evaluate.records import Records, command_line


def test_every_record_is_written_as_it_comes(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "x.json"
    records = Records(path, "wigwag benchmark x", seed=7)
    records.add(name="a", value=np.float64(0.5), ci=(0.1, np.float32(0.5)), n=np.int64(3))
    assert json.loads(path.read_text()) == [
        {"name": "a", "value": 0.5, "ci": [0.1, 0.5], "n": 3, "command": "wigwag benchmark x", "seed": 7,
         "version": wigwag.__version__}
    ]  # fmt: skip
    records.add(name="b", value=float("nan"))
    assert [row["name"] for row in json.loads(path.read_text())] == ["a", "b"]
    assert json.loads(path.read_text())[1]["value"] is None, "JSON knows no NaN"
    assert [p.name for p in path.parent.iterdir()] == ["x.json"]


def test_an_old_file_stays_until_the_first_record(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_text("old")
    records = Records(path, "c", 0)
    assert path.read_text() == "old"
    records.add(a=1)
    assert len(json.loads(path.read_text())) == 1


def test_without_a_file_rows_are_kept() -> None:
    records = Records(None, "c", 0)
    records.add(a=1)
    assert records.rows[0]["a"] == 1


def test_records_are_flat() -> None:
    with pytest.raises(TypeError, match="record field 'nested' holds a dict"):
        Records(None, "c", 0).add(nested={})


def test_an_unwritable_place_is_found_out_at_once(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot be written"):
        Records(tmp_path / "file" / "x.json", "c", 0)
    with pytest.raises(InputError, match=r"cannot be written"):
        Records(tmp_path, "c", 0)


def test_command_line_names_what_differs_from_the_defaults() -> None:
    @dataclass
    class Options:
        data: Path
        seeds: int = 10
        draw: bool = True
        only: tuple[str, ...] = ()

    assert command_line("wigwag x", Options(Path("d"))) == "wigwag x --data d"
    assert (
        command_line("wigwag x", Options(Path("a b"), 2, False, ("p", "q")))
        == "wigwag x --data 'a b' --seeds 2 --no-draw --only p q"
    )
