"""All commands alike, found from the code: help with an example that parses, exit codes, error texts, JSON.

The texts of errors stand in ``snapshots/``; after a wanted change run these tests with
``WIGWAG_SNAPSHOTS=write`` and read the difference.
"""

import dataclasses
import os
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
import tyro

from wigwag.cli.app import Commands, run
from wigwag.cli.catalogue import Entry, catalogue

ENTRIES = tuple(catalogue())
GROUPS = tuple(dict.fromkeys(entry.words[:n] for entry in ENTRIES for n in range(1, len(entry.words))))
SNAPSHOTS = Path(__file__).parent / "snapshots"

RECORDS_ELSEWHERE = {("demo",): "out", ("fly",): "log"}
"""Commands without ``--json`` whose figures come out under another option: summary.json, the journal."""


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
    """Return the example lines of a help text, which may be wrapped."""
    ends = r"(?=\n\s*\n|\n╭|\n-|\Z)"
    found = re.findall(rf"Example: (wigwag .*?){ends}", help_text, re.DOTALL)
    return [" ".join(example.split()) for example in found]


@pytest.mark.parametrize("words", [(), *GROUPS, *(entry.words for entry in ENTRIES)], ids=" ".join)
def test_help_says_what_it_is_for_with_an_example_that_parses(
    words: tuple[str, ...], wigwag: Callable[..., tuple[int, str, str]]
) -> None:
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
    names = {field.name for field in dataclasses.fields(entry.kind)}
    reports = "json" in names or RECORDS_ELSEWHERE.get(entry.words) in names
    assert reports or entry.words in NO_FIGURES, f"wigwag {words_of(entry)} reports figures without --json"


NO_FIGURES: set[tuple[str, ...]] = set()
"""Commands that report no figures."""

WRONG = (
    "demo --seed -1",
    "demo --idle --motion utd-mhad",
    "demo --idle --duration 0",
    "demo --motion utd-mhad",
    "demo --motion utd-mhad --data nowhere",
    "demo --out taken",
    "fly --camera webcam:0",
    "fly --vehicle balloon:1",
    "fly --vehicle sim:?colour=1",
    "fly --commands wave",
    "fly --commands wave=dance",
    "fly --fence 1 2 3",
    "fly --distance 0.1",
    "fly --model nowhere.wigwag",
    "fly --model taken",
    "watch --camera periscope:0",
    "watch --camera video:nowhere.mp4",
    "watch --camera sim:?colour=1",
    "watch --camera sim:?seed=x",
    "watch --camera sim: --duration-s 0",
    "pose",
    "pose nowhere.jpg --out drawn",
    "pose empty --out drawn",
    "pose taken --out drawn",
    "pose taken --out taken",
    "vocabulary check",
    "vocabulary check nowhere",
    "vocabulary check empty",
    "vocabulary check taken",
    "clips convert nowhere clips",
    "clips convert empty clips.csv",
    "clips migrate nowhere",
    "doctor --picture nowhere.jpg",
    "benchmark utd-mhad --data nowhere",
    "benchmark utd-mhad --data empty",
    "benchmark utd-mhad --data taken",
    "benchmark utd-mhad --data nowhere --seeds 0",
    "benchmark lift --data nowhere --knock-out 2",
    "benchmark lift --data nowhere",
    "benchmark pose --photos nowhere",
    "benchmark camera --seconds 0",
    "benchmark far --data nowhere",
    "benchmark monocular --people 0",
    "benchmark smooth --data nowhere",
    "benchmark dtw --queries 0",
    "benchmark gallery --data nowhere",
    "benchmark few-shot --data nowhere --draws 0",
    "benchmark reject --data nowhere",
    "benchmark faults --only nothing",
    "benchmark faults --json empty",
    "benchmark follow --seconds 0",
    "benchmark link --seconds 0",
    "benchmark operator --condition dance",
    "benchmark transfer --data nowhere",
    "benchmark stream --data-dir nowhere",
)
"""Wrong input that is told before anything is computed."""


@pytest.mark.parametrize("line", WRONG)
def test_error_texts(line: str, wigwag: Callable[..., tuple[int, str, str]]) -> None:
    code, _, err = wigwag(*shlex.split(line))
    assert code == 2, err
    assert "Traceback" not in err
    name = re.sub(r"[^a-z0-9]+", "_", line.lower()).strip("_")
    file, text = SNAPSHOTS / f"{name}.txt", f"$ wigwag {line}\n{err}"
    if os.environ.get("WIGWAG_SNAPSHOTS") == "write":
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    assert text == file.read_text("utf-8"), f"{file}: the text changed; see the top of this file"


def test_every_command_has_an_error_text_and_no_snapshot_is_left_over() -> None:
    covered = {tuple(line.split()) for line in WRONG}
    missing = [e.words for e in ENTRIES if not any(c[: len(e.words)] == e.words for c in covered)]
    assert not missing, f"add a line of wrong use to WRONG for {missing}"
    written = {file.stem for file in SNAPSHOTS.glob("*.txt")}
    assert written == {re.sub(r"[^a-z0-9]+", "_", line.lower()).strip("_") for line in WRONG}
