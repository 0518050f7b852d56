"""From pixels to decisions, written down, and decided again from poses and from pixels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from wigwag.cli.app import run
from wigwag.cli.demo import Demo
from wigwag.cli.demo_flight import fly, pose_estimator
from wigwag.errors import InputError, ModelError
from wigwag.record.flight import Flight
from wigwag.record.replay import Comparison, Replay


def compare(replay: Replay) -> Comparison:
    compared = Comparison()
    for then, now in replay:
        compared.note(then, now)
    return compared


@pytest.fixture
def estimator():  # type: ignore[no-untyped-def]
    try:
        return pose_estimator()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


def test_decided_again_from_poses_and_from_pictures_that_lost_nothing(tmp_path: Path, estimator) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "flight.mcap"
    demo = Demo(out=tmp_path, seed=3, record=path, record_pictures="png", record_depth=True)
    session = demo._procedural_session(estimator)
    session.script = replace(session.script, duration_s=5.0)
    recorder = demo.recorder(session, b"not looked at")
    fly(session, estimator, Console(quiet=True), None, recorder=recorder)
    flight = Flight.open(path)
    assert flight.pose_config == estimator.config and flight.tells_operator
    found = sum(turn.pose is not None for turn in flight.turns())
    assert 30 < found < 120, "they engage in between"
    for material in ("poses", "frames"):
        compared = compare(Replay(flight, material=material))  # type: ignore[arg-type]
        assert compared.turns == 150 and compared.same and compared.poses == 0, material


def test_without_depth_frames_are_not_enough(tmp_path: Path, estimator) -> None:  # type: ignore[no-untyped-def]
    demo = Demo(out=tmp_path, seed=3, record=tmp_path / "flight.mcap")
    session = demo._procedural_session(estimator)
    session.script = replace(session.script, duration_s=0.2)
    fly(session, estimator, Console(quiet=True), None, recorder=demo.recorder(session, b"", "s2"))
    path = tmp_path / "flight-s2.mcap"
    with pytest.raises(InputError, match=r"holds pictures, but no depth.*--record-depth"):
        Replay(Flight.open(path), material="frames")


def test_a_recording_that_is_there_is_not_begun(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "flight.mcap"
    path.touch()
    assert run(["demo", "--record", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "there is a file already" in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out").exists()
    assert run(["fly", "--record", str(path)]) == 2
