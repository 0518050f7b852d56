"""What goes to Rerun, read back with Rerun's own tool."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.camera.fakes import TINY, frame
from tests.view.seen import body, somebody, standing
from wigwag.camera.frame import Frame
from wigwag.errors import InputError, MissingExtraError
from wigwag.view.rerun import RerunView

MS = 1_000_000


@pytest.fixture
def rerun():
    return pytest.importorskip("rerun", reason="needs rerun-sdk: pip install 'wigwag[view]'")


def printed(file: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "print", "-vv", str(file)],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    return done.stdout


def test_a_file_holds_picture_depth_people_figures_and_log(rerun, tmp_path):
    file = tmp_path / "new" / "seen.rrd"
    view = RerunView(save=file, spawn=False)
    depth = np.full((TINY.height, TINY.width), 3000, np.uint16)
    operator = somebody(1, body(), standing(), is_operator=True)
    for k in range(3):
        view.frame(Frame(frame(k, seed=k).rgb, depth, TINY, k * 33 * MS))
        view.people([operator, somebody(2, body(), None)] if k < 2 else [operator])
        view.figures({"pose_ms": 11.0 + k, "latency_ms": float("nan")})
    view.say("engaged")
    view.close()
    shown = printed(file)
    for path in (
        "/world/camera/rgb", "/world/camera/depth", "/world/people/1/bones", "/world/people/1/joints",
        "/world/camera/people/1/bones", "/world/camera/people/2/bones", "/figures/pose_ms", "/log",
    ):  # fmt: skip
        assert path in shown, path
    assert "/figures/latency_ms" not in shown, "what is not a number is not plotted"
    assert "Clear" in shown, "who is gone vanishes"
    assert "stamp" in shown


def test_without_file_and_viewer_there_is_nothing_to_show_in(rerun):
    with pytest.raises(InputError, match="file to save to or a viewer"):
        RerunView(save=None, spawn=False)


def test_a_file_that_cannot_be_written_is_said_at_once(rerun, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        RerunView(save=tmp_path / "file" / "seen.rrd", spawn=False)


def test_a_missing_extra_names_itself(monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(MissingExtraError, match=r"wigwag\[view\]"):
        RerunView(save=Path("x.rrd"), spawn=False)
