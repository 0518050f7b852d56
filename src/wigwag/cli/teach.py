"""``wigwag teach``: show a gesture of your own three times, and the model knows it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

from wigwag.cli.looking import Looking
from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.camera.protocol import Camera
    from wigwag.cli.classroom import Classroom
    from wigwag.cli.lessons import OneLesson
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.teach.student import Student
    from wigwag.teach.teacher import LessonConfig


@dataclass(frozen=True)
class Teach:
    """Teach a gesture of your own: three repetitions before a camera, or out of a recording.

    Nothing flies. You are told what is wrong (too fast, feet out of view, too like another gesture); what is
    good is kept in a folder of clips, and the model learns it at once. Without a MODEL there yet, the demo's
    ten commands are taught first. In recordings, every movement between two rests counts as a repetition.

    With --console a page in the browser says the same, and names further gestures, one after another, until
    Ctrl-C.

    Exit code: 0 taught, 1 the recording was over too soon or the showings are not recognised, 2 wrong input.
    Example: wigwag teach --camera webcam:0 --gesture salute --model mine.wigwag
    """

    gesture: str = ""
    """Its name. With --console it may be left out: then the page names it."""
    camera: str = "webcam:0"
    """Address of the camera, or of a recording (video:FILE, folder:DIR); see docs/cameras.md."""
    model: Path = Path("gestures.wigwag")
    """File of the model that learns it."""
    clips: Path = Path("clips")
    """Folder in which the repetitions are kept: CLIPS/GESTURE/NAME.json."""
    subject: str = "me"
    """Who shows it."""
    repetitions: int = 3
    """How many are wanted."""
    countdown: float | None = None
    """Seconds to stand still before each; by default 3, and none in recordings."""
    recognizer: Literal["kernel", "stream"] = "kernel"
    """Kind of model, where there is none yet: names a movement once it is over and learns on at once, or
    while it goes on and takes a minute to learn on."""
    engage: Literal["first", "gesture"] = "first"
    """Who teaches: whoever is seen first, or whoever raises one hand."""
    learn: bool = True
    """Let the model learn it; if not, the clips are kept alone, to evaluate by."""
    json: Path | None = None
    """File for the figures: one record a gesture."""
    looking: Looking = field(default_factory=Looking)
    models_dir: tyro.conf.Suppress[Path | None] = None

    def run(self) -> int:
        """Record, learn, estimate; return the exit code."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.camera.live import LiveCamera
        from wigwag.cameras import open_camera, parse_camera
        from wigwag.cli.classroom import Classroom
        from wigwag.cli.lessons import Keeping, Voice, name_of
        from wigwag.cli.targets import check_file, make_folder
        from wigwag.evaluate.records import Records, command_line

        gesture = self._gesture(name_of)
        lesson = self._lesson(parse_camera(self.camera).kind)
        keeping = Keeping(self.subject, self.clips, self.model, self.learn, lesson)
        records, console = Records(self.json, command_line("wigwag teach", self), 0), Console()
        check_file(self.model, "--model")
        make_folder(self.clips, "--clips")
        with threadpool_limits(1), ExitStack() as stack:
            onlookers = stack.enter_context(self.looking.open(console, flies=False, teaches=True))
            estimator = self._estimator()
            student = self._student(console)
            with console.status("opening the camera"):
                camera = stack.enter_context(open_camera(self.camera))
            onlookers.begin(eyes=estimator, live=isinstance(camera, LiveCamera))
            classroom = Classroom(estimator, student, keeping, Voice(console), onlookers)
            stopped = self._give(console, classroom, camera, gesture)
        for one in classroom.lessons:
            records.add(**one.figures())
        return self._account(console, classroom.lessons, stopped)

    def _gesture(self, name_of: Callable[[str], str]) -> str:
        """Return what is taught first; empty: what the page names."""
        if not self.subject.strip():
            raise InputError("--subject needs a name.")
        if not self.gesture and not self.looking.console:
            raise InputError("--gesture needs a name; only with --console it may be left out.")
        return name_of(self.gesture) if self.gesture else ""

    def _give(self, console: Console, classroom: Classroom, camera: Camera, gesture: str) -> bool:
        """Give the lessons; say whether Ctrl-C ended them, where that is how they end."""
        from rich.live import Live

        page = self.looking.console
        try:
            with Live(console=console, refresh_per_second=10, transient=True) as live:
                classroom.give(camera, live, gesture, stays=page)
        except KeyboardInterrupt:
            if not page:
                raise
            console.print("stopped")
            return True
        return False

    def _account(self, console: Console, lessons: list[OneLesson], stopped: bool) -> int:
        """Say what was not finished; return the exit code."""
        from wigwag.cli.lessons import Phase

        last = lessons[-1] if lessons else None
        if stopped and last is not None and last.phase is not Phase.OVER:
            last.cancel()
        elif not stopped and last is not None and not last.shown and not last.cancelled:
            self._complain(console, last)
        elif not stopped and last is None:
            console.print("Ended before a gesture was named.", style="red")
            return 1
        return 0 if all(one.fine for one in lessons) else 1

    def _complain(self, console: Console, lesson: OneLesson) -> None:
        """Say that the camera ended too soon, and what was wrong then."""
        taken, coaching = len(lesson.clips), lesson.coaching
        text = f"{self.camera}: ended after {taken} of {self.repetitions} repetitions."
        if coaching is not None and coaching.advice is not None:
            text += f" Last said: {coaching.advice.text}."
        if taken and self.learn:
            text += " What there is has been learned; show more to add to it."
        console.print(text, style="red", highlight=False, markup=False, soft_wrap=True)

    def _lesson(self, kind: str) -> LessonConfig:
        """Return how it goes: with a countdown where somebody can hear it."""
        from wigwag.teach.teacher import LessonConfig

        live = kind in ("webcam", "realsense", "sim") and not self.camera.endswith((".bag", ".db3"))
        countdown_s = (3.0 if live else 0.0) if self.countdown is None else self.countdown
        return LessonConfig(self.repetitions, countdown_s)

    def _student(self, console: Console) -> Student:
        from wigwag.cameras import open_camera
        from wigwag.evaluate.taught import teach_base
        from wigwag.teach.open import open_student

        if self.model.exists():
            with console.status(f"reading {self.model}"):
                return open_student(self.model)
        with console.status("trying the camera"), open_camera(self.camera):
            pass  # what cannot be opened is told now, not after a minute of teaching
        with console.status("teaching the demo's ten commands first, by simulated people ..."):
            student = teach_base(self.model, self.recognizer)
        console.print(f"{self.model}: begun with the demo's ten commands.", highlight=False)
        return student

    def _estimator(self) -> PoseEstimator:
        from wigwag.pose.blazepose import BlazePoseConfig
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.pose.operator import OperatorConfig
        from wigwag.teach.seeing import for_lessons

        config = for_lessons(PoseConfig(BlazePoseConfig(models_dir=self.models_dir)))
        return PoseEstimator(replace(config, operator=OperatorConfig(engage=self.engage)))


__all__ = ["Teach"]
