"""All commands alike, found from the code: help with an example that parses, exit codes, error texts, JSON.

The texts of errors stand in ``snapshots/``, each below the command line of wrong use that it answers; the
command has to tell before anything is computed. A new file may hold that line alone: run these tests with
``WIGWAG_SNAPSHOTS=write``, as after a wanted change, and read the difference.
"""

import dataclasses
import inspect
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import tyro

from wigwag.cli.app import Commands, run
from wigwag.cli.catalogue import Entry, catalogue

ENTRIES = tuple(catalogue())
GROUPS = tuple(dict.fromkeys(entry.words[:n] for entry in ENTRIES for n in range(1, len(entry.words))))
SNAPSHOTS = sorted((Path(__file__).parent / "snapshots").glob("*.txt"))

RECORDS = {"json", "out", "log", "record"}
"""Options under which a command's figures come out: records, summary.json in a folder, a recorded flight."""

NO_FIGURES = {("flight", "repair"), ("gestures", "rename"), ("gestures", "remove")}
"""Commands that change files and report no figures."""


def words_of(entry: Entry) -> str:
    return " ".join(entry.words)


@pytest.fixture
def wigwag(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Run a command in a folder that holds an empty folder and a file that is nothing; code, out, err."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "taken").write_text("mine")
    for name, value in (("COLUMNS", "100"), ("NO_COLOR", "1"), ("TERM", "dumb")):
        monkeypatch.setenv(name, value)

    def call(*argv: str) -> tuple[int, str, str]:
        try:
            code = run(argv)
        except SystemExit as stop:
            code = int(stop.code or 0)
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def examples(help_text: str) -> list[str]:
    """Return the example lines of a help text that is too wide to be wrapped."""
    return re.findall(r"Example: (wigwag .*?)\s*$", help_text, re.MULTILINE)


@pytest.mark.parametrize("words", [(), *GROUPS, *(entry.words for entry in ENTRIES)], ids=" ".join)
def test_help_says_what_it_is_for_with_an_example_that_parses(
    words: tuple[str, ...], wigwag: Callable[..., tuple[int, str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    code, out, err = wigwag(*words, "--help")
    assert (code, err) == (0, "")
    if not words:
        assert all(entry.words[0] in out for entry in ENTRIES)
        return
    shown = examples(out)
    assert shown, out
    assert shown[0].startswith(f"wigwag {words[0]}")
    config = (tyro.conf.OmitSubcommandPrefixes, tyro.conf.OmitArgPrefixes)
    parsed = tyro.cli(Commands, args=shlex.split(shown[0])[1:], config=config)
    assert callable(parsed.run)


@pytest.mark.parametrize("entry", ENTRIES, ids=words_of)
def test_wrong_use_is_2_and_names_what_is_wrong(
    entry: Entry, wigwag: Callable[..., tuple[int, str, str]]
) -> None:
    code, out, err = wigwag(*entry.words, "--no-such-option")
    assert (code, out) == (2, "")
    assert "no-such-option" in err or "Missing argument" in err
    assert "Traceback" not in err


@pytest.mark.parametrize("words", [(), *GROUPS], ids=" ".join)
def test_a_group_without_its_command_is_2_and_lists_them(
    words: tuple[str, ...], wigwag: Callable[..., tuple[int, str, str]]
) -> None:
    code, _, err = wigwag(*words)
    assert code == 2
    inner = {entry.words[len(words)] for entry in ENTRIES if entry.words[: len(words)] == words}
    assert all(name in re.sub(r"[│\s]+", " ", err) for name in inner)


@pytest.mark.parametrize("entry", ENTRIES, ids=words_of)
def test_figures_can_be_had_as_json(entry: Entry) -> None:
    reports = RECORDS & {field.name for field in dataclasses.fields(entry.kind)}
    assert reports or entry.words in NO_FIGURES, f"wigwag {words_of(entry)} reports figures without --json"


@pytest.mark.parametrize("entry", ENTRIES, ids=words_of)
def test_a_command_that_may_end_in_1_says_when(entry: Entry) -> None:
    may = re.search(r"return (1\b|int\()", inspect.getsource(entry.kind))
    assert not may or re.search(r"exit\s+code", inspect.getdoc(entry.kind) or "", re.IGNORECASE)


@pytest.mark.parametrize("entry", ENTRIES, ids=words_of)
def test_a_command_shows_that_it_is_at_work(entry: Entry) -> None:
    """The marks are of what shows a bar, a line that changes, or a picture of the moment."""
    kinds = [kind for kind in entry.kind.__mro__ if kind.__module__.startswith("wigwag.")]
    sources = [inspect.getsource(sys.modules[kind.__module__]) for kind in kinds]
    assert any(re.search(r"\b(bar_of_steps|status|track|Progress|Live)\(", source) for source in sources)


@pytest.mark.parametrize("file", SNAPSHOTS, ids=lambda file: file.stem)
def test_error_texts(file: Path, wigwag: Callable[..., tuple[int, str, str]]) -> None:
    line, _, expected = file.read_text("utf-8").partition("\n")
    code, _, err = wigwag(*shlex.split(line.removeprefix("$ wigwag ")))
    assert code == 2, err
    assert "Traceback" not in err
    if os.environ.get("WIGWAG_SNAPSHOTS") == "write":
        file.write_text(f"{line}\n{err}", encoding="utf-8")
    else:
        assert err == expected, f"{file}: the text changed; see the top of this test"


@pytest.mark.parametrize("entry", ENTRIES, ids=words_of)
def test_every_command_has_an_error_text(entry: Entry) -> None:
    lines = [file.read_text("utf-8").partition("\n")[0].split()[2:] for file in SNAPSHOTS]
    covered = any(tuple(line[: len(entry.words)]) == entry.words for line in lines)
    assert covered, (
        f"add a line '$ wigwag {words_of(entry)} ...' of wrong use as a file in tests/cli/snapshots"
    )


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_knows_every_command(shell: str, wigwag: Callable[..., tuple[int, str, str]]) -> None:
    code, script, _ = wigwag("--tyro-print-completion", shell)
    assert code == 0
    assert all(word in script for entry in ENTRIES for word in entry.words)
    if shell == "bash" and shutil.which("bash"):
        checked = subprocess.run(["bash", "-n"], input=script, text=True, capture_output=True, check=False)
        assert checked.returncode == 0, checked.stderr
