import json
from pathlib import Path

import numpy as np
import pytest

from wigwag.datasets.folder import load_clip, save_clip
from wigwag.datasets.migrate import migrate_folder
from wigwag.datasets.versions import MIGRATIONS, VERSION, upgraded
from wigwag.errors import DataError, InputError
from wigwag.skeleton import Clip


def saved(root: Path, name: str = "take") -> Path:
    return save_clip(
        Clip.at_rate(np.random.default_rng(0).normal(size=(4, 13, 3)), 30, "land", "ann", name), root
    )


def edited(path: Path, **changes: object) -> Path:
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    return path


def test_there_is_a_way_from_every_version_to_the_current_one() -> None:
    assert sorted(MIGRATIONS) == list(range(1, VERSION))


def test_a_current_folder_is_checked_and_left_alone(tmp_path: Path) -> None:
    before = saved(tmp_path).read_bytes()
    done = migrate_folder(tmp_path)
    assert (done.current, done.migrated, done.refused) == ([str(Path("land", "take.json"))], [], [])
    assert (tmp_path / "land" / "take.json").read_bytes() == before


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            '{"format": "wigwag-clip", "version": 99}',
            "version is 99, but this wigwag reads versions up to 1. Update",
        ),
        ('{"format": "wigwag-clip", "version": 0}', "version is 0, which no wigwag wrote"),
        ('{"format": "wigwag-clip", "version": true}', "version must be a whole number, but got True"),
        ('{"format": "wigwag-clip"}', "version must be a whole number, but got None"),
        ('{"format": "wigwag-clip", "version": 1}', "units must be 'metre'"),
        ('{"version": 1}', "is no clip file"),
        ("{", "is no JSON"),
    ],
)
def test_newer_and_damaged_files_are_named_and_untouched(tmp_path: Path, text: str, reason: str) -> None:
    saved(tmp_path)
    bad = tmp_path / "land" / "bad.json"
    bad.write_text(text)
    done = migrate_folder(tmp_path)
    assert len(done.current) == 1
    [(name, said)] = done.refused
    assert name == str(Path("land", "bad.json")) and said.startswith(reason)
    assert bad.read_text() == text


def step(old: dict) -> dict:
    """No version before 1 exists; this only moves the machinery, as the first real change will."""
    return {("label" if key == "gesture" else key): value for key, value in old.items()}


def test_the_machinery_moves_a_file_in_one_step_and_keeps_what_it_does_not_know(tmp_path: Path) -> None:
    path = saved(tmp_path)
    reference = load_clip(path)
    content = json.loads(path.read_text())
    content["gesture"] = content.pop("label")
    path.write_text(json.dumps(content | {"version": 0, "remark": "windy"}))
    done = migrate_folder(tmp_path, {0: step})
    assert done.migrated == [str(Path("land", "take.json"))] and not done.refused
    back = load_clip(path)
    assert back.label == "land"
    np.testing.assert_array_equal(back.joints, reference.joints)
    assert json.loads(path.read_text())["remark"] == "windy"
    assert [p.name for p in tmp_path.rglob("*") if p.is_file()] == ["take.json"]
    assert migrate_folder(tmp_path, {0: step}).migrated == []


def test_what_does_not_read_back_is_not_written(tmp_path: Path) -> None:
    path = edited(saved(tmp_path), version=0, joints=[[1]])
    before = path.read_text()
    [(_, reason)] = migrate_folder(tmp_path, {0: step}).refused
    assert "joints must have shape" in reason
    assert path.read_text() == before
    with pytest.raises(InputError, match="is no whole file of version 0"):
        upgraded({"version": 0}, {0: lambda old: {"label": old["gesture"]}})


def test_nothing_to_migrate(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="no such folder"):
        migrate_folder(tmp_path / "nowhere")
    with pytest.raises(DataError, match=r"holds no \*\.json"):
        migrate_folder(tmp_path)
