"""A gesture taught from the page, in a real browser: named there, shown to a camera, learned, known."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.teach.people import model
from tests.view.browsers import Tab, chromium, of_color
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.teach.student import KernelStudent, open_student
from wigwag.view.draw import RIGHT

PICTURES = os.environ.get("WIGWAG_TEST_PICTURES")
"""A folder for what was to be seen, to look at."""


@contextmanager
def teaching(folder: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run ``wigwag teach --console`` until the end of the block; give the process and its page."""
    wigwag = Path(sys.executable).parent / "wigwag"
    line = [str(wigwag), "teach", "--model", "m.wigwag", "--console", "--console-at", "127.0.0.1:0", *words]
    with subprocess.Popen(line, cwd=folder, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found is not None
        try:
            yield process, found.group()
        finally:
            process.kill()


def test_a_gesture_is_taught_from_the_page(tmp_path: Path) -> None:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    KernelStudent(model()).copy().save(tmp_path / "m.wigwag")
    camera = "sim:?perform=goalpost&person=11&times=30&pause_s=1.6&rate_hz=20"
    words = ("--camera", camera, "--countdown", "0", "--repetitions", "2", "--subject", "ann")
    with chromium() as browser, teaching(tmp_path, *words) as (process, url):
        tab = Tab(browser, url)
        tab.until("name a gesture")
        assert tab.page.get_by_role("button", name="STOP").count() == 0, "nothing flies"
        name = tab.page.get_by_role("textbox").first
        name.fill("...")
        tab.press("Teach")
        tab.until("refused: The name '...' gives no file name")
        name.fill("<b>salute</b>")
        tab.press("Teach")
        tab.until("<b>salute</b>: 0 of 2")
        tab.until("taken: 1 of 2")
        during = tab.picture()
        tab.until("learned; leave-one-out 2 of 2")
        after = tab.picture()
        for number, picture in enumerate((during, after)):
            if PICTURES:
                save(Path(PICTURES) / f"teaching-{number}.png", picture)
            assert of_color(picture[150:, :600], RIGHT).sum() > 30, "whoever teaches is seen"
        assert "<b>salute</b>" in open_student(tmp_path / "m.wigwag").known, "saved at once"
        assert tab.complaints == []
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
        assert (
            process.stdout is not None and "knows <b>salute</b> now, by 2 examples" in process.stdout.read()
        )


def save(path: Path, picture) -> None:
    import cv2

    cv2.imwrite(str(path), picture[:, :, ::-1])
