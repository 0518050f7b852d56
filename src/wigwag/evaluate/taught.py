"""How good is what somebody has taught: their own showings left out in turn, or clips of anybody."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from threadpoolctl import threadpool_limits

from wigwag.errors import InputError
from wigwag.evaluate.lessons import labelled, teach_procedural, usual
from wigwag.evaluate.metrics import people_interval, wilson_interval
from wigwag.evaluate.showings import between_rests
from wigwag.gesture import Gesture
from wigwag.recognise import KernelRecognizer
from wigwag.sim.clips import training_sessions
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamConfig, StreamModel
from wigwag.stream.models import Taught
from wigwag.teach.advice import Advice, advise_likeness
from wigwag.teach.open import open_student
from wigwag.teach.stream_student import StreamStudent
from wigwag.teach.student import KernelStudent, Student
from wigwag.teach.teacher import Judge

Kind = Literal["kernel", "stream"]
"""``"kernel"`` names movements that are over and learns on at once; ``"stream"`` names them while they go on,
and takes about a minute to learn on."""

NO_GESTURE = "no gesture"
"""What the answer 'none' is called among labels."""


def teach_base(path: Path, kind: Kind = "kernel") -> Student:
    """Teach the demo's ten commands, and everyday movements that are none, by simulated training people.

    Args:
        path: Where the model goes.
        kind: Which kind of model.
    """
    with threadpool_limits(1):
        if kind == "kernel":
            teach_procedural(path)
            return open_student(path)
        lesson = usual("stream")
        sessions = training_sessions(lesson.people, lesson.repetitions, lesson.seed)
        commands = sorted({s.label for session in sessions for s in session.shown if s.is_command})
        settings = StreamConfig(commands=tuple(commands))
        student = StreamStudent.taught((), [labelled(session) for session in sessions], settings)
        student.save(path)
        return student


def train(clips: Sequence[Clip], kind: Kind = "kernel", seed: int = 0) -> Student:
    """Teach a model from clips alone, for a camera that moves.

    Args:
        clips: Labelled examples; those without a label are movements that are no gesture.
        kind: Which kind of model.
        seed: Of varied copies.

    Raises:
        InputError: If there are not two gestures.
    """
    labels = sorted({clip.label for clip in clips if clip.label is not None})
    if len(labels) < 2:
        raise InputError(
            f"A model tells gestures from each other: it needs clips of two or more, but got {labels}. "
            "wigwag teach adds one to those of the demo."
        )
    with threadpool_limits(1):
        if kind == "stream":
            return StreamStudent.taught(clips, seed=seed)
        return KernelStudent(
            KernelRecognizer(origin="drift", preset="fast", random_state=seed).fit(list(clips))
        )


def judge_of(student: Student, label: str) -> Judge:
    """Return what says of a repetition whether it is too like another gesture, or unlike those before."""

    def judge(clip: Clip, before: Sequence[Clip]) -> Advice | None:
        to_first = student.apart(clip, before) if before else None
        return advise_likeness(label, student.nearest(clip), to_first)

    return judge


def answer(model: Taught, clip: Clip) -> Gesture:
    """Return what a model makes of one clip: at once, or, if it hears streams, played between two rests.

    Said more than one thing, or the same twice, a model of streams has said nothing that can be obeyed.
    """
    if not isinstance(model, StreamModel):
        return model.recognise(clip)
    stream = model.stream()
    played = between_rests(clip).stream
    visibility = np.ones(13)
    said = [
        gesture
        for joints, stamp in zip(played.joints, played.stamps_ns, strict=True)
        if (gesture := stream.update(Pose(joints, visibility, int(stamp)))) is not None
    ]
    spoken = [gesture for gesture in said if gesture.label is not None]
    if len(spoken) == 1:
        return spoken[0]
    if len(spoken) > 1:
        what = " and ".join(str(gesture.label) for gesture in spoken)
        return Gesture(None, spoken[0].confidence, 0, 0, 0, f"said {what}")
    return said[-1] if said else Gesture(None, 0.0, 0, 0, 0, "heard nothing")


@dataclass(frozen=True, slots=True)
class Estimate:
    """How often a gesture's own showings are recognised, each left out of teaching in turn."""

    label: str
    right: int
    shown: int
    protocol: str
    answers: tuple[str, ...]
    """What each was taken for."""

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share, by Wilson's score."""
        return wilson_interval(self.right, self.shown)


