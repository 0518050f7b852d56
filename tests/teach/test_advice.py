"""What is told to whoever teaches: pure functions over values."""

import numpy as np
import pytest

from tests.teach.people import clips_of
from wigwag.pose.body import Point
from wigwag.skeleton import Clip, Landmark
from wigwag.teach.advice import (
    TOO_FAST_M_S,
    TOO_LIKE,
    UNLIKE_FIRST,
    Fault,
    Near,
    advise_likeness,
    advise_movement,
    advise_view,
    hand_speed_m_s,
    out_of_view,
)

INSIDE = np.tile([320.0, 240.0], (33, 1))


@pytest.mark.parametrize(
    ("point", "place", "part"),
    [
        (Point.LEFT_HEEL, (320, 483), "feet"),
        (Point.RIGHT_ANKLE, (320, 900), "feet"),
        (Point.LEFT_WRIST, (-5, 200), "left hand"),
        (Point.RIGHT_WRIST, (645, 200), "right hand"),
        (Point.NOSE, (320, -4), "head"),
        (Point.RIGHT_HIP, (320, 490), "hips"),
    ],
)
def test_what_lies_outside_of_the_picture_is_named(point, place, part):
    points = INSIDE.copy()
    points[point] = place
    assert out_of_view(points, 640, 480) == (part,)
    assert out_of_view(points, 640, 1000) == (() if place[1] > 480 else (part,))


def test_all_inside_and_at_the_very_edge_is_in_view():
    points = INSIDE.copy()
    points[Point.LEFT_HEEL] = (639, 481)
    assert out_of_view(points, 640, 480) == ()


def test_the_view_is_complained_about_in_words():
    assert advise_view(True, "", ()) is None
    nobody = advise_view(False, "nobody has engaged", ())
    assert (nobody.fault, nobody.text) == (Fault.NOBODY, "nobody to be seen: nobody has engaged")
    two = advise_view(True, "", ("left hand", "feet"))
    assert two.text == "left hand and feet out of view: step back, or tilt the camera"
    assert "most of you" in advise_view(True, "", ("head", "hips", "feet")).text


def waving(speed_m_s: float, seconds: float = 2.0) -> Clip:
    """The right hand goes aside at a steady speed."""
    frames = round(seconds * 30) + 1
    joints = np.zeros((frames, 13, 3))
    joints[:, Landmark.RIGHT_WRIST, 0] = np.arange(frames) * speed_m_s / 30
    return Clip.at_rate(joints, 30, name="waving")


def test_speed_of_the_hands_is_measured_and_one_wrong_depth_is_not():
    assert hand_speed_m_s(waving(2.0)) == pytest.approx(2.0, rel=0.05)
    joints = waving(0.0).joints.copy()
    joints[20, Landmark.LEFT_WRIST, 2] = 3.0
    assert hand_speed_m_s(Clip.at_rate(joints, 30)) < 0.01
    assert hand_speed_m_s(Clip.at_rate(joints[:5], 30)) == 0.0


@pytest.mark.parametrize(
    ("clip", "hole_s", "seen", "fault", "words"),
    [
        (waving(1.0, 0.7), 0.0, 1.0, Fault.TOO_FAST, "too fast: 0.7 s; take 1 to 5 s for it"),
        (waving(1.0, 6.0), 0.0, 1.0, Fault.TOO_LONG, "too long: 6.0 s; take 1 to 5 s for it"),
        (waving(9.0), 0.0, 1.0, Fault.TOO_FAST, "too fast: hands at 9 m/s; below 7 is seen well"),
        (waving(1.0), 0.4, 1.0, Fault.LOST, "lost you for 0.4 s: stay in the picture, facing the camera"),
        (
            waving(1.0),
            0.0,
            0.7,
            Fault.OUT_OF_VIEW,
            "feet out of view meanwhile: step back, or tilt the camera",
        ),
    ],
)
def test_what_is_wrong_with_a_movement(clip, hole_s, seen, fault, words):
    advice = advise_movement(clip, hole_s, seen, ["feet"])
    assert (advice.fault, advice.text) == (fault, words)


def test_what_people_ordinarily_show_is_neither_too_fast_nor_too_long():
    for person in (1, 2, 3):
        for clip in clips_of(person, ("up", "left", "orbit", "land", "wave", "bow"), 2):
            assert hand_speed_m_s(clip) < TOO_FAST_M_S
            assert advise_movement(clip, 0.0, 1.0) is None


def test_another_gesture_that_is_as_near_as_its_own_examples_is_too_like():
    near = [Near("mine", 0.4, "a"), Near("land", TOO_LIKE - 0.01, "b"), Near("up", 0.9, "c")]
    advice = advise_likeness("mine", near, None)
    assert advice.fault is Fault.TOO_LIKE
    assert advice.text.startswith('too like "up" (0.9 times')
    assert advise_likeness("mine", [Near("mine", 0.2, "a"), Near("land", TOO_LIKE, "b")], None) is None


def test_repetitions_have_to_be_alike():
    assert advise_likeness("mine", [], UNLIKE_FIRST) is None
    advice = advise_likeness("mine", [], UNLIKE_FIRST + 0.1)
    assert advice.fault is Fault.UNLIKE_FIRST
    assert "show the same again" in advice.text
