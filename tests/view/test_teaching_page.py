"""A gesture taught from the page, in a real browser: named there, shown to a camera, learned, known."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.teach.people import model
from tests.view.browsers import Tab, chromium, of_color, serving
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.teach.open import open_student
from wigwag.teach.student import KernelStudent
from wigwag.view.draw import RIGHT


def test_a_gesture_is_taught_from_the_page(tmp_path: Path) -> None:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    KernelStudent(model()).copy().save(tmp_path / "m.wigwag")
    camera = "sim:?perform=goalpost&person=11&times=30&pause_s=1.6&rate_hz=20"
    line = ("teach", "--model", "m.wigwag", "--console")
    words = (*line, "--camera", camera, "--countdown", "0", "--repetitions", "2", "--subject", "ann")
    with chromium() as browser, serving(tmp_path, *words) as (process, url):
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
        during = tab.keep("teaching")
        tab.until("learned; leave-one-out 2 of 2")
        for picture in (during, tab.keep("taught")):
            assert of_color(picture[150:, :600], RIGHT).sum() > 30, "whoever teaches is seen"
        assert "<b>salute</b>" in open_student(tmp_path / "m.wigwag").known, "saved at once"
        assert tab.complaints == []
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
        assert (
            process.stdout is not None and "knows <b>salute</b> now, by 2 examples" in process.stdout.read()
        )
