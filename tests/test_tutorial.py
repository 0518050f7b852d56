"""The tutorial's commands, as they stand in it and in its order: from nothing to a flight and its report."""

import json
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import pytest

from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose

TUTORIAL = Path(__file__).parents[1] / "docs" / "tutorial.md"


def commands() -> list[list[str]]:
    """Return what is typed in the tutorial's shell blocks, a line a command."""
    blocks = re.findall(r"^```sh\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    return [shlex.split(line) for line in lines if line.strip()]


@pytest.fixture(scope="module")
def networks() -> None:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


def test_every_command_is_wigwags_and_comes_from_the_clone():
    assert len(commands()) >= 10
    assert all(command[:3] == ["uv", "run", "wigwag"] for command in commands())


def test_a_new_user_gets_from_nothing_to_a_flight(networks: None, tmp_path: Path) -> None:
    wigwag = Path(sys.executable).parent / "wigwag"
    said: dict[str, str] = {}
    began = time.monotonic()
    for command in commands():
        done = subprocess.run(
            [str(wigwag), *command[3:]], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{shlex.join(command)}:\n{done.stdout}\n{done.stderr}"
        said[shlex.join(command[3:5])] = done.stdout
    assert len(list((tmp_path / "clips").rglob("*.json"))) == 6
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["gestures"]["recognised"] == summary["gestures"]["shown"] == 4
    assert (summary["gestures"]["wrong"], summary["false_commands"]) == (0, 0)
    assert summary["commands"] == {"take_off": "take_off", "goalpost": "orbit", "crane": "up", "land": "land"}
    report = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "goalpost" in report
    assert (tmp_path / "out" / "demo.mp4").stat().st_size > 100_000
    evaluation = json.loads((tmp_path / "evaluation.json").read_text())[0]
    assert (evaluation["right"], evaluation["clips"]) == (3, 3)
    assert (tmp_path / "evaluation" / "confusion.png").exists()
    (replayed,) = json.loads((tmp_path / "replay.json").read_text())
    assert replayed["same"] and replayed["turns"] > 500 and replayed["times_real_time"] > 4
    explained = json.loads((tmp_path / "explained" / "explained.json").read_text())
    assert {"goalpost", "crane"} <= {one["label"] for one in explained}
    assert all((tmp_path / "explained" / one["picture"]).stat().st_size > 20_000 for one in explained)
    assert time.monotonic() - began < 15 * 60, "the tutorial promises a quarter of an hour"
