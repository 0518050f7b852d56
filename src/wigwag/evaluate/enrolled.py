"""What three showings by one person are worth when somebody else shows the gesture to a drone in flight.

Through rendered pixels and the pose network both times: one simulated person teaches before a camera that
stands still, as ``wigwag teach`` does; another, of other size, tempo and habits, shows the gestures to a
drone that hovers in gusts and follows them, among commands and movements that are none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wigwag.camera.playback import Playback
from wigwag.errors import InputError
from wigwag.evaluate.flight import Outcome, judge
from wigwag.evaluate.metrics import wilson_interval
from wigwag.evaluate.session import Session
from wigwag.evaluate.taught import judge_of
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot
from wigwag.pose.estimator import PoseEstimator
from wigwag.sim.camera import PERFORMING_M, SimulatedCameraConfig, SimulatedSource
from wigwag.sim.gestures import COMMANDS, DISTRACTORS, perform
from wigwag.sim.motion import Operator
from wigwag.sim.paint import Look
from wigwag.sim.person import Person
from wigwag.sim.script import Planner, Script, ScriptConfig, Shown
from wigwag.sim.world import World, WorldConfig
from wigwag.skeleton import Clip, Pose
from wigwag.stream.listener import listening
from wigwag.stream.models import Taught
from wigwag.teach.seeing import for_lessons, see
from wigwag.teach.student import Student
from wigwag.teach.teacher import LessonConfig, Stage, Teacher

HOVER_M = 4.0
Progress = Callable[[str, int, int], None]


def taught_by(student: Student, gesture: str, person: int, seed: int = 1, repetitions: int = 3) -> list[Clip]:
    """Let a simulated person show a gesture to a camera that stands still, with a countdown, and be judged.

    Raises:
        InputError: If fewer repetitions than wanted were good ones.
    """
    config = SimulatedCameraConfig(
        seed=seed, person=person, perform=(gesture,), engage=False, tripod=True, distance_m=PERFORMING_M
    )
    estimator, lesson = PoseEstimator(for_lessons()), LessonConfig(repetitions)
    teacher = Teacher(gesture, f"person {person}", judge_of(student, gesture), lesson)
    with Playback(SimulatedSource(config)) as camera:
        for frame in camera:
            if teacher.update(see(estimator, frame)).stage is Stage.DONE:
                return teacher.clips
    raise InputError(f"{gesture}: only {len(teacher.clips)} of {repetitions} repetitions were good ones.")


def plan_mixed(person: Person, counts: Sequence[tuple[str, int]], seed: int) -> Script:
    """Plan showings in random order, with standing and walking between.

    Args:
        person: Who shows them.
        counts: What, and how often; what is among ``DISTRACTORS`` is no command.
        seed: Of order, gaps and repetitions.
    """
    rng = np.random.default_rng([0xE47, seed])
    planner = Planner(ScriptConfig(engage=True), rng)
    planner.begin(person, seed)
    names = [name for name, count in counts for _ in range(count)]
    for place, index in enumerate(rng.permutation(len(names))):
        name = names[int(index)]
        motion = perform(name, person, [0xE47, seed, place])
        planner.act(motion, name, name not in DISTRACTORS, f"person {person.seed}")
        planner.gap()
    return planner.finish()


class _Deaf:
    """Hears nothing: what is heard is asked afterwards, of several models."""

    def update(self, pose: Pose | None) -> Gesture | None:
        return None

    def reset(self) -> None:
        return None


def shown_to_drone(
    person: int, counts: Sequence[tuple[str, int]], seed: int = 1, progress: Progress | None = None
) -> tuple[list[Pose], tuple[Shown, ...]]:
    """Fly before somebody who shows gestures, obeying none; return the movements that a listener would hear.

    Args:
        person: Who.
        counts: What they show, and how often.
        seed: Of the world and the order.
        progress: Called now and then.
    """
    who = Person.random(person)
    script = plan_mixed(who, counts, seed)
    operator = Operator(who, script, position_m=(HOVER_M, 0.0), seed=seed)
    world = World(WorldConfig(), seed, operator, Look.from_seed(who.seed, who.height_m))
    pilot = Pilot(PoseEstimator(), _Nobody(), world.vehicle, commands={})
    pilot.spotter = _Deaf()
    session = Session(world, pilot, script)
    frames = int(script.duration_s * world.config.rate_hz)
    for count, _ in enumerate(session.fly()):
        if progress is not None and count % 30 == 0:
            progress("", count, frames)
    return session.movements, script.shown


class _Nobody:
    """A recogniser that is never asked."""

    def recognise(self, clip: Clip) -> Gesture:
        return Gesture(None, 0.0)


@dataclass(frozen=True, slots=True)
class Heard:
    """What a model made of a stream."""

    right: dict[str, int]
    """How many of each label's showings were recognised."""
    shown: dict[str, int]
    wrong: int
    """Showings taken for another gesture."""
    false: int
    """Commands said while no command was shown, or once more."""

    def of(self, labels: Sequence[str]) -> tuple[int, int]:
        """Return how many showings of some labels were recognised, and how many there were."""
        return sum(self.right.get(n, 0) for n in labels), sum(self.shown.get(n, 0) for n in labels)


