"""``wigwag teach`` out of recordings, through pixels and the network; the tutorial does it from a camera."""

import json
from pathlib import Path

import cv2
import pytest

from tests.teach.people import model
from wigwag.cameras import open_camera
from wigwag.cli.app import run
from wigwag.datasets.folder import load_folder
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.teach.open import open_student
from wigwag.teach.student import KernelStudent

FIRST_S = 4.0
"""What the simulated operator stands before that is left out."""


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two showings, as a video and as a folder of pictures."""
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    root = tmp_path_factory.mktemp("recorded")
    (root / "pictures").mkdir()
    video = cv2.VideoWriter(str(root / "shown.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (640, 480))
    with open_camera("sim:?perform=goalpost&person=11&times=2&pause_s=1.6") as camera:
        for number, frame in enumerate(camera):
            if frame.stamp_ns * 1e-9 > FIRST_S:
                picture = cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR)
                video.write(picture)
                cv2.imwrite(str(root / "pictures" / f"{number:05d}.jpg"), picture)
    video.release()
    return root


@pytest.mark.parametrize("camera", ["video:shown.mp4", "folder:pictures"])
def test_a_gesture_is_taught_out_of_a_recording(recordings, tmp_path, monkeypatch, capsys, camera):
    KernelStudent(model()).copy().save(tmp_path / "m.wigwag")
    kind, _, name = camera.partition(":")
    monkeypatch.chdir(tmp_path)
    line = ["teach", "--gesture", "mine", "--camera", f"{kind}:{recordings / name}", "--model", "m.wigwag"]
    assert run([*line, "--subject", "ann", "--repetitions", "2", "--json", "t.json"]) == 0
    out = capsys.readouterr().out
    [row] = json.loads(Path("t.json").read_text())
    assert row["taken"] == 2
    assert "m.wigwag: knows mine now, by 2 examples." in out
    assert "2 of 2 recognised" in out
    clips = load_folder("clips").clips
    assert [(clip.label, clip.subject, clip.name) for clip in clips] == [
        ("mine", "ann", "mine-ann-1"),
        ("mine", "ann", "mine-ann-2"),
    ]
    student = open_student("m.wigwag")
    assert "mine" in student.known
    assert student.model.recognise(clips[0]).label == "mine"


def test_a_recording_that_is_over_too_soon_is_said_and_nothing_is_lost(
    recordings, tmp_path, monkeypatch, capsys
):
    KernelStudent(model()).copy().save(tmp_path / "m.wigwag")
    before = (tmp_path / "m.wigwag").read_bytes()
    monkeypatch.chdir(tmp_path)
    camera = f"folder:{recordings / 'pictures'}"
    line = ["teach", "--gesture", "mine", "--camera", camera, "--model", "m.wigwag", "--no-learn"]
    assert run(line) == 1
    assert f"{camera}: ended after 2 of 3 repetitions." in capsys.readouterr().out
    assert len(load_folder("clips").clips) == 2
    assert (tmp_path / "m.wigwag").read_bytes() == before


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "--gesture needs a name; only with --console it may be left out"),
        (["--gesture", "x" * 41], "has 1 to 40 printable characters"),
        (["--gesture", ".."], "gives no file name"),
        (["--gesture", "mine", "--subject", " "], "--subject needs a name"),
        (
            ["--gesture", "mine", "--console-token", "a-long-secret"],
            "--console-token is for --console",
        ),
    ],
)
def test_wrong_input_is_said(words, says, capsys):
    assert run(["teach", "--camera", "sim:", *words]) == 2
    assert says in " ".join(capsys.readouterr().err.split())
