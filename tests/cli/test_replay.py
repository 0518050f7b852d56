"""``wigwag replay`` and ``wigwag flight``: exit codes, what they say, what they write."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.record.flights import flight, picture, record
from wigwag.cli.app import run
from wigwag.record.repair import is_whole


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "flight.mcap"
    record(path, facts={"camera": "sketch:"})
    return path


def test_a_replay_that_is_the_same(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = recording.with_name("figures.json")
    assert run(["replay", str(recording), "--json", str(out)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "420 turns, 14.0 s of flight" in said and "the same to the last bit: 4 gestures" in said
    (figures,) = json.loads(out.read_text())
    assert figures["same"] and figures["turns"] == 420 and figures["times_real_time"] > 4
    assert figures["kind"] == "all" and figures["source"] == "poses"


def test_another_model_is_compared(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import numpy as np

    from wigwag.recognise import KernelRecognizer
    from wigwag.skeleton import Clip

    rng = np.random.default_rng(0)
    clips = [Clip.at_rate(rng.normal(size=(30, 13, 3)), 30, label, "s1") for label in "abab"]
    model = recording.with_name("other.wigwag")
    KernelRecognizer(preset="fast", copies=0).fit(clips).save(model)
    out = recording.with_name("otherwise.json")
    assert run(["replay", str(recording), "--model", str(model), "--json", str(out)]) == 1
    figures, *differences = json.loads(out.read_text())
    assert not figures["same"] and "--model" in figures["command"]
    assert differences[0]["kind"] == "difference" and "take_off" in differences[0]["then"]
    said = " ".join(capsys.readouterr().out.split())
    assert "not the same, from" in said and "take_off (1.000)" in said and "nothing" in said


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["replay", "nowhere.mcap"], "cannot be read"),
        (["replay", "{}", "--from", "frames"], "holds no pictures that wigwag found poses in"),
        (["replay", "{}", "--model", "nowhere.wigwag"], "there is no such model file"),
        (["flight", "info", "nowhere.mcap"], "cannot be read"),
    ],
)
def test_wrong_input_is_told(
    recording: Path, words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([word.format(recording) for word in words]) == 2
    assert says in " ".join(capsys.readouterr().err.split())


def test_there_are_two_things_to_decide_from(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        run(["replay", str(recording), "--from", "dreams"])
    assert caught.value.code == 2
    assert "poses" in capsys.readouterr().err


def test_a_flight_is_told_about_and_mended(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["flight", "info", str(recording)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "420 in 14.0 s" in said and "gestures 4" in said and "its end whole" in said
    whole = recording.read_bytes()
    recording.write_bytes(whole[: len(whole) // 2])
    figures = recording.with_name("info.json")
    assert run(["flight", "info", str(recording), "--json", str(figures)]) == 0
    (told,) = json.loads(figures.read_text())
    assert told["flown_camera"] == "sketch:" and told["command"] == f"wigwag flight info {recording}"
    assert not told["whole"] and 0 < told["turns"] < 420 and told["duration_s"] < 14.0
    assert run(["flight", "info", str(recording), "--json", str(recording.parent)]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert run(["flight", "info", str(recording)]) == 0
    assert "cut short; wigwag flight repair" in capsys.readouterr().out
    assert run(["flight", "repair", str(recording)]) == 0
    assert is_whole(recording)
    assert "repaired," in capsys.readouterr().out
    assert run(["flight", "repair", str(recording)]) == 0
    assert "whole already" in capsys.readouterr().out
    recording.write_bytes(b"no flight at all")
    assert run(["flight", "repair", str(recording)]) == 2
    assert "is no MCAP file" in " ".join(capsys.readouterr().err.split())


def test_every_gesture_of_a_flight_is_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import numpy as np

    from tests.stream.people import examples, session
    from wigwag.pilot import Pilot
    from wigwag.recognise import KernelRecognizer
    from wigwag.record.recorder import Recorder
    from wigwag.sim.sketch import SketchWorld
    from wigwag.skeleton import Pose

    model, path, out = tmp_path / "m.wigwag", tmp_path / "flight.mcap", tmp_path / "why"
    taught = KernelRecognizer(preset="fast").fit([c for n in range(4) for c in examples(n)])
    taught.save(model)
    world = SketchWorld(flight().world.airframe, lambda t: (4.5, 0.3), seed=3)
    poses = iter(session(21).poses())
    pilot = Pilot(lambda frame: shown[0], taught, world.vehicle)
    recorder = Recorder(path, pilot, pictures="none", model=model.read_bytes(), patient=True)
    heard = []
    for turn, pose in enumerate(poses):
        world.step()
        frame = picture(turn)
        shown = [Pose(pose.joints + np.array([0, 0, 2.0]), pose.visibility, world.now_ns)]
        step = pilot.step(frame, world.now_ns)
        recorder.turn(frame, world.now_ns, step)
        heard += [step.gesture.label] if step.gesture is not None and step.gesture.label else []
    recorder.close()
    assert heard, "a gesture was said"
    assert run(["replay", str(path)]) == 0
    assert run(["explain", str(path), "--out", str(out)]) == 0
    told = json.loads((out / "explained.json").read_text())
    assert [one["label"] for one in told] == heard
    assert all((out / one["picture"]).stat().st_size > 20_000 for one in told)
    assert all(sum(one["pushes"].values()) == pytest.approx(one["lead"], abs=1e-3) for one in told)
    assert run(["explain", str(path), "--model", str(tmp_path / "none"), "--out", str(out)]) == 2


def test_a_flight_without_a_model_is_not_explained(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["explain", str(recording)]) == 2
    assert "holds no model. Name one with --model" in " ".join(capsys.readouterr().err.split())
