"""``wigwag benchmark faults``, short."""

import json

from wigwag.cli.app import run


def test_records_and_table(tmp_path, capsys):
    file = tmp_path / "faults.json"
    assert run(["benchmark", "faults", "--runs", "1", "--only", "battery", "--json", str(file)]) == 0
    (row,) = json.loads(file.read_text())
    assert {"fault", "runs", "ended_as_documented", "end_state", "time_s_max"} <= set(row)
    assert (row["fault"], row["runs"], row["ended_as_documented"]) == ("battery low", 1, 1)
    assert row["end_state"] == "disarmed" and row["time_s_max"] < row["documented_s"]
    assert "Faults in flight" in capsys.readouterr().out


def test_no_such_fault(capsys):
    assert run(["benchmark", "faults", "--only", "meteorite"]) == 2
    assert "There are: camera lost" in capsys.readouterr().err
