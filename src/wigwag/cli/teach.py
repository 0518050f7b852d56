"""``wigwag teach``: show a gesture of your own three times, and the model knows it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.camera.frame import Frame
    from wigwag.camera.protocol import Camera
    from wigwag.evaluate.taught import Estimate
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.skeleton import Clip
    from wigwag.teach.student import Student
    from wigwag.teach.teacher import Coaching, Sight, Teacher


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
    json: Path | None = None
    """File for the figures: one record."""
    models_dir: tyro.conf.Suppress[Path | None] = None

    def run(self) -> int:
        """Record, learn, estimate; return the exit code."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.cameras import open_camera, parse_camera
        from wigwag.datasets.folder import safe_name
        from wigwag.evaluate.records import Records, command_line

        if not self.gesture.strip() or not self.subject.strip():
            raise InputError("--gesture and --subject need a name each.")
        safe_name(self.gesture)
        records = Records(self.json, command_line("wigwag teach", self), 0)
        lesson, console = self._lesson(parse_camera(self.camera).kind), Console()
        with threadpool_limits(1):
            student = self._student(console)
            with console.status("opening the camera"):
                estimator = self._estimator()
                camera = open_camera(self.camera)
            with camera:
                taught = self._record(console, camera, estimator, self._teacher(student, lesson))
            estimate = self._learn(console, student, taught.clips) if taught.clips else None
        records.add(**self._figures(taught, estimate, student))
        if len(taught.clips) < self.repetitions:
            console.print(
                f"[red]the camera ended after {len(taught.clips)} of {self.repetitions} repetitions.[/] "
                + ("What there is has been taught; show more to add to it." if taught.clips else "")
            )
            return 1
        return 0 if estimate is None or estimate.right == estimate.shown else 1

    def _lesson(self, kind: str) -> Callable[[], Teacher]:
        from wigwag.teach.teacher import LessonConfig, Teacher

        live = kind in ("webcam", "realsense", "sim") and not self.camera.endswith((".bag", ".db3"))
        countdown_s = (3.0 if live else 0.0) if self.countdown is None else self.countdown
        config = LessonConfig(self.repetitions, countdown_s)
        return lambda: Teacher(self.gesture, self.subject, config=config)

    def _teacher(self, student: Student, lesson: Callable[[], Teacher]) -> Teacher:
        from wigwag.evaluate.taught import judge_of

        teacher = lesson()
        teacher.judge = judge_of(student, self.gesture)
        return teacher

    def _student(self, console: Console) -> Student:
        from wigwag.evaluate.taught import teach_base
        from wigwag.teach.student import open_student

        if self.model.exists():
            with console.status(f"reading {self.model}"):
                return open_student(self.model)
        with console.status("teaching the demo's ten commands first, by eight simulated people ..."):
            student = teach_base(self.model, self.recognizer)
        console.print(f"{self.model}: begun with the demo's ten commands.", highlight=False)
        return student

    def _estimator(self) -> PoseEstimator:
        from wigwag.pose.blazepose import BlazePoseConfig
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.pose.monocular import MonocularConfig
        from wigwag.pose.operator import OperatorConfig

        # A webcam has no depth; nothing flies here.
        return PoseEstimator(
            PoseConfig(
                BlazePoseConfig(models_dir=self.models_dir),
                monocular=MonocularConfig(),
                operator=OperatorConfig(engage=self.engage),
            )
        )

    def _record(
        self, console: Console, camera: Camera, estimator: PoseEstimator, teacher: Teacher
    ) -> Teacher:
        from rich.live import Live

        from wigwag.camera.fresh import fresh
        from wigwag.teach.teacher import Stage
        from wigwag.view.teaching import lesson_panel

        shown_ns = None
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
        return teacher

    def _note(self, console: Console, coaching: Coaching) -> None:
        """Say of a repetition that it was taken, and keep it; or why not."""
        if coaching.refused and coaching.advice is not None:
            console.print(f"not taken: {coaching.advice.text}", style="yellow", highlight=False)
        if coaching.clip is not None:
            path = keep(coaching.clip, self.clips, self.gesture, self.subject)
            console.print(
                f"taken: {coaching.taken} of {self.repetitions}, {coaching.clip.duration_s:.1f} s, {path}",
                highlight=False,
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
        )
        if estimate is not None:
            low, high = estimate.interval
            console.print(
                f"Leave-one-out ({estimate.protocol}): {estimate.right} of {estimate.shown} recognised; "
                f"of so few that means {100 * low:.0f} to {100 * high:.0f} % (95 % interval).",
                highlight=False,
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


def see(estimator: PoseEstimator, frame: Frame) -> Sight:
    """Look for whoever teaches in a frame."""
    from wigwag.teach.advice import out_of_view
    from wigwag.teach.teacher import Sight

    pose, body = estimator(frame), estimator.body
    height, width = frame.rgb.shape[:2]
    parts = () if body is None or pose is None else out_of_view(body.points_px, width, height)
    return Sight(frame.stamp_ns, pose, parts, estimator.why)


def keep(clip: Clip, folder: Path, gesture: str, subject: str) -> Path:
    """Save a repetition under the first free number."""
    from wigwag.datasets.folder import clip_path, save_clip

    number = 1
    while (folder / clip_path(replace(clip, name=f"{gesture}-{subject}-{number}"), ".json")).exists():
        number += 1
    return save_clip(replace(clip, name=f"{gesture}-{subject}-{number}"), folder)


__all__ = ["Teach", "keep", "see"]
