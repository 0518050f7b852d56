"""What a person reads while watching: rates, the operator in words, others, the camera's health."""

import io

import numpy as np
import pytest
from rich.console import Console

from tests.camera.fakes import Told, frame
from tests.view.seen import somebody, standing
from wigwag.camera.fresh import Glimpse
from wigwag.camera.playback import Playback
from wigwag.camera.watchdog import Health, Sight
from wigwag.view.watching import Meter, Watched, panel

MS = 1_000_000
FRESH = Health(Sight.FRESH, "", True, 0.0)
STALE = Health(Sight.STALE, "the same picture again and again for 0.4 s", False, 0.4)


def turn(stamp_ns, pose=None, pose_s=0.01, latency_s=None, health=FRESH):
    picture = frame(stamp_ns, seed=stamp_ns % 97) if health.usable else None
    return Watched(Glimpse(picture, health, stamp_ns), pose, pose_s, latency_s)


def text(watched, people=(), why="", meter=None):
    console = Console(file=io.StringIO(), width=200)
    meter = meter or Meter()
    meter.note(watched)
    console.print(panel(Playback(Told([])), watched, meter, people, why))
    return console.file.getvalue()


def test_the_rate_is_that_of_the_last_two_seconds():
    meter = Meter()
    for k in range(60):
        meter.note(turn(k * 100 * MS))
    for k in range(100):
        meter.note(turn(6_000 * MS + k * 25 * MS))
    assert meter.rate_hz == pytest.approx(40.0, rel=0.01)
    assert meter.account()["frames_fresh"] == 160


def test_the_account_counts_what_was_found_and_what_was_stale():
    meter = Meter()
    meter.note(turn(0))
    meter.note(turn(33 * MS, pose=standing(), pose_s=0.02, latency_s=0.03))
    meter.note(turn(400 * MS, health=STALE))
    account = meter.account()
    assert account["turns"] == 3
    assert account["sights"]["stale"] == 1
    assert account["operator_found"] == 0.5
    assert account["pose_ms_median"] == pytest.approx(15.0)
    assert account["latency_ms_median"] == pytest.approx(30.0)


def test_of_nothing_there_is_no_figure():
    account = Meter().account()
    assert account["operator_found"] is None
    assert account["rate_hz"] is None
    assert account["pose_ms_median"] is None


def test_the_operator_in_words():
    shown = text(turn(0, pose=standing()), [somebody(3, pose=standing(), is_operator=True)])
    assert "4.03 m away, 7° right, hips 0.30 m below the lens" in shown
    assert "12 of 13 landmarks measured, ± 20 mm" in shown
    assert "3 operator" in shown


def test_without_an_operator_the_reason_stands_there_and_who_is_engaging():
    people = [somebody(1, pose=standing(), engaging=0.4), somebody(2, disengaging=0.5, is_operator=True)]
    shown = text(turn(0), people, "nobody has raised a hand")
    assert "nobody has raised a hand" in shown
    assert "engaging 40%" in shown
    assert "2 operator" in shown
    assert "disengaging 50%" in shown


def test_a_stale_picture_is_said():
    assert "stale: the same picture again and again" in text(turn(0, health=STALE))


def test_a_pose_without_depth_says_so():
    pose = standing()
    blurred = type(pose)(pose.joints, pose.visibility, 0, np.full(13, 0.4), 0.35, monocular=True)
    assert "without depth: distance ± 0.35 m" in text(turn(0, pose=blurred))
