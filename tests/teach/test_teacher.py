"""A lesson step by step, over sights and their stamps alone."""

from dataclasses import replace

import pytest

from tests.teach.people import performed, sights
from wigwag.errors import InputError
from wigwag.teach.advice import Advice, Fault
from wigwag.teach.teacher import Coaching, LessonConfig, Sight, Stage, Teacher


def watched(teacher: Teacher, some: list[Sight]) -> list[Coaching]:
    return [teacher.update(sight) for sight in some]


def stages(said: list[Coaching]) -> list[str]:
    found: list[str] = []
    for coaching in said:
        if not found or found[-1] != coaching.stage.value:
            found.append(coaching.stage.value)
    return found


def test_three_repetitions_are_counted_down_watched_and_taken():
    session = performed(4, ("goalpost",), 4)
    teacher = Teacher("mine", "ann")
    said = watched(teacher, sights(session))
    once = ["countdown", "show", "moving"]
    assert stages(said) == ["still", *once, "still", *once, "still", *once, "done"]
    assert sorted({c.count for c in said if c.count is not None}) == [1, 2, 3]
    assert [clip.label for clip in teacher.clips] == ["mine"] * 3
    assert {clip.subject for clip in teacher.clips} == {"ann"}
    for clip, shown in zip(teacher.clips, session.shown, strict=False):
        assert abs(clip.stamps_ns[0] * 1e-9 - shown.start_s) < 0.5
        assert abs(clip.stamps_ns[-1] * 1e-9 - shown.end_s) < 0.8
    taken = [c for c in said if c.clip is not None]
    assert [c.taken for c in taken] == [1, 2, 3]
    assert all(c.stage is Stage.DONE for c in said[said.index(taken[-1]) :])


def test_a_recording_is_taken_without_a_countdown():
    session = performed(4, ("goalpost",), 3, 1.5)
    teacher = Teacher("mine", "ann", config=LessonConfig(countdown_s=0.0))
    watched(teacher, sights(session))
    assert len(teacher.clips) == 3


def test_who_moves_in_the_countdown_is_told_to_wait():
    session = performed(4, ("goalpost",), 3, 2.0)
    teacher = Teacher("mine", "ann")
    said = watched(teacher, sights(session))
    early = [c for c in said if c.advice is not None and c.advice.fault is Fault.EARLY]
    assert early
    assert early[0].stage is Stage.STILL
    assert len(teacher.clips) < 3


def test_who_is_not_seen_whole_is_told_what_is_missing_and_nothing_begins():
    seen = sights(performed(4, ("goalpost",), 1))
    teacher = Teacher("mine", "ann")
    said = watched(teacher, [replace(s, out_of_view=("feet",)) for s in seen])
    assert stages(said) == ["look"]
    assert said[0].advice.text.startswith("feet out of view")
    assert stages(watched(Teacher("mine", "ann"), [Sight(s.stamp_ns, None, (), "dark") for s in seen])) == [
        "look"
    ]


def moving_at(some: list[Sight]) -> int:
    return next(i for i, c in enumerate(watched(Teacher("x", "ann"), some)) if c.stage is Stage.MOVING)


def test_who_is_lost_while_showing_has_to_show_it_again():
    seen = sights(performed(4, ("goalpost",), 2))
    first = moving_at(seen)
    holed = [Sight(s.stamp_ns, None) if first + 10 <= i < first + 30 else s for i, s in enumerate(seen)]
    teacher = Teacher("mine", "ann", config=LessonConfig(repetitions=1))
    said = watched(teacher, holed)
    refused = [c.advice.fault for c in said if c.refused]
    assert refused[0] is Fault.LOST
    assert said[-1].stage is Stage.DONE, "the second showing is taken"


def test_feet_that_leave_the_picture_meanwhile_are_named():
    seen = sights(performed(4, ("goalpost",), 1))
    first = moving_at(seen)
    cut = [replace(s, out_of_view=("feet",)) if i > first else s for i, s in enumerate(seen)]
    refused = [c for c in watched(Teacher("mine", "ann"), cut) if c.refused]
    assert refused[0].advice.text == "feet out of view meanwhile: step back, or tilt the camera"


def test_what_the_judge_says_is_handed_on_and_the_repetition_is_not_taken():
    seen = sights(performed(4, ("goalpost",), 2))
    asked: list[int] = []

    def judge(clip, before):
        asked.append(len(before))
        return Advice(Fault.TOO_LIKE, 'too like "land"') if len(asked) == 1 else None

    teacher = Teacher("mine", "ann", judge)
    said = watched(teacher, seen)
    refused = [c for c in said if c.refused]
    assert [c.advice.text for c in refused] == ['too like "land"']
    assert (asked, len(teacher.clips)) == ([0, 0], 1)
    after = said[said.index(refused[0]) + 5]
    assert after.advice.text == 'too like "land"', "it stays to be read until the next movement"


def test_arms_that_stay_up_are_told_to_come_down():
    seen = sights(performed(4, ("goalpost",), 1))
    first = moving_at(seen)
    up = max(range(first, first + 40), key=lambda i: -seen[i].pose.joints[5, 1])
    held = seen[: up + 1] + [
        Sight(s.stamp_ns, replace(seen[up].pose, stamp_ns=s.stamp_ns)) for s in seen[up + 1 : up + 240]
    ]
    said = watched(Teacher("mine", "ann"), held)
    faults = [c.advice.fault for c in said if c.advice is not None]
    assert Fault.ARMS_UP in faults
    assert Fault.TOO_LONG in faults


def test_sights_out_of_order_change_nothing():
    seen = sights(performed(4, ("goalpost",), 1))[:40]
    teacher = Teacher("mine", "ann")
    watched(teacher, seen)
    assert teacher.update(seen[3]).stage is teacher.update(seen[3]).stage


@pytest.mark.parametrize("settings", [{"repetitions": 0}, {"countdown_s": -1.0}, {"still_s": float("nan")}])
def test_wrong_settings_are_refused(settings):
    with pytest.raises(InputError, match="but got"):
        LessonConfig(**settings)


def test_a_gesture_has_a_name():
    with pytest.raises(InputError, match="needs a name"):
        Teacher(" ", "ann")