def leave_one_out(student: Student, label: str, clips: Sequence[Clip]) -> Estimate | None:
    """Teach all showings but one and ask for that one; in turn.

    A model of streams is not taught anew for each: of it, the nearest other example decides.

    Args:
        student: Before it has been taught these clips; stays as it is.
        label: The gesture.
        clips: Its showings.

    Returns:
        ``None`` with less than two showings, of which none can be left out.
    """
    if len(clips) < 2:
        return None
    answers = []
    for number, clip in enumerate(clips):
        rest = [other for i, other in enumerate(clips) if i != number]
        if isinstance(student, KernelStudent):
            said = answer(student.copy().enrol(label, rest).model, clip).label
        else:
            others = [near for near in student.nearest(clip) if near.label != label]
            own = student.apart(clip, rest)
            said = others[0].label if others and others[0].times < own else label
        answers.append(said or NO_GESTURE)
    protocol = "each showing left out of teaching"
    if not isinstance(student, KernelStudent):
        protocol = "the nearest other example"
    return Estimate(label, sum(said == label for said in answers), len(clips), protocol, tuple(answers))


@dataclass(frozen=True, slots=True)
class Verdict:
    """One clip and what was made of it."""

    clip: Clip
    expected: str
    """Its label; ``NO_GESTURE`` for a movement without, and for a gesture that may not be spoken."""
    said: str
    confidence: float
    reason: str

    @property
    def right(self) -> bool:
        """Whether the answer is what was expected."""
        return self.said == self.expected


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What a model makes of clips."""

    verdicts: tuple[Verdict, ...]

    @property
    def right(self) -> int:
        """How many are right."""
        return sum(verdict.right for verdict in self.verdicts)

    @property
    def false_commands(self) -> int:
        """How many movements that are no gesture, or another one, were taken for a gesture."""
        return sum(v.said not in (NO_GESTURE, v.expected) for v in self.verdicts)

    @property
    def people(self) -> tuple[str, ...]:
        """Who shows the clips."""
        return tuple(sorted({v.clip.subject or "somebody" for v in self.verdicts}))

    def interval(self, seed: int = 0) -> tuple[float, float]:
        """Return a 95 % interval of the accuracy: over people if there are several, else over clips."""
        if len(self.people) < 2 or self.right == len(self.verdicts):
            return wilson_interval(self.right, len(self.verdicts))
        right = np.array([float(v.right) for v in self.verdicts])
        return people_interval(right, [v.clip.subject or "somebody" for v in self.verdicts], seed)

    def of(self, label: str) -> tuple[int, int]:
        """Return how many clips of a label are right, and how many there are."""
        mine = [v for v in self.verdicts if v.expected == label]
        return sum(v.right for v in mine), len(mine)

    def labels(self) -> list[str]:
        """Return all labels shown or said, 'no gesture' last."""
        found = {v.expected for v in self.verdicts} | {v.said for v in self.verdicts}
        return sorted(found - {NO_GESTURE}) + ([NO_GESTURE] if NO_GESTURE in found else [])

    def figures(self, seed: int = 0) -> dict[str, Any]:
        """Return the figures as one flat record; shares are 0 to 1."""
        low, high = self.interval(seed)
        return {
            "clips": len(self.verdicts),
            "people": len(self.people),
            "right": self.right,
            "accuracy": self.right / len(self.verdicts),
            "accuracy_low": low,
            "accuracy_high": high,
            "interval": "people" if len(self.people) > 1 and self.right < len(self.verdicts) else "clips",
            "false_commands": self.false_commands,
        }


def evaluate(
    model: Taught,
    spoken: Sequence[str],
    clips: Sequence[Clip],
    progress: Callable[[str, int, int], None] | None = None,
) -> Evaluation:
    """Ask a model for clips that it was not taught.

    Args:
        model: Any.
        spoken: What it may answer with.
        clips: With labels; ``None``: a movement that is no gesture.
        progress: Called before each clip.

    Raises:
        InputError: If there is no clip.
    """
    if not clips:
        raise InputError("There is no clip to evaluate with.")
    may, verdicts = set(spoken), []
    for number, clip in enumerate(clips):
        if progress is not None:
            progress(str(clip.label), number, len(clips))
        said = answer(model, clip)
        expected = clip.label if clip.label is not None and clip.label in may else NO_GESTURE
        verdicts.append(Verdict(clip, expected, said.label or NO_GESTURE, said.confidence, said.reason))
    return Evaluation(tuple(verdicts))


__all__ = [
    "NO_GESTURE", "Estimate", "Evaluation", "Kind", "Verdict", "answer", "evaluate", "judge_of",
    "leave_one_out", "teach_base", "train",
]  # fmt: skip
