"""A decision becomes a picture that shows movement, examples, and why."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.view.test_report import SUMMARY, flight
from wigwag.gesture import Gesture
from wigwag.recognise.explain import Example, Explanation
from wigwag.view.explained import headline_of, narrow_figure_of, narrow_png_of, png_of, svg_of
from wigwag.view.report import Still, jpeg, write_report

VIEWS = ("positions", "hands")


def moving(seed: int) -> np.ndarray:
    """A stick figure whose wrist goes up."""
    from wigwag.sim.sketch import _FIGURE

    standing = np.stack([_FIGURE[:, 1], -_FIGURE[:, 2], _FIGURE[:, 0]], axis=1) * 1.8
    joints = np.tile(standing, (20, 1, 1))
    joints[:, 5 + seed % 2, 1] -= np.sin(np.linspace(0, np.pi, 20)) * 1.5
    return joints


def example(label: str, seed: int) -> Example:
    path = np.stack([np.arange(20), np.minimum(np.arange(20) + 2, 19)], axis=1)
    path[0, 1] = 0
    return Example(label, f"{label} of somebody & <co>", 1.1, np.array([0.4, 0.9]), moving(seed), path)


@pytest.fixture
def decided() -> Explanation:
    return Explanation(
        Gesture("take_off", 0.97), "take_off", "land", 0.97, 0.7, 1.2, 0.4, VIEWS, np.array([1.5, -0.3]), 3,
        20, (example("take_off", 0), example("take_off", 0), example("land", 1)), moving(0), 1.4,
    )  # fmt: skip


def test_a_picture_says_what_was_decided_and_what_would_have_changed_it(decided: Explanation) -> None:
    svg = svg_of(decided, "3.2 s")
    for said in (
        "3.2 s: take off, 0.970 sure, 0.700 asked for",
        "what was seen, 1.4 s",
        "take off of somebody &amp; &lt;co&gt;, 1.10 times the usual distance",
        "Refused, were more than 0.970 asked for; it is 0.700.",
        "“land” too, without the 3 most telling of 20 examples.",
        "These views alone spoke for “land”: hands.",
        "What gives the lead of 1.20 over land",
    ):
        assert said in svg, said
    assert svg == svg_of(decided, "3.2 s"), "drawn twice, the same text"
    picture = cv2.imdecode(np.frombuffer(png_of(decided), np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape[0] > 600 and picture.shape[1] > 1200
    assert (picture < 250).any(axis=(0, 2)).mean() > 0.6, "there is something to see across it"


def test_in_a_narrow_column_the_same_is_drawn_one_above_the_other(decided: Explanation) -> None:
    assert headline_of(decided, "3.2 s") == "3.2 s: take off, 0.970 sure, 0.700 asked for"
    picture = cv2.imdecode(np.frombuffer(narrow_png_of(decided), np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape[0] > 1.5 * picture.shape[1] > 1000
    inked = (picture < 250).any(axis=(1, 2))
    assert inked.mean() > 0.6 and inked[-40:].any(), "from top to bottom"
    words = [text.get_text() for text in narrow_figure_of(decided).axes[0].texts]
    assert "take off of somebody & <co>, 1.10 times the usual" in words
    assert len([word for word in words if word.endswith(" %")]) == 4 * 6


def test_one_gesture_alone_can_be_drawn(decided: Explanation) -> None:
    from dataclasses import replace

    alone = replace(decided, runner_up=None, nearest=decided.nearest[:1], telling=None, over_nothing=None)
    assert "over nothing" in svg_of(alone) and "land" not in svg_of(alone)


def test_the_report_holds_the_pictures_of_what_can_be_explained(tmp_path: Path, decided: Explanation) -> None:
    page, picture = tmp_path / "report.html", jpeg(np.full((480, 640, 3), 90, np.uint8))
    stills = [Still("3.2 s: take off", picture, decided), Still("9.0 s: land", picture)]
    write_report(page, SUMMARY, flight(), stills)
    text = page.read_text("utf-8")
    assert text.count("<details") == 1 and text.count("<svg") == 5
    assert "<h2>Why</h2>" in text and "<summary>3.2 s: take off</summary>" in text
