"""Why a gesture was what it was, on the page of a simulated flight, in a real browser."""

from __future__ import annotations

import signal
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.teach.people import model
from tests.view.browsers import Tab, chromium, of_color, serving
from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.teach.student import KernelStudent

LEFT = (47, 128, 216)
"""RGB of a left arm in the picture."""


def test_after_a_gesture_the_page_says_why(tmp_path: Path) -> None:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")
    KernelStudent(model()).copy().save(tmp_path / "m.wigwag")
    camera = "sim:?perform=orbit&person=11&times=6&pause_s=2.5&rate_hz=20"
    words = ("console", "--camera", camera, "--vehicle", "sim:", "--engage", "first", "--model", "m.wigwag")
    words += ("--commands", "left=stop", "land=land", "orbit=take_off")
    with chromium() as browser, serving(tmp_path, *words) as (process, url):
        tab = Tab(browser, url)
        why = tab.page.get_by_alt_text("why")
        why.wait_for()
        assert tab.page.get_by_text("sure, 0.").first.inner_text().count(": orbit, ") == 1
        tab.page.get_by_text("It would have been:").wait_for()
        assert tab.page.get_by_text("Refused, were more than").count() == 1
        why.scroll_into_view_if_needed()
        tab.keep("why")
        shown = np.frombuffer(why.screenshot(), np.uint8)
        picture = cv2.imdecode(shown, cv2.IMREAD_COLOR)[:, :, ::-1]
        assert picture.shape[1] > 300 and picture.shape[0] > picture.shape[1]
        assert (picture > 240).all(axis=2).mean() > 0.5 and of_color(picture, LEFT).sum() > 100
        assert tab.complaints == []
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
