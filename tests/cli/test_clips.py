"""``wigwag clips``, and shell completion: exit codes, what is said, what is written."""

import json
import shlex
from pathlib import Path

import pytest

from tests.datasets.test_bvh import clip
from wigwag import __version__
from wigwag.cli.app import run
from wigwag.datasets.folder import load_folder, save_clip


@pytest.fixture
def clips(tmp_path: Path) -> Path:
    for seed in range(3):
        save_clip(clip(seed), tmp_path / "my clips")
    return tmp_path / "my clips"


def said(capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return captured.out, captured.err


def test_convert_says_what_it_wrote_and_the_record_repeats_it(
    clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, record = tmp_path / "bvh", tmp_path / "r.json"
    argv = ["clips", "convert", str(clips), str(out), "--target-format", "bvh", "--json", str(record)]
    assert run(argv) == 0
    assert said(capsys)[0] == f"{out}: 3 clips, 18 frames (bvh)\n"
    [row] = json.loads(record.read_text())
    assert (row["clips"], row["frames"], row["left_out"], row["version"]) == (3, 18, [], __version__)
    assert shlex.split(row["command"]) == ["wigwag", *argv[:-2]]
    assert run([*shlex.split(row["command"])[1:], "--overwrite"]) == 0


def test_what_is_left_out_is_named_and_the_exit_code_is_1(
    clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for i in range(12):
        (clips / f"bad{i:02d}.json").write_text("{")
    assert run(["clips", "convert", str(clips), str(tmp_path / "new")]) == 1
    out, err = said(capsys)
    assert "3 clips" in out
    assert err.count("left out: bad") == 10
    assert "left out: 2 more (all of them with --json)" in err
    assert len(load_folder(tmp_path / "new").clips) == 3


def test_errors_on_the_command_line(clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    taken = tmp_path / "taken.bvh"
    taken.write_text("mine")
    for argv, message in (
        (["convert", "nowhere", "x"], "error: nowhere: no such file or folder.\n"),
        (
            ["convert", str(clips), str(taken)],
            f"error: {taken}: is there already; choose another name or pass --overwrite.\n",
        ),
        (
            ["convert", str(clips), "x.csv"],
            "error: x.csv: no form is known by the ending .csv. Give a folder's name, a .parquet or a .bvh "
            "file, or say --target-format.\n",
        ),
        (
            ["migrate", str(tmp_path / "nowhere")],
            f"error: {tmp_path / 'nowhere'}: no such folder. "
            "Expected <label>/<name>.json in it, one file a clip.\n",
        ),
    ):
        assert run(["clips", *argv]) == 2
        assert said(capsys)[1] == message
    assert taken.read_text() == "mine"


def test_migrate_says_all_is_current(clips: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = tmp_path / "r.json"
    assert run(["clips", "migrate", str(clips), "--json", str(record)]) == 0
    assert said(capsys)[0] == f"{clips}: 3 current, 0 migrated, 0 refused (version 1)\n"
    [row] = json.loads(record.read_text())
    assert (row["current"], row["migrated"], row["refused"]) == (3, [], [])


def test_migrate_refuses_newer(clips: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (clips / "new.json").write_text('{"format": "wigwag-clip", "version": 2}')
    assert run(["clips", "migrate", str(clips)]) == 1
    out, err = said(capsys)
    assert "3 current, 0 migrated, 1 refused" in out
    assert err == (
        "left as it is: new.json: version is 2, but this wigwag reads versions up to 1. Update wigwag.\n"
    )


@pytest.mark.parametrize("command", [["clips"], ["clips", "convert"], ["clips", "migrate"]])
def test_help_has_an_example(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        run([*command, "--help"])
    assert stop.value.code == 0
    assert command == ["clips"] or "Example: wigwag clips" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_shell_completion_is_printed(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        run(["--tyro-print-completion", shell])
    assert stop.value.code in (0, None)
    script = capsys.readouterr().out
    for word in ("wigwag", "demo", "clips", "convert", "migrate", "--overwrite"):
        assert word in script
