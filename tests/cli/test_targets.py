"""Places that cannot be written are told before the work; a disk that fails during it is told, too."""

import errno
from pathlib import Path

import pytest

from wigwag.cli.app import run
from wigwag.cli.doctor import Doctor
from wigwag.cli.targets import check_file, make_folder
from wigwag.errors import InputError


def test_folders_are_made_and_files_are_not(tmp_path: Path) -> None:
    make_folder(tmp_path / "a" / "b", "--out")
    check_file(tmp_path / "c" / "model.wigwag", "--model")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a", "b", "c"]
    check_file(tmp_path / "c" / "model.wigwag", "--model")  # again: they are there


def test_an_old_file_stays(tmp_path: Path) -> None:
    (tmp_path / "model.wigwag").write_text("old")
    check_file(tmp_path / "model.wigwag", "--model")
    assert (tmp_path / "model.wigwag").read_text() == "old"


def test_what_is_in_the_way_is_named_with_its_option(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match=r"--out .*taken: cannot be made a folder \(File exists\)"):
        make_folder(tmp_path / "taken", "--out")
    with pytest.raises(InputError, match=r"--model .*: is a folder. Name a file"):
        check_file(tmp_path, "--model")
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(InputError, match="nothing can be written there"):
        make_folder(tmp_path, "--out")


def test_a_disk_that_is_full_is_told_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(self: Doctor) -> int:
        raise OSError(errno.ENOSPC, "No space left on device", "out/report.html")

    monkeypatch.setattr(Doctor, "run", fails)
    assert run(["doctor"]) == 2
    assert "out/report.html: No space left on device" in capsys.readouterr().err


def test_a_fault_that_names_no_file_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(self: Doctor) -> int:
        raise OSError("of our own")

    monkeypatch.setattr(Doctor, "run", fails)
    with pytest.raises(OSError, match="of our own"):
        run(["doctor"])
