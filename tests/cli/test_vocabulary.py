"""``wigwag vocabulary check`` on a folder of clips."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.evaluate.stream.test_run import Arms
from tests.evaluate.test_vocabulary import GOOD, again
from wigwag.cli.app import run
from wigwag.datasets.folder import save_clip
from wigwag.evaluate.stream import systems
from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.recognise import KernelRecognizer
from wigwag.stream.teach import teach_stream


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(systems.SYSTEMS, "stream", lambda _: Arms(("a2", "a1")))
    few = {"teach": simulated_everyday(1, "teach"), "test": simulated_everyday(1, "test")}
    monkeypatch.setattr(
        "wigwag.evaluate.vocabulary.simulated_everyday", lambda n, purpose, seed: few[purpose]
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("clips")
    for clip in (*GOOD, *again(GOOD, "a1", "twin")):
        save_clip(clip, root)
    save_clip(replace(GOOD[0], label=None), root)
    return root


def test_a_twin_is_an_exit_code_a_record_and_a_picture(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["vocabulary", "check", str(folder), "--out", str(tmp_path / "pictures")]
    assert run([*words, "--json", str(tmp_path / "found.json")]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "a1 and twin: too alike" in said
    assert "1 pair(s) too alike, of 3" in said
    assert (tmp_path / "pictures" / "too_alike-a1-twin.png").is_file()
    rows = json.loads((tmp_path / "found.json").read_text())
    assert [row["kind"] for row in rows] == ["gesture"] * 3 + ["pair"] * 3
    assert rows[3]["verdict"] == "too alike"
    assert rows[0]["command"].startswith(f"wigwag vocabulary check {folder} --out ")
    assert all(row["protocol"] == "people left out, 3 in 3 turns" for row in rows)


def test_a_good_vocabulary_exits_with_0(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["vocabulary", "check", str(folder), "--labels", "a1", "a2"]) == 0
    assert "0 pair(s) too alike, of 1" in " ".join(capsys.readouterr().out.split())


def test_a_saved_recogniser_is_judged_by_its_examples(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "clips.wigwag"
    KernelRecognizer(preset="fast", copies=0).fit([*GOOD, *again(GOOD, "a1", "twin")]).save(file)
    assert run(["vocabulary", "check", str(file), "--out", str(tmp_path / "none")]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "a1 and twin: too alike" in said and "0.00 h of everyday movement" in said
    assert not (tmp_path / "none").exists(), "a model holds nothing to draw"


def test_a_saved_stream_model_also_hears_everyday_life(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "stream.wigwag"
    teach_stream(GOOD).save(file)
    assert run(["vocabulary", "check", str(file), "--json", str(tmp_path / "found.json")]) == 0
    assert "0.04 h of everyday movement" in " ".join(capsys.readouterr().out.split())
    gesture = json.loads((tmp_path / "found.json").read_text())[0]
    assert gesture["label"] == "a1" and gesture["examples"] > 0 and gesture["found"] is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "either a folder of clips or --data"),
        (["{folder}", "--data", "x"], "either a folder of clips or --data"),
        (["{file}"], "model.wigwag"),
        (["{folder}", "--labels", "a1", "jump"], "There is no clip of jump"),
        (["{folder}", "--labels", "a1"], "two gestures or more, but got"),
        (["nowhere"], "no such folder"),
    ],
)
def test_faults(
    folder: Path, tmp_path: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "model.wigwag"
    file.write_bytes(b"model")
    assert run(["vocabulary", "check", *(w.format(folder=folder, file=file) for w in words)]) == 2
    assert message in " ".join(capsys.readouterr().err.split())
