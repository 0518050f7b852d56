"""Lessons that the console's page asks for, given to simulated people without pixels."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from rich.live import Live

from tests.teach.people import model, performed
from tests.view.console.test_desk import Page
from wigwag.camera.frame import Frame, Intrinsics
from wigwag.cli.classroom import Classroom
from wigwag.cli.lessons import NAME_MOST, Keeping, Voice, name_of
from wigwag.datasets.folder import load_folder
from wigwag.errors import InputError
from wigwag.skeleton import Pose
from wigwag.teach.open import open_student
from wigwag.teach.student import KernelStudent
from wigwag.teach.teacher import LessonConfig
from wigwag.view.console.values import Ask, Button, Lesson
from wigwag.view.onlookers import Onlookers


class Shown:
    """A camera before which somebody shows gestures, and the eyes that see them: poses pass for pictures."""

    address, connected, body, why, people = "shown:", True, None, "nobody is there", ()

    def __init__(self, gesture: str, times: int, at: dict[int, Callable[[], object]] | None = None) -> None:
        stream = performed(11, (gesture,), times, 1.6).stream
        self._frames = list(zip(stream.joints, stream.stamps_ns, strict=True))
        self._next, self._at = 0, at or {}
        self.now_ns = 0

    @property
    def ended(self) -> bool:
        return self._next == len(self._frames)

    def latest(self, timeout_s: float = 1.0) -> Frame | None:
        if self.ended:
            return None
        self._at.get(self._next, lambda: None)()
        self.now_ns = int(self._frames[self._next][1])
        self._next += 1
        rgb = np.full((8, 8, 3), 90 + self._next % 60, np.uint8)
        rgb[::2] += 60
        return Frame(rgb, None, Intrinsics(), self.now_ns)

    def __call__(self, frame: Frame) -> Pose:
        return Pose(self._frames[self._next - 1][0], np.ones(13), frame.stamp_ns)


class School:
    """A classroom with a page beside it, whose files lie in a folder."""

    def __init__(self, folder: Path, camera: Shown, repetitions: int = 2) -> None:
        KernelStudent(model()).copy().save(folder / "m.wigwag")
        self.student, self.page, self.out = open_student(folder / "m.wigwag"), Page(), io.StringIO()
        self.onlookers, self.camera = Onlookers(None, self.page), camera
        keeping = Keeping(
            "ann", folder / "clips", folder / "m.wigwag", True, LessonConfig(repetitions, countdown_s=0.0)
        )
        self.console = Console(file=self.out, width=200)
        self.room = Classroom(camera, self.student, keeping, Voice(self.console), self.onlookers)  # type: ignore[arg-type]
        self.onlookers.begin(eyes=camera, live=True)  # type: ignore[arg-type]
        desk = self.onlookers._desk
        assert desk is not None
        desk._clock_ns = lambda: camera.now_ns

    def give(self, gesture: str = "", stays: bool = True) -> None:
        with Live(console=self.console, auto_refresh=False) as live:
            self.room.give(self.camera, live, gesture, stays)  # type: ignore[arg-type]

    def wish(self, ask: Ask) -> None:
        self.page.wishes.append(ask)

    @property
    def states(self) -> Iterator[Lesson]:
        return (shown.lesson for shown in self.page.shown if shown.lesson is not None)


@pytest.mark.parametrize(
    "name",
    ["", "   ", "x" * (NAME_MOST + 1), "a\nb", "a\x1b[2Jb", "\ud800", "..", "...", "\u202eevil"],
)
def test_a_name_that_is_none_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="name"):
        name_of(name)


def test_a_name_is_taken_as_it_is_meant() -> None:
    assert name_of(" Grüße an alle ") == "Grüße an alle"
    assert name_of("../../etc/passwd") == "../../etc/passwd", "a name, whose folder is _.._etc_passwd"


def test_a_gesture_is_named_on_the_page_and_then_known(tmp_path: Path) -> None:
    camera = Shown("goalpost", 4)
    school = School(tmp_path, camera)
    wish = school.wish
    camera._at = {
        10: lambda: wish(Ask(teach="..")), 12: lambda: wish(Ask(teach="x" * 100)),
        20: lambda: wish(Ask(teach=" salute ")), 40: lambda: wish(Ask(teach="another")),
    }  # fmt: skip
    school.give()
    assert "salute" in open_student(tmp_path / "m.wigwag").known
    states = list(school.states)
    assert (states[0].gesture, states[0].headline, states[0].under_way) == ("", "name a gesture", False)
    headlines = [state.headline for state in states]
    for said in ("now!", "...", "learning ..."):
        assert said in headlines, said
    learning = next(state for state in states if state.learning)
    assert learning.under_way and learning.taken == 2
    last = states[-1]
    assert (last.gesture, last.headline) == ("salute", "learned; leave-one-out 2 of 2")
    assert not last.under_way and "salute" in last.known
    said = "\n".join(line.text for line in last.said)
    for part in (
        "refused: The name '..' gives no file name", "refused: A gesture's name has 1 to 40 printable",
        "refused: salute is being taught; cancel it first", "taken: 1 of 2",
        "knows salute now, by 2 examples", "Leave-one-out",
    ):  # fmt: skip
        assert part in said, part
        assert part in school.out.getvalue(), "the terminal says the same"
    [lesson] = school.room.lessons
    assert lesson.fine and len(load_folder(tmp_path / "clips").clips) == 2


def test_a_lesson_is_cancelled_and_another_begun(tmp_path: Path) -> None:
    camera = Shown("goalpost", 6)
    school = School(tmp_path, camera)
    before = (tmp_path / "m.wigwag").read_bytes()
    wish = school.wish
    camera._at = {
        5: lambda: wish(Ask(teach="first")), 300: lambda: wish(Ask(Button.CANCEL)),
        301: lambda: wish(Ask(Button.CANCEL)), 310: lambda: wish(Ask(teach="[bold]second")),
    }  # fmt: skip
    school.give()
    first, second = school.room.lessons
    assert first.cancelled and first.fine and first.outcome == "cancelled" and len(first.clips) == 1
    assert second.outcome == "learned; leave-one-out 2 of 2"
    known = open_student(tmp_path / "m.wigwag").known
    assert "first" not in known and "[bold]second" in known
    assert before != (tmp_path / "m.wigwag").read_bytes()
    labels = sorted(str(clip.label) for clip in load_folder(tmp_path / "clips").clips)
    assert labels == ["[bold]second", "[bold]second", "first"], "what was shown is kept"
    assert "[bold]second now" in school.out.getvalue(), "and no name is markup"


def test_a_known_gesture_gets_further_examples_and_without_a_page_it_ends(tmp_path: Path) -> None:
    school = School(tmp_path, Shown("up", 5), repetitions=1)
    counted = school.student.counts()["up"]
    school.give("up", stays=False)
    [lesson] = school.room.lessons
    assert school.student.counts()["up"] == counted + 1 and not school.camera.ended
    assert f"up is known by {counted} examples" in school.out.getvalue()
    assert lesson.estimate is None and lesson.outcome == "learned"


def test_without_a_page_any_more_nobody_waits_for_a_name(tmp_path: Path) -> None:
    school = School(tmp_path, Shown("up", 5))
    school.page.trouble = "the console's page is gone"
    school.give()
    assert not school.camera.ended and "page is gone" in school.out.getvalue()
