"""The loop of ``wigwag teach``: lessons one after another before one camera, named by whoever looks on."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from wigwag.cli.lessons import Keeping, OneLesson, Phase, Voice, name_of
from wigwag.errors import InputError
from wigwag.view.console.values import Button, Lesson
from wigwag.view.teaching import headline, lesson_panel

if TYPE_CHECKING:
    from rich.live import Live

    from wigwag.camera.fresh import Glimpse
    from wigwag.camera.protocol import Camera
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.skeleton import Pose
    from wigwag.teach.student import Student
    from wigwag.view.onlookers import Onlookers

_DRAWN_EVERY_NS = 90_000_000


class Classroom:
    """Gives lessons before a camera.

    Args:
        estimator: Finds whoever teaches.
        student: What learns.
        keeping: How lessons go.
        voice: Where it is said what comes of them.
        onlookers: Whoever looks on. On the console's page gestures are named, too, and lessons cancelled.
    """

    def __init__(
        self, estimator: PoseEstimator, student: Student, keeping: Keeping, voice: Voice, onlookers: Onlookers
    ) -> None:
        self._estimator, self._student, self._keeping = estimator, student, keeping
        self._voice, self._onlookers = voice, onlookers
        self.lessons: list[OneLesson] = []
        """All that were begun."""
        self._drawn_ns: int | None = None

    def give(self, camera: Camera, live: Live, gesture: str = "", stays: bool = False) -> None:
        """Look through a camera until it ends, or all is taught.

        Args:
            camera: Where whoever teaches is seen.
            live: What the terminal shows of this moment.
            gesture: What to begin with; empty: what the page names.
            stays: Go on with what the page names, as long as there is a page.
        """
        from wigwag.camera.fresh import fresh

        if gesture:
            self._begin(gesture)
        for glimpse in fresh(camera):
            self._voice.now_ns = glimpse.now_ns
            self._onlookers.asked()
            self._obey()
            pose, lesson = self._look(glimpse, live), self._current
            if lesson is not None and lesson.shown:
                self._learn(lesson, glimpse, pose, live)
                if not stays:
                    return
            if self._current is None and self._onlookers.trouble:
                self._voice.say(self._onlookers.trouble, "alarm")
                return
        if self._current is not None:  # the camera ended too soon: there may be something to learn
            live.update("learning ...", refresh=True)
            self._current.learn()

    @property
    def _current(self) -> OneLesson | None:
        """The lesson that is under way."""
        return self.lessons[-1] if self.lessons and self.lessons[-1].phase is not Phase.OVER else None

    def _begin(self, gesture: str) -> None:
        known = self._student.counts().get(gesture)
        self.lessons.append(OneLesson(gesture, self._student, self._keeping, self._voice))
        if known:
            self._voice.say(f"{gesture} is known by {known} examples; yours come beside them.")

    def _obey(self) -> None:
        """Do what was asked for on the page; what cannot be done is said there."""
        for ask in self._onlookers.lessons():
            current = self._current
            if ask.button is Button.CANCEL:
                if current is not None:
                    current.cancel()
                continue
            try:
                name = name_of(ask.teach or "")
            except InputError as error:
                self._voice.say(f"refused: {error}", "refused")
                continue
            if current is not None:
                self._voice.say(f"refused: {current.gesture} is being taught; cancel it first.", "refused")
                continue
            self._begin(name)

    def _look(self, glimpse: Glimpse, live: Live) -> Pose | None:
        """Take in a picture, and show the moment; return who was seen."""
        from wigwag.teach.seeing import see

        began, sight = time.thread_time(), None
        if glimpse.frame is not None:
            sight = see(self._estimator, glimpse.frame)
        pose = None if sight is None else sight.pose
        spent_s, current = time.thread_time() - began, self._current
        if sight is not None and current is not None:
            current.update(sight)
        if sight is not None and (
            self._drawn_ns is None or glimpse.now_ns - self._drawn_ns > _DRAWN_EVERY_NS
        ):
            self._drawn_ns = glimpse.now_ns
            self._draw(live, pose)
        self._tell(glimpse, pose, spent_s)
        return pose

    def _draw(self, live: Live, pose: Pose | None) -> None:
        current = self._current
        if current is None or current.coaching is None:
            live.update("waiting for a gesture's name from the page; Ctrl-C ends")
        else:
            repetitions = self._keeping.lesson.repetitions
            live.update(lesson_panel(current.gesture, current.coaching, repetitions, pose))

    def _tell(self, glimpse: Glimpse, pose: Pose | None, spent_s: float) -> None:
        self._onlookers.watched(
            glimpse.frame, pose, glimpse.now_ns, spent_s, trouble=glimpse.health.reason, lesson=self._state()
        )

    def _learn(self, lesson: OneLesson, glimpse: Glimpse, pose: Pose | None, live: Live) -> None:
        """Let the model learn; whoever looks on is told before, for until then nothing else is."""
        lesson.phase = Phase.LEARNING
        live.update("learning ...", refresh=True)
        self._tell(glimpse, pose, 0.0)
        lesson.learn()
        self._tell(glimpse, pose, 0.0)

    def _state(self) -> Lesson:
        """Return how it stands, for the page."""
        said, known, wanted = tuple(self._voice.lines), self._student.known, self._keeping.lesson.repetitions
        if not self.lessons:
            return Lesson("", "name a gesture", "", 0, wanted, False, False, said, known)
        lesson, advice, now = self.lessons[-1], "", "look at the camera"
        if lesson.phase is Phase.OVER:
            now = lesson.outcome
        elif lesson.phase is Phase.LEARNING:
            now = "learning ..."
        elif lesson.coaching is not None:
            now = headline(lesson.coaching)
            advice = "" if lesson.coaching.advice is None else lesson.coaching.advice.text
        return Lesson(
            lesson.gesture, now, advice, len(lesson.clips), wanted, lesson.phase is not Phase.OVER,
            lesson.phase is Phase.LEARNING, said, known,
        )  # fmt: skip


__all__ = ["Classroom"]
