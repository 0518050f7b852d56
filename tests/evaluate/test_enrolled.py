"""What three showings by one person are worth when another shows the gesture, held to the promise.

Poses come from the joints with the noise of camera and network; ``wigwag benchmark teach`` does it on pixels.
"""

import numpy as np

from tests.teach.people import GESTURES, clips_of, model, sights
from wigwag.evaluate.enrolled import heard, plan_mixed
from wigwag.sim.clips import SensorConfig, Session, watch
from wigwag.sim.gestures import DISTRACTORS
from wigwag.sim.person import Person
from wigwag.skeleton import Pose
from wigwag.teach.student import KernelStudent

NEW = ("goalpost", "crane")
TEACHER, PERFORMER = 11, 12


def mixed(counts: list[tuple[str, int]]) -> Session:
    who = Person.random(PERFORMER)
    return watch(who, plan_mixed(who, counts, 3), SensorConfig(), np.random.default_rng([9, PERFORMER]))


def movements(session: Session) -> list[Pose]:
    return [sight.pose for sight in sights(session)]


def test_a_plan_has_everything_that_was_asked_for_in_random_order():
    script = plan_mixed(Person.random(3), [("hug", 4), ("up", 2), ("clap", 1)], 5)
    labels = [shown.label for shown in script.shown]
    assert sorted(labels) == ["clap", "hug", "hug", "hug", "hug", "up", "up"]
    assert labels != sorted(labels)
    assert [s.label for s in script.shown if not s.is_command] == ["clap"]
    assert script.engaged_s is not None


def test_two_gestures_taught_by_one_person_are_recognised_from_another_and_nothing_is_lost():
    counts = [(g, 20) for g in NEW] + [(g, 4) for g in GESTURES] + [(g, 1) for g in DISTRACTORS]
    session = mixed(counts)
    student, before = KernelStudent(model()).copy(), KernelStudent(model())
    for gesture in NEW:
        student.enrol(gesture, clips_of(TEACHER, (gesture,), 3))
    old = heard(before.model, movements(session), session.shown, GESTURES)
    new = heard(student.model, movements(session), session.shown, (*GESTURES, *NEW))
    right, shown = new.of(NEW)
    assert shown == 40
    assert right >= 0.95 * shown
    assert (new.false, new.wrong) == (0, 0)
    assert new.of(GESTURES)[0] >= old.of(GESTURES)[0] >= 14


def test_what_nobody_taught_is_counted_as_false_where_it_is_said():
    session = mixed([("up", 3), ("land", 3)])
    said = heard(model(), movements(session), session.shown, ("up",))
    assert said.of(("up",)) == (3, 3)
    assert said.false == 0
    renamed = KernelStudent(model()).copy().rename("land", "mine")
    said = heard(renamed.model, movements(session), session.shown, ("up", "mine"))
    assert (said.of(("up",)), said.false) == ((3, 3), 3)
