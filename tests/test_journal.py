"""A flight written down survives a kill, and is decided again alike."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from wigwag.errors import DataError, InputError
from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.journal import Journal, decide_again, read_journal
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld


def flight(seed: int = 3) -> PromptedFlight:
    airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), seed)
    return PromptedFlight(SketchWorld(airframe, lambda t: (4.5, 0.3), seed=seed))


def fly(journal: Journal) -> None:
    flown = flight()
    for turn in range(30 * 14):
        commands = {45: Command.TAKE_OFF, 240: Command.LEFT, 330: Command.STOP, 370: Command.LAND}
        journal.turn(flown.turn(commands.get(turn)))


def test_a_flight_is_decided_again_alike(tmp_path: Path) -> None:
    path = tmp_path / "flight.jsonl"
    journal = Journal(path, camera="sim:", vehicle="sim:")
    fly(journal)
    journal.note(ended="all well")
    journal.close()
    turns = list(decide_again(path))
    assert len(turns) == 420
    assert all(then == now and sent == again for then, sent, now, again in turns)
    assert {verdict.mode for verdict, *_ in turns} >= {
        Mode.ARMING,
        Mode.EXECUTING,
        Mode.HOLDING,
        Mode.LANDING,
    }
    strict = list(decide_again(path, SupervisorConfig(max_speed_m_s=0.05)))
    assert any(sent != again for _, sent, _, again in strict), "other limits show what they would change"
    lines = list(read_journal(path))
    assert lines[0]["vehicle"] == "sim:" and lines[-1] == {"note": {"ended": "all well"}}
    assert len(lines[1]["state"]["position_m"]) == 3


def test_a_limit_that_was_tightened_in_flight_is_tightened_again(tmp_path: Path) -> None:
    path = tmp_path / "flight.jsonl"
    journal, flown = Journal(path), flight()
    for turn in range(30 * 12):
        if turn == 220:
            assert flown.step is not None
            assert flown.pilot.tighten(flown.step.situation, "max_speed_m_s", 0.2) == ""
            journal.note(limit="max_speed_m_s", value=0.2)
        commands = {45: Command.TAKE_OFF, 240: Command.LEFT}
        journal.turn(flown.turn(commands.get(turn)))
    journal.close()
    turns = list(decide_again(path))
    assert all(then == now and sent == again for then, sent, now, again in turns)
    assert any("speed" in sent.changed for _, sent, _, _ in turns[240:]), "the limit was felt"


def test_what_was_flown_is_there_after_a_kill(tmp_path: Path) -> None:
    path = tmp_path / "killed.jsonl"
    program = f"""
        from pathlib import Path
        from tests.test_journal import flight
        from wigwag.journal import Journal
        journal, flown = Journal(Path({str(path)!r})), flight()
        for turn in range(10_000):
            journal.turn(flown.turn())
            if turn == 50:
                print("flown", flush=True)
    """
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[1],
    ) as process:
        assert process.stdout is not None and process.stdout.readline() == b"flown\n"
        os.kill(process.pid, signal.SIGKILL)
    assert len(list(decide_again(path))) > 50


def test_a_last_line_cut_short_is_left_out_and_damage_before_it_is_told(tmp_path: Path) -> None:
    path = tmp_path / "cut.jsonl"
    journal = Journal(path)
    flown = flight()
    for _ in range(5):
        journal.turn(flown.turn())
    journal.close()
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    assert len(list(decide_again(path))) == 4
    path.write_bytes(whole.replace(b'"verdict"', b"verdict", 1))
    with pytest.raises(DataError, match="line 2 is damaged"):
        list(read_journal(path))
    path.write_text('{"journal": 1}\n{"situation": {}}\n')
    with pytest.raises(DataError, match="does not hold what it should"):
        list(decide_again(path))
    for text in ("[]\n", '{"journal": 99}\n'):
        path.write_text(text)
        with pytest.raises(DataError, match="expected a journal of version 1"):
            list(read_journal(path))
    with pytest.raises(DataError, match="cannot be read"):
        list(read_journal(tmp_path / "none"))


def test_no_file_is_written_over_and_a_full_disk_ends_no_flight(tmp_path: Path) -> None:
    path = tmp_path / "flight.jsonl"
    journal = Journal(path)
    with pytest.raises(InputError, match="there is a file already"):
        Journal(path)
    with pytest.raises(InputError, match="cannot be written"):
        Journal(path / "below")
    journal.close()
    journal.close()
    full = Path("/dev/full")
    if full.exists():
        journal._file = os.open(full, os.O_WRONLY)
        journal.turn(flight().turn())
        assert "No space left" in journal.failed
        journal.turn(flight().turn())
        journal.close()
