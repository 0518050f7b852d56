"""``wigwag benchmark record``: a few seconds, a few kills; the published figures take a hundred."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wigwag.cli.app import run


def test_a_short_flight_is_measured_and_survives_kills(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "record.json"
    assert run(["benchmark", "record", "--seconds", "3", "--kills", "4", "--json", str(out)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "4 of 4 killed flights open" in said
    plain, deep, kills = json.loads(out.read_text())
    assert plain["mb_ten_minutes"] < 400 < deep["mb_ten_minutes"]
    assert plain["loop_ms_mean"] < 3.0
    assert kills["lost_s_max"] <= 1.0 and kills["decided_alike"] == 4
    assert kills["turns_kept"] <= kills["turns_flown"] < kills["turns_kept"] + 4 * 30


@pytest.mark.parametrize("words", [("--seconds", "0"), ("--kills", "-1")])
def test_words_out_of_range(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["benchmark", "record", *words]) == 2
    assert "--seconds must be 1 to 7200" in " ".join(capsys.readouterr().err.split())
