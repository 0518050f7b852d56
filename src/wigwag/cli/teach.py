"""``wigwag teach``: show a gesture of your own three times, and the model knows it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.camera.protocol import Camera
    from wigwag.evaluate.taught import Estimate
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.skeleton import Clip
    from wigwag.teach.student import Student
    from wigwag.teach.teacher import Coaching, LessonConfig, Teacher


@dataclass(frozen=True)
class Teach:
    """Teach a gesture of your own: three repetitions before a camera, or out of a recording.

    Nothing flies. You are told what is wrong (too fast, feet out of view, too like another gesture); what is
    good is kept in a folder of clips, and the model learns it at once. Without a MODEL there yet, the demo's
    ten commands are taught first. In recordings, every movement between two rests counts as a repetition.

    Exit code: 0 taught, 1 the recording was over too soon or the showings are not recognised, 2 wrong input.
    Example: wigwag teach --camera webcam:0 --gesture salute --model mine.wigwag
    """

    gesture: str
    """Its name."""
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
    """File for the figures: one record."""
    models_dir: tyro.conf.Suppress[Path | None] = None

    def run(self) -> int:
        """Record, learn, estimate; return the exit code."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.cameras import open_camera, parse_camera
        from wigwag.cli.targets import check_file, make_folder
        from wigwag.datasets.folder import safe_name
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.taught import judge_of
        from wigwag.teach.teacher import Stage, Teacher

        if not self.gesture.strip() or not self.subject.strip():
            raise InputError("--gesture and --subject need a name each.")
        safe_name(self.gesture)
        lesson = self._lesson(parse_camera(self.camera).kind)
        records, console = Records(self.json, command_line("wigwag teach", self), 0), Console()
        check_file(self.model, "--model")
        make_folder(self.clips, "--clips")
        with threadpool_limits(1):
            estimator = self._estimator()
            student = self._student(console)
            with console.status("opening the camera"):
                camera = open_camera(self.camera)
            with camera:
                teacher = Teacher(self.gesture, self.subject, judge_of(student, self.gesture), lesson)
                last = self._record(console, camera, estimator, teacher)
            learns = self.learn and len(teacher.clips) > 0
            estimate = self._learn(console, student, teacher.clips) if learns else None
        records.add(**self._figures(teacher, estimate, student))
        if last is None or last.stage is not Stage.DONE:
            self._complain(console, last, len(teacher.clips))
            return 1
        return 0 if estimate is None or estimate.right == estimate.shown else 1

    def _complain(self, console: Console, last: Coaching | None, taken: int) -> None:
        """Say that the camera ended too soon, and what was wrong then."""
        text = f"{self.camera}: ended after {taken} of {self.repetitions} repetitions."
        if last is not None and last.advice is not None:
            text += f" Last said: {last.advice.text}."
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
        from wigwag.teach.student import open_student

        if self.model.exists():
            with console.status(f"reading {self.model}"):
                return open_student(self.model)
        with console.status("trying the camera"), open_camera(self.camera):
            pass  # what cannot be opened is told now, not after a minute of teaching
        with console.status("teaching the demo's ten commands first, by eight simulated people ..."):
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

    def _record(
        self, console: Console, camera: Camera, estimator: PoseEstimator, teacher: Teacher
    ) -> Coaching | None:
        from rich.live import Live

        from wigwag.camera.fresh import fresh
        from wigwag.teach.seeing import see
        from wigwag.teach.teacher import Stage
        from wigwag.view.teaching import lesson_panel

        shown_ns, coaching = None, None
        with Live(console=console, refresh_per_second=10, transient=True) as live:
            for glimpse in fresh(camera):
                if glimpse.frame is None:
                    continue
                sight = see(estimator, glimpse.frame)
                coaching = teacher.update(sight)
                self._note(console, coaching)
                if shown_ns is None or glimpse.now_ns - shown_ns > 90_000_000:
                    shown_ns = glimpse.now_ns
                    live.update(lesson_panel(self.gesture, coaching, self.repetitions, sight.pose))
                if coaching.stage is Stage.DONE:
                    break
        return coaching

    def _note(self, console: Console, coaching: Coaching) -> None:
        """Say of a repetition that it was taken, and keep it; or why not."""
        if coaching.refused and coaching.advice is not None:
            console.print(
                f"not taken: {coaching.advice.text}", style="yellow", highlight=False, soft_wrap=True
            )
        if coaching.clip is not None:
            path = keep(coaching.clip, self.clips, self.gesture, self.subject)
            console.print(
                f"taken: {coaching.taken} of {self.repetitions}, {coaching.clip.duration_s:.1f} s, {path}",
                highlight=False,
                soft_wrap=True,
            )

    def _learn(self, console: Console, student: Student, clips: list[Clip]) -> Estimate | None:
        from wigwag.evaluate.taught import leave_one_out

        named = [replace(clip, name=f"{self.gesture} of {self.subject}, {clip.name}") for clip in clips]
        with console.status("learning"):
            estimate = leave_one_out(student, self.gesture, named)
            student.enrol(self.gesture, named)
            student.save(self.model)
        console.print(
            f"{self.model}: knows {self.gesture} now, by {student.counts()[self.gesture]} examples.",
            highlight=False,
            soft_wrap=True,
        )
        if estimate is not None:
            low, high = estimate.interval
            console.print(
                f"Leave-one-out ({estimate.protocol}): {estimate.right} of {estimate.shown} recognised; "
                f"of so few that means {100 * low:.0f} to {100 * high:.0f} % (95 % interval).",
                highlight=False,
                soft_wrap=True,
            )
        return estimate

    def _figures(self, teacher: Teacher, estimate: Estimate | None, student: Student) -> dict[str, object]:
        return {
            "gesture": self.gesture,
            "model": str(self.model),
            "kind": type(student.model).__name__,
            "taken": len(teacher.clips),
            "seconds": [round(clip.duration_s, 2) for clip in teacher.clips],
            "leave_one_out_right": None if estimate is None else estimate.right,
            "leave_one_out_shown": None if estimate is None else estimate.shown,
            "leave_one_out_answers": [] if estimate is None else list(estimate.answers),
            "gestures": list(student.known),
        }


def keep(clip: Clip, folder: Path, gesture: str, subject: str) -> Path:
    """Save a repetition under the first free number."""
    from wigwag.datasets.folder import clip_path, save_clip

    number = 1
    while (folder / clip_path(replace(clip, name=f"{gesture}-{subject}-{number}"), ".json")).exists():
        number += 1
    return save_clip(replace(clip, name=f"{gesture}-{subject}-{number}"), folder)


__all__ = ["Teach", "keep"]
