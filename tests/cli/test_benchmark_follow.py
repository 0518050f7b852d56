"""``wigwag benchmark follow``, short."""

import json

from wigwag.cli.app import run


def test_records_and_table(tmp_path, capsys, monkeypatch):
    from wigwag.evaluate import following

    monkeypatch.setattr(following, "VEHICLES", {"PX4-like": following.VEHICLES["PX4-like"]})
    monkeypatch.setattr(following, "MOVES", following.MOVES[:2])
    file = tmp_path / "follow.json"
    assert run(["benchmark", "follow", "--runs", "1", "--seconds", "5", "--json", str(file)]) == 0
    (row,) = json.loads(file.read_text())
    assert row["vehicle"] == "PX4-like" and row["runs"] == 1
    assert 0 < row["bearing_deg_mean"] <= row["bearing_deg_worst_run"] < 2.0
    assert 0 < row["distance_m_mean"] < 0.5
    assert 0 <= row["command_error_mean"] <= row["command_error_max"] < 0.3
    assert "A person on an arc" in capsys.readouterr().out


def test_no_runs(capsys):
    assert run(["benchmark", "follow", "--runs", "0"]) == 2
    assert "--runs must be 1 to 1000" in capsys.readouterr().err
