import numpy as np
import pytest

from tests.datasets.skeletons import SHARED, needs
from tests.evaluate.stream.people import RATE_HZ, swing
from wigwag.datasets.msrc12 import load_recordings
from wigwag.datasets.recording import Mark, Recording
from wigwag.evaluate.stream.assembly import Body, Shown, assemble
from wigwag.evaluate.stream.points import EXAMPLES_EACH, PointFold, point_folds, point_lesson, with_movements

PEOPLE = ("s1", "s3", "s5")


def marked(subject: str, trials: int = 8) -> Recording:
    """A stream with action points at the top of each swing, where the arm is up."""
    clips = [swing(subject, trial=t) for t in range(1, trials + 1)]
    made = assemble(Body.of(clips, RATE_HZ), [[Shown(c, "utd:a1", "g1")] for c in clips], [], seed=0)
    points = tuple(Mark("g1", (m.onset_ns + m.end_ns) // 2, (m.onset_ns + m.end_ns) // 2) for m in made.marks)
    return Recording(made.stream, points, made.marks)


def test_a_movement_is_found_around_its_action_point() -> None:
    recording = marked("s1")
    found = with_movements(recording)
    assert len(found.marks) == len(recording.marks)
    for mark, truth, point in zip(found.marks, recording.scenes, recording.marks, strict=True):
        assert mark.point_ns == point.onset_ns
        assert mark.onset_ns * 1e-9 == pytest.approx(truth.onset_ns * 1e-9, abs=0.25)
        assert mark.point_ns <= mark.end_ns <= truth.end_ns + 0.1e9, (
            "it ends where the arm comes to rest, up or down"
        )


def test_a_movement_does_not_reach_beyond_its_neighbours() -> None:
    recording = marked("s1")
    crowded = sorted(
        [m.onset_ns for m in recording.marks] + [m.onset_ns + 5 * 10**8 for m in recording.marks]
    )
    found = with_movements(Recording(recording.stream, tuple(Mark("g1", p, p) for p in crowded)))
    for number, mark in enumerate(found.marks):
        assert mark.onset_ns <= crowded[number] <= mark.end_ns
        if number:
            assert mark.onset_ns >= crowded[number - 1]
        if number + 1 < len(crowded):
            assert mark.end_ns <= crowded[number + 1]


def test_nothing_to_find_around() -> None:
    bare = Recording(marked("s1").stream)
    assert with_movements(bare) is bare


def test_people_are_left_out_in_turn() -> None:
    folds = point_folds([f"msrc12_p{i:02d}" for i in range(3, 31, 3)])
    assert len(folds) == 5
    assert sorted(p for f in folds for p in f.judged) == [f"msrc12_p{i:02d}" for i in range(3, 31, 3)]
    assert all(not set(f.taught) & set(f.judged) and len(f.taught) == 8 for f in folds)
    assert len(point_folds(["a", "b"])) == 2


def test_a_lesson_holds_its_people_alone_and_not_too_much_of_one() -> None:
    recordings = [marked(person) for person in PEOPLE]
    lesson = point_lesson(recordings, PointFold("f", PEOPLE[:2], PEOPLE[2:]))
    assert {c.subject for c in lesson.gestures} == {r.stream.subject for r in lesson.streams} == {"s1", "s3"}
    assert len(lesson.gestures) == 2 * EXAMPLES_EACH
    assert lesson.vocabulary == ("g1",)
    assert all(m.point_ns is not None for r in lesson.streams for m in r.marks)
    np.testing.assert_array_equal([c.stamps_ns[0] for c in lesson.gestures], 0)


@needs("msrc12")
def test_recorded_movements_are_of_a_persons_length() -> None:
    recordings = [
        with_movements(r) for r in load_recordings(SHARED / "msrc12", labels=("g1", "g6")).recordings
    ]
    lengths = [m.duration_s for r in recordings for m in r.marks]
    assert 0.5 < np.median(lengths) < 2.5
    assert max(lengths) <= 5.0
