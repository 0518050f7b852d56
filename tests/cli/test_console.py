"""``--view``, ``--save`` and ``--console`` on every command that runs the chain."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.test_fly import Bench
from tests.view.console.test_desk import Page
from wigwag.cli.app import run
from wigwag.errors import ModelError
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.pose.blazepose import BlazePose
from wigwag.record.flight import Flight
from wigwag.record.replay import Comparison, Replay
from wigwag.view.console.values import Ask, Button
from wigwag.view.onlookers import Onlookers


@pytest.mark.parametrize("command", ["console", "demo", "fly", "teach", "watch"])
def test_every_command_that_runs_the_chain_can_be_looked_at(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        run([command, "--help"])
    assert caught.value.code == 0
    said = capsys.readouterr().out
    assert all(
        option in said for option in ("--view", "--save", "--console", "--console-at", "--console-token")
    )
    assert f"Example: wigwag {command}" in " ".join(said.split())


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--console-at", "nowhere"], "needs an address such as 127.0.0.1:8080, but got 'nowhere'"),
        (["--console-token", "short"], "needs 12 or more letters"),
        (["--no-console"], "wigwag fly does without"),
    ],
)
def test_wrong_input_says_what_is_wrong(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("viser", reason="needs viser: pip install 'wigwag[console]'")
    assert run(["console", *words]) == 2
    assert says in " ".join(capsys.readouterr().err.split())


def test_a_token_without_a_console_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["watch", "--camera", "sim:", "--console-token", "a-long-secret"]) == 2
    assert "--console-token is for --console" in capsys.readouterr().err


def test_what_is_pressed_reaches_the_flight_and_is_written_down(tmp_path: Path) -> None:
    path, page = tmp_path / "flight.mcap", Page()
    bench = Bench(path, duration_s=9.0)
    flying = bench.flying
    flying.onlookers = Onlookers(None, page)
    flying.onlookers.begin(flying.pilot)  # as if live: the test does not wait
    bench.camera.at[2.0] = lambda: page.wishes.append(Ask(None, "max_speed_m_s", 0.3))
    bench.camera.at[5.0] = lambda: page.wishes.append(Ask(Button.HOLD))
    bench.camera.at[6.0] = lambda: page.wishes.append(Ask(Button.ENGAGE))
    bench.camera.at[7.0] = lambda: page.wishes.append(Ask(Button.STOP))
    bench.says(1.5, Command.TAKE_OFF)
    assert flying.fly() == 0
    compared, turns = Comparison(), []
    for then, now in Replay(Flight.open(path)):
        compared.note(then, now)
        turns.append(then.turn)
    assert compared.same, "what was set and pressed on the page is done again"
    assert [turn.limits for turn in turns if turn.limits] == [{"max_speed_m_s": 0.3}]
    assert any(turn.verdict.row == "stop" and turn.verdict.mode is Mode.HOLDING for turn in turns)
    assert [turn.called for turn in turns].count(True) == 1
    assert any(turn.situation.withheld for turn in turns) and not turns[-1].situation.withheld


def test_the_cost_of_viewers_is_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser", reason="needs viser: pip install 'wigwag[console]'")
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    file = tmp_path / "console.json"
    words = ["--viewers", "2", "--rounds", "1", "--turns", "5", "--json", str(file)]
    assert run(["benchmark", "console", *words]) in (0, 1)
    alone, looked_at = json.loads(file.read_text("utf-8"))
    assert (alone["viewers"], looked_at["viewers"], alone["rate_left"]) == (0, 2, 1.0)
    assert looked_at["rate_hz"] > 0 and looked_at["loop_ms"] > 0
    assert "2 viewers" in capsys.readouterr().out
    assert run(["benchmark", "console", "--viewers", "0"]) == 2
