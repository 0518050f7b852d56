"""``wigwag demo``: wrong use ends with code 2 and help, and a short flight goes from pixels to a take-off."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
from rich.console import Console

from wigwag.camera import Frame
from wigwag.cli.app import run
from wigwag.cli.demo import Demo, Untaught
from wigwag.cli.demo_flight import account, account_of, fly, pose_estimator, write
from wigwag.errors import InputError, ModelError
from wigwag.fly.supervisor import Mode
from wigwag.fly.values import Command
from wigwag.gesture import Gesture
from wigwag.pilot import Step
from wigwag.skeleton import Clip
from wigwag.view.onlookers import Onlookers


def fails(capsys: pytest.CaptureFixture[str], words: tuple[object, ...], *needed: str) -> None:
    assert run(["demo", *(str(word) for word in words)]) == 2
    caught = capsys.readouterr()
    said = " ".join(caught.err.split())
    assert said.startswith("error: ")
    assert "Traceback" not in caught.err + caught.out
    for text in needed:
        assert text in said


@pytest.mark.parametrize("seed", [-1, 1_000_000])
def test_a_seed_out_of_range(tmp_path: Path, capsys: pytest.CaptureFixture[str], seed: int) -> None:
    fails(
        capsys,
        (f"--seed={seed}", "--out", tmp_path / "out"),
        f"--seed must be from 0 to 999999, but got {seed}",
        "training people",
    )
    assert not (tmp_path / "out").exists(), "nothing is made before the words are checked"


def test_recordings_without_their_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fails(
        capsys,
        ("--motion", "utd-mhad", "--out", tmp_path),
        "--motion utd-mhad needs --data: UTD-MHAD's folder (Skeleton.zip or Skeleton/)",
    )


def test_a_folder_that_is_not_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--motion", "utd-mhad", "--data", tmp_path / "nowhere", "--out", tmp_path)
    fails(capsys, words, f"{tmp_path}/nowhere: no such file or folder", "UTD-MHAD", "Skeleton.zip")


def test_a_folder_without_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--motion", "utd-mhad", "--data", tmp_path, "--out", tmp_path / "out")
    fails(capsys, words, f"{tmp_path}: holds none of Skeleton/, Skeleton.zip")


def test_an_out_that_is_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.touch()
    fails(capsys, ("--out", file), f"--out {file}: cannot be made a folder", "Name another")


@pytest.mark.parametrize(
    "words", [("--motion", "dance"), ("--recognizer", "light"), ("--seed", "one"), ("--x",)]
)
def test_words_that_mean_nothing(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        run(["demo", *words])
    assert caught.value.code == 2
    assert words[-1].lstrip("-") in capsys.readouterr().err


def test_a_recogniser_that_was_not_taught_says_so() -> None:
    with pytest.raises(InputError, match="has not been taught"):
        Untaught().recognise(None)


class TakeOff:
    """Takes every movement for one command, but what ends early: a pose that settles in the first second.

    Surest of the longest, as of a whole gesture: a take-off shown for too short is not confirmed.
    """

    def __init__(self, from_s: float) -> None:
        self.from_s = from_s
        self.clips: list[Clip] = []

    def recognise(self, clip: Clip) -> Gesture:
        if clip.stamps_ns[-1] * 1e-9 < self.from_s:
            return Gesture(None, 0.0)
        self.clips.append(clip)
        return Gesture("take_off", min(0.9, 0.3 * clip.duration_s))


class Looks(Onlookers):
    """Looks on, and counts."""

    begun = False
    turns = asks = 0

    def begin(self, *what: object, **how: object) -> None:
        self.begun = True

    def asked(self) -> Command | None:
        self.asks += 1
        return None

    def turn(self, frame: Frame | None, step: Step, trouble: str = "") -> None:
        self.turns += 1


def test_a_short_flight_from_pixels_to_figures_report_and_film(tmp_path: Path) -> None:
    """Ten seconds: the operator engages and shows the first signal, and the drone leaves the ground."""
    try:
        estimator = pose_estimator()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    demo, console = Demo(out=tmp_path, seed=3), Console(quiet=True)
    session = demo._procedural_session(estimator)
    first = session.script.shown[0]
    assert first.label == "take_off"
    recogniser = TakeOff(from_s=(first.start_s + first.end_s) / 2)
    script = replace(session.script, duration_s=first.end_s + 1.0, shown=(first,))
    session.script, session.log.shown = script, [first]
    session.pilot.spotter.recogniser = recogniser

    looks = Looks()
    stills = fly(session, estimator, console, tmp_path / "demo.mp4", onlookers=looks)
    assert looks.begun and looks.turns == looks.asks == int(script.duration_s * 30)
    summary = account_of(session, demo, {"clips_taught": 0})
    write(demo, session, summary, stills)
    account(console, summary, tmp_path)

    frames = int(script.duration_s * 30)
    engaged_s = script.engaged_s
    assert engaged_s is not None and 3.0 < engaged_s < first.start_s
    assert summary["pose"]["frames"] == pytest.approx((script.duration_s - engaged_s) * 30, abs=2)
    assert not any(row.found for row in session.log.rows if row.time_s < 1.5), "nobody had engaged"
    assert summary["pose"]["found"] > 0.95
    assert summary["gestures"] | {"decided_after_end_s_median": 0} == {
        "shown": 1, "recognised": 1, "wrong": 0, "missed": 0, "decided_after_end_s_median": 0,
    }  # fmt: skip
    assert summary["false_commands"] == 0
    assert session.log.rows[0].mode == Mode.DISARMED.value
    assert session.log.rows[-1].mode in (Mode.TAKING_OFF.value, Mode.FOLLOWING.value)
    assert session.log.rows[-1].drone_m[2] > 0.02, "it left the ground"
    assert all(np.ptp(clip.joints, axis=0).max() > 0.3 for clip in recogniser.clips)
    assert json.loads(json.dumps(summary)) == summary
    assert len(stills) == 1 and "take off" in stills[0].caption
    assert (tmp_path / "report.html").stat().st_size > 50_000
    with av.open(str(tmp_path / "demo.mp4")) as film:
        assert len(list(film.decode(video=0))) == -(-frames // 3)


@pytest.mark.parametrize(("wrong", "false", "code"), [(0, 0, 0), (1, 0, 1), (0, 2, 1)])
def test_the_exit_code_tells_of_what_nobody_asked_for(
    wrong: int, false: int, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    summary = {
        "gestures": {"recognised": 3, "shown": 4, "wrong": wrong}, "false_commands": false, "others_shown": 1,
        "pose": {"found": 1.0, "frames": 9}, "loop": {"hz": 40.0}, "follow": None,
    }  # fmt: skip
    monkeypatch.setattr(Demo, "_fly", lambda *_: summary)
    assert Demo(out=tmp_path, film=False).run() == code
    assert json.loads((tmp_path / "summary.json").read_text())["false_commands"] == false
