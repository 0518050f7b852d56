"""``wigwag benchmark link``, short, with an idle loop."""

import json

from wigwag.cli.app import run


def test_records_and_table(tmp_path, capsys):
    file = tmp_path / "link.json"
    assert run(["benchmark", "link", "--seconds", "4", "--no-pose", "--json", str(file)]) == 0
    (row,) = json.loads(file.read_text())
    assert row["load"] == "idle"
    assert 29 < row["rate_hz"] < 31
    assert 0 <= row["jitter_p50_ms"] <= row["jitter_p99_ms"] <= row["jitter_max_ms"]
    assert 0 <= row["decision_p50_ms"] < 40
    assert 0 <= row["machine_p99_ms"] <= row["machine_max_ms"]
    assert row["command"] == f"wigwag benchmark link --seconds 4.0 --no-pose --json {file}"
    assert "Set-points over UDP" in capsys.readouterr().out


def test_too_short_to_tell(capsys):
    assert run(["benchmark", "link", "--seconds", "1"]) == 2
    assert "--seconds must be 3 to 3600" in capsys.readouterr().err
