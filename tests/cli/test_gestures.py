"""``wigwag gestures``, ``train`` and ``evaluate`` on models and clips, without pixels."""

import json
from pathlib import Path

import pytest

from tests.teach.people import GESTURES, clips_of, model
from wigwag.cli.app import run
from wigwag.datasets.folder import save_clip
from wigwag.teach.open import open_student
from wigwag.teach.student import KernelStudent

UNKNOWN = "error: There is no gesture 'x'. Known gestures: bow, land, left, orbit, up, wave."
NO_FOLDER = "error: nowhere: no such folder. Expected <label>/<name>.json in it, one file a clip."


@pytest.fixture
def taught(tmp_path: Path) -> Path:
    path = tmp_path / "m.wigwag"
    KernelStudent(model()).copy().save(path)
    return path


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Clips of three people, two of whom teach."""
    root = tmp_path_factory.mktemp("clips")
    for person in (1, 2, 5):
        for clip in clips_of(person, (*GESTURES, "wave", "bow"), 2):
            if clip.label in ("up", "orbit", "land"):
                save_clip(clip, root / ("theirs" if person == 5 else "ours"))
    return root


def said(capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return captured.out, captured.err


def test_gestures_are_listed(taught, tmp_path, capsys):
    file = tmp_path / "l.json"
    assert run(["gestures", "list", str(taught), "--json", str(file)]) == 0
    out, _ = said(capsys)
    rows = json.loads(file.read_text())
    assert {row["gesture"]: row["examples"] for row in rows} == dict.fromkeys((*GESTURES, "wave", "bow"), 6)
    assert all(row["gesture"] in out for row in rows)


def test_a_gesture_is_shown_with_its_examples_and_neighbours(taught, tmp_path, capsys):
    file = tmp_path / "s.json"
    assert run(["gestures", "show", str(taught), "up", "--json", str(file)]) == 0
    out, _ = said(capsys)
    [row] = json.loads(file.read_text())
    assert len(row["examples"]) == 6
    assert f"nearest: {row['nearest'][0]}, {row['nearest_times'][0]:.2f} times" in out
    assert row["nearest_times"] == sorted(row["nearest_times"])


def test_renamed_and_removed_in_the_file(taught, capsys):
    assert run(["gestures", "rename", str(taught), "land", "down we go"]) == 0
    assert said(capsys)[0] == f"{taught}: land is down we go now.\n"
    assert "down we go" in open_student(taught).known
    assert run(["gestures", "remove", str(taught), "down we go"]) == 0
    assert "5 gestures are left" in said(capsys)[0]
    assert set(open_student(taught).known) == {"up", "left", "orbit", "wave", "bow"}


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["show", "m.wigwag", "x"], UNKNOWN),
        (["rename", "m.wigwag", "x", "y"], UNKNOWN),
        (
            ["rename", "m.wigwag", "up", "land"],
            "error: There is a gesture 'land' already; remove it first, or choose another name.",
        ),
        (
            ["remove", "m.wigwag", "x"],
            "error: There is no gesture 'x' to forget. Known gestures: bow, land, left, orbit, up, wave.",
        ),
        (
            ["list", "nowhere.wigwag"],
            "error: nowhere.wigwag: there is no such model file. Fit a recogniser and save it there.",
        ),
    ],
)
def test_wrong_use_is_said_and_changes_nothing(taught, argv, message, monkeypatch, capsys):
    monkeypatch.chdir(taught.parent)
    before = taught.read_bytes()
    assert run(["gestures", *argv]) == 2
    assert said(capsys)[1] == message + "\n"
    assert taught.read_bytes() == before


@pytest.mark.parametrize(
    "line",
    [
        "gestures list",
        "gestures show",
        "gestures rename",
        "gestures remove",
        "train",
        "evaluate",
        "teach",
        "demo",
        "benchmark teach",
    ],
)
def test_help_has_an_example(line, capsys):
    with pytest.raises(SystemExit) as left:
        run([*line.split(), "--help"])
    assert left.value.code == 0
    assert f"wigwag {line} " in said(capsys)[0].replace("\n", " ").split("Example:")[1]


def test_clips_become_a_model_that_is_evaluated_by_somebody_elses(folders, tmp_path, capsys):
    file, made = tmp_path / "t.json", tmp_path / "t.wigwag"
    assert run(["train", str(folders / "ours"), "-o", str(made), "--json", str(file)]) == 0
    out, _ = said(capsys)
    assert "up: 4 clips of 2 people" in out
    [row] = json.loads(file.read_text())
    assert (row["gestures"], row["clips"], row["kind"]) == (["land", "orbit", "up"], 12, "KernelRecognizer")
    out_dir, file = tmp_path / "out", tmp_path / "e.json"
    code = run(["evaluate", str(made), str(folders / "theirs"), "--json", str(file), "--out", str(out_dir)])
    out, _ = said(capsys)
    everything, *rows = json.loads(file.read_text())
    assert everything["clips"] == len(rows) == 6
    assert everything["right"] == sum(row["right"] for row in rows) >= 4
    assert code == (0 if everything["right"] == 6 else 1)
    assert f"{everything['right']} of 6 right" in out
    assert (out_dir / "confusion.png").stat().st_size > 5000
    for row in rows:
        assert row["right"] or row["clip"] in out, "clips that fail are named"


def test_a_model_that_fails_says_which_clips_and_leaves_with_1(folders, taught, tmp_path, capsys):
    for clip in clips_of(5, ("goalpost",), 2):
        save_clip(clip, tmp_path / "bad")
        wrong = type(clip)(clip.joints, clip.stamps_ns, "land", clip.subject, clip.name + " as land")
        save_clip(wrong, tmp_path / "bad")
    line = ["evaluate", str(taught), str(tmp_path / "bad")]
    assert run(line) == 1
    out, _ = said(capsys)
    assert out.count("land, taken for no gesture") == 2
    assert "2 of 4 right: 50.0 %" in out
    assert run([*line, "--least", "0.5"]) == 0


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["train", "nowhere", "-o", "m"], NO_FOLDER),
        (
            ["evaluate", "m.wigwag", "nowhere"],
            NO_FOLDER,
        ),
        (
            ["evaluate", "m.wigwag", "clips", "--least", "2"],
            "error: --least must be from 0 to 1, but got 2.0.",
        ),
        (
            ["demo", "--gestures", "up"],
            "error: --gestures, --commands and --rounds are for --model FILE: teach one first.",
        ),
        (
            ["demo", "--model", "m.wigwag", "--gestures", "goalpost"],
            "error: m.wigwag: does not know take_off, goalpost. It knows: bow, land, left, orbit, up, wave. "
            "Teach it: wigwag teach --gesture take_off --model m.wigwag",
        ),
        (
            ["demo", "--model", "m.wigwag", "--commands", "goalpost"],
            "error: --commands takes LABEL=COMMAND, but got 'goalpost'. Commands: take_off, land, stop, "
            "left, right, up, down, closer, farther, orbit.",
        ),
        (["teach", "--gesture", " "], "error: A gesture needs a name."),
        (
            ["teach", "--gesture", "x", "--repetitions", "0"],
            "error: A lesson needs 1 repetition or more, but got 0.",
        ),
        (
            ["teach", "--gesture", "x", "--camera", "sim:?perform=somersault", "--model", "m.wigwag"],
            "no somersault to show",
        ),
        (
            ["benchmark", "teach", "--gestures", "up"],
            "error: --gestures: up cannot be taught anew. There are: goalpost,",
        ),
        (
            ["benchmark", "teach", "--pairs", "3"],
            "error: --pairs takes TEACHER:PERFORMER, two numbers of people, but got '3'.",
        ),
    ],
)
def test_other_wrong_use_is_said(taught, argv, message, monkeypatch, capsys):
    monkeypatch.chdir(taught.parent)
    assert run(argv) == 2
    assert message in said(capsys)[1]


def test_one_gesture_alone_is_no_vocabulary(folders, tmp_path, capsys):
    for clip in clips_of(1, ("up",), 2):
        save_clip(clip, tmp_path / "one")
    assert run(["train", str(tmp_path / "one"), "-o", str(tmp_path / "m")]) == 2
    assert "it needs clips of two or more, but got ['up']" in said(capsys)[1]


def test_clips_that_cannot_be_read_are_named_and_the_exit_code_is_1(folders, tmp_path, capsys):
    for clip in clips_of(1, ("up", "land"), 1):
        save_clip(clip, tmp_path / "some")
    (tmp_path / "some" / "bad.json").write_text("{")
    assert run(["train", str(tmp_path / "some"), "-o", str(tmp_path / "m")]) == 1
    assert "left out: bad.json" in said(capsys)[0]