def heard(model: Taught, movements: Sequence[Pose], shown: Sequence[Shown], commands: Sequence[str]) -> Heard:
    """Let a model hear movements and hold what it says against what was shown.

    Args:
        model: Of any kind.
        movements: Levelled poses.
        shown: The truth.
        commands: What counts when it is said.
    """
    listener, events = listening(model), []
    for pose in movements:
        said = listener.update(pose)
        if said is not None and said.label in commands:
            events.append(said)
    truth = [replace(s, is_command=s.label in commands) for s in shown]
    judgement = judge(truth, events)
    right: dict[str, int] = {}
    counts: dict[str, int] = {}
    for showing, outcome, _ in judgement.showings:
        counts[showing.label] = counts.get(showing.label, 0) + 1
        right[showing.label] = right.get(showing.label, 0) + (outcome is Outcome.RECOGNISED)
    wrong = sum(outcome is Outcome.WRONG for _, outcome, _ in judgement.showings)
    return Heard(right, counts, wrong, len(judgement.false_events))


def measure(
    student: Student,
    gestures: Sequence[str],
    teacher: int,
    performer: int,
    *,
    performances: int = 20,
    commands_each: int = 2,
    others: int = 6,
    seed: int = 1,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Teach gestures by one person and have them shown by another.

    Args:
        student: Knows the demo's commands; learns the gestures.
        gestures: What is new to it.
        teacher: Number of the person who teaches.
        performer: Number of the person who is judged.
        performances: Of each new gesture.
        commands_each: Showings of each of the ten commands.
        others: Movements that are no command and that nobody taught.
        seed: Of world and order.
        progress: Called now and then.

    Returns:
        The record; shares are 0 to 1. ``commands_right_before`` is what the model said of the same poses
        before it learned.
    """
    before = student.copy()
    for gesture in gestures:
        student.enrol(gesture, taught_by(student, gesture, teacher, seed))
    distractors = [name for name in DISTRACTORS if name not in gestures]
    counts = [(g, performances) for g in gestures] + [(c, commands_each) for c in COMMANDS]
    counts += [(name, others // len(distractors) + (i < others % len(distractors))) for i, name in
               enumerate(distractors)]  # fmt: skip
    movements, shown = shown_to_drone(performer, counts, seed, progress)
    old = heard(before.model, movements, shown, COMMANDS)
    new = heard(student.model, movements, shown, (*COMMANDS, *gestures))
    right, total = new.of(gestures)
    low, high = wilson_interval(right, total)
    return {
        "kind": type(student.model).__name__,
        "gestures": list(gestures),
        "teacher": teacher,
        "performer": performer,
        "examples": 3,
        "shown": total,
        "right": right,
        "recall": right / total,
        "recall_low": low,
        "recall_high": high,
        "wrong": new.wrong,
        "false_commands": new.false,
        "others_shown": others,
        "commands_shown": new.of(COMMANDS)[1],
        "commands_right": new.of(COMMANDS)[0],
        "commands_right_before": old.of(COMMANDS)[0],
        "false_commands_before": old.false,
    }


__all__ = ["Heard", "heard", "measure", "plan_mixed", "shown_to_drone", "taught_by"]
