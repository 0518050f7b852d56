"""What the terminal shows during a lesson."""

import io

import numpy as np
from rich.console import Console

from tests.teach.people import clips_of
from wigwag.skeleton import Landmark, Pose
from wigwag.teach.advice import Advice, Fault
from wigwag.teach.teacher import Coaching, Stage
from wigwag.view.stick import stick_figure
from wigwag.view.teaching import headline, lesson_panel


def standing() -> Pose:
    return Pose(clips_of(1, ("up",), 1)[0].joints[0], np.ones(13), 0)


def inked(text: str) -> np.ndarray:
    return np.array([[character != "\u2800" for character in line] for line in text.splitlines()])


def test_a_figure_stands_upright_in_the_middle_and_raises_its_hand_where_the_camera_sees_it():
    pose = standing()
    drawn = inked(stick_figure(pose, 14, 28))
    assert drawn.shape == (14, 28)
    assert 10 <= np.flatnonzero(drawn.any(axis=0)).mean() <= 18
    joints = pose.joints.copy()
    joints[Landmark.LEFT_WRIST] = joints[Landmark.LEFT_SHOULDER] + (0.6, 0.0, 0.0)
    aside = inked(stick_figure(Pose(joints, np.ones(13), 0), 14, 28))
    assert np.flatnonzero(aside.any(axis=0)).max() > np.flatnonzero(drawn.any(axis=0)).max()


def test_nobody_and_somebody_far_outside_are_drawn_without_harm():
    assert not inked(stick_figure(None)).any()
    assert inked(stick_figure(Pose(standing().joints * 50, np.ones(13), 0))).shape == (14, 28)


def test_the_panel_says_what_to_do_and_what_was_wrong():
    console = Console(width=100, record=True, file=io.StringIO())
    advice = Advice(Fault.OUT_OF_VIEW, "feet out of view: step back, or tilt the camera")
    for coaching, words in (
        (Coaching(Stage.COUNTDOWN, 1, count=2), "2 ..."),
        (Coaching(Stage.LOOK, 0, advice=advice), advice.text),
        (Coaching(Stage.SHOW, 2), "now!"),
    ):
        console.print(lesson_panel("mine", coaching, 3, standing()))
        text = console.export_text()
        assert f"mine: {coaching.taken} of 3" in text
        assert words in text
        assert headline(coaching) in text
