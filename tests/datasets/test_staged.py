from pathlib import Path

import pytest

from wigwag.datasets.staged import staged_file, staged_folder
from wigwag.errors import InputError


def files(root: Path) -> dict[str, str]:
    return {str(p.relative_to(root)): p.read_text() for p in sorted(root.rglob("*")) if p.is_file()}


def test_a_file_appears_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.txt"
    with staged_file(path) as beside:
        beside.write_text("all of it")
        assert not path.exists()
    assert files(tmp_path) == {str(Path("new", "a.txt")): "all of it"}


@pytest.mark.parametrize("error", [RuntimeError("broke"), KeyboardInterrupt()])
def test_after_a_failure_the_old_file_is_there_and_nothing_else(tmp_path: Path, error: BaseException) -> None:
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(type(error)), staged_file(tmp_path / "a.txt", overwrite=True) as beside:
        beside.write_text("half")
        raise error
    assert files(tmp_path) == {"a.txt": "old"}
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_folder_appears_whole_or_not(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), staged_folder(tmp_path / "clips") as beside:
        (beside / "a").write_text("1")
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []
    with staged_folder(tmp_path / "clips") as beside:
        (beside / "a").write_text("1")
    assert files(tmp_path) == {str(Path("clips", "a")): "1"}


def test_a_folder_that_is_there_keeps_its_files(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "mine").write_text("mine")

    def write(overwrite: bool, text: str) -> None:
        with staged_folder(tmp_path, overwrite) as beside:
            (beside / "deep").mkdir()
            (beside / "deep" / "a").write_text(text)
            (beside / f"b{text}").write_text(text)

    write(False, "1")
    with pytest.raises(InputError, match=r"holds deep.a already.*--overwrite"):
        write(False, "2")
    assert "b2" not in files(tmp_path), "nothing is written when one is there"
    write(True, "3")
    a, mine = str(Path("deep", "a")), str(Path("deep", "mine"))
    assert files(tmp_path) == {a: "3", mine: "mine", "b1": "1", "b3": "3"}


def test_refusals_come_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    for manager, path, said in (
        (staged_file, tmp_path / "file", "is there already; choose another name or pass --overwrite"),
        (staged_file, tmp_path, "is a folder, but a file is to be written"),
        (staged_folder, tmp_path / "file", "is a file, but a folder is to be written"),
        (staged_file, tmp_path / "file" / "below", "cannot be written"),
    ):
        with pytest.raises(InputError, match=said), manager(path):
            pytest.fail("was let in")
