"""Systems that are perfect, deaf, hasty or broken: what the benchmark says of them."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.datasets.trees import tree
from tests.evaluate.stream.people import swing, walk
from wigwag.datasets.recording import Mark, Recording
from wigwag.datasets.utd_mhad import ACTIONS, load_skeletons
from wigwag.errors import DataError, InputError
from wigwag.evaluate.stream import systems
from wigwag.evaluate.stream.assembly import Shown
from wigwag.evaluate.stream.lessons import Lesson, folds, lesson, own_lesson, person_stream
from wigwag.evaluate.stream.material import TWINS, Material, read_material, shown_between, taught
from wigwag.evaluate.stream.plan import NEGATIVES, StreamBenchmarkConfig
from wigwag.evaluate.stream.run import run_system
from wigwag.evaluate.stream.watch import figures, watch
from wigwag.gesture import Gesture
from wigwag.skeleton import Clip, Landmark, Pose

CLASSES = ("a1", "a6")


def material() -> Material:
    """Eight people swing one arm or the other; six people walk, two of them without end."""
    utd = [
        swing(f"s{p}", label, trial=t, size=0.9 + 0.03 * p)
        for p in range(1, 9)
        for label in CLASSES
        for t in (1, 2, 3)
    ]
    utd += [replace(walk(f"s{p}"), label="a22", name=f"a22_s{p}_t1") for p in range(1, 9)]
    people = [f"utkinect_s{i:02d}" for i in range(1, 7)]
    everyday = [Shown(walk(person, size=1.0 + 0.02 * i), "utkinect:carry") for i, person in enumerate(people)]
    streams = {
        "utkinect": [
            Recording(s.clip, (), (Mark("utkinect:carry", 0, int(s.clip.stamps_ns[-1])),)) for s in everyday
        ]
    }
    return Material(utd, everyday, streams)


class Arms:
    """Names a raised arm as soon as it is up, and again only after it was down."""

    height_m = 0.15
    """How far above the hips the wrist is then."""

    def __init__(self, names: tuple[str, str] = ("a6", "a1")) -> None:
        self.names = names
        self.reset()

    def reset(self) -> None:
        self.up_since: int | None = None

    def update(self, pose: Pose) -> Gesture | None:
        hips = pose.hip_center[1]
        heights = [hips - pose.joints[j, 1] for j in (Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST)]
        if max(heights) < self.height_m:
            self.up_since = None
            return None
        if self.up_since is not None:
            return None
        self.up_since = pose.stamp_ns
        name = self.names[int(np.argmax(heights))]
        return Gesture(name, 1.0, pose.stamp_ns - 3 * 10**8, pose.stamp_ns + 6 * 10**8, pose.stamp_ns)


class Broken(Arms):
    """Fails whenever time runs back."""

    last = -1

    def update(self, pose: Pose) -> Gesture | None:
        if pose.stamp_ns < self.last:
            raise RuntimeError("time")
        self.last = pose.stamp_ns
        return super().update(pose)

    def reset(self) -> None:
        self.last = -1
        super().reset()


class Deaf(Arms):
    def update(self, pose: Pose) -> Gesture | None:
        return None


@pytest.fixture(autouse=True)
def two_classes(monkeypatch: pytest.MonkeyPatch) -> list[Lesson]:
    """The vocabulary "6" has two classes here; lessons are kept to be looked at."""
    from wigwag.evaluate import protocols

    lessons: list[Lesson] = []

    def teaching(make: Callable[[], Any]) -> Callable[[Lesson], Any]:
        def teach(given: Lesson) -> Any:
            lessons.append(given)
            return make()

        return teach

    monkeypatch.setitem(protocols.CLASS_SETS, "6", CLASSES)
    for name, make in (("arms", Arms), ("deaf", Deaf), ("broken", Broken)):
        monkeypatch.setitem(systems.SYSTEMS, name, teaching(make))
    monkeypatch.setattr("wigwag.evaluate.stream.plan.SIMULATED_PEOPLE", 4)
    return lessons


def run(system: str, *shows: str, **settings: Any) -> dict[str, dict[str, Any]]:
    config = StreamBenchmarkConfig("6", rounds=settings.pop("rounds", 2), lesson_rounds=1, **settings)
    rows = run_system(material(), system, shows, config)  # type: ignore[arg-type]
    return {row["data"] + (row["corrupt"] or ""): row for row in rows}


def test_a_good_system_gets_good_figures() -> None:
    row = run("arms", "utd-mhad")["utd-mhad"]
    assert row["events"] == 4 * 2 * 3 * 2, "people, classes, trials, rounds"
    assert row["detection_rate"] == row["event_f1"] == 1.0
    assert row["false_commands"] == row["false_positive_rate"] == 0
    assert row["repeats"] == 2.0
    assert row["hours_distinct"] == pytest.approx(row["hours"] / 2)
    assert row["false_commands_ci95"][1] == pytest.approx(3.689 / row["hours_distinct"], rel=1e-3)
    assert row["decided_before_end"] == 1.0
    assert 0.9 < row["detection_rate_ci95"][0] < row["detection_rate_ci95"][1] == 1.0
    assert 0 < row["share_seen_median"] < 0.7
    assert row["delay_from_onset_s_median"] > 0 > row["delay_from_end_s_median"]
    assert (row["judged"], row["people"]) == ("s2 s4 s6 s8", 4)


def test_silence_is_safe_and_useless() -> None:
    row = run("deaf", "utd-mhad")["utd-mhad"]
    assert (row["event_f1"], row["detection_rate"], row["false_commands"]) == (0.0, 0.0, 0)
    assert row["delay_from_end_s_median"] is None


def test_wrong_names_are_false_commands_and_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(systems.SYSTEMS, "arms", lambda _: Arms(("a1", "a6")))
    row = run("arms", "utd-mhad", rounds=1)["utd-mhad"]
    assert (row["event_f1"], row["false_positive_rate"]) == (0.0, 1.0)
    assert sorted(row["false_commands_of"]) == ["a1 on a6: 12", "a6 on a1: 12"]


def test_nobody_stands_on_both_sides(two_classes: list[Lesson]) -> None:
    for inner in (False, True):
        two_classes.clear()
        rows = run("deaf", "utd-mhad", "utkinect", "simulated", inner=inner, rounds=1)
        for fold, given in zip(folds(material(), inner), two_classes, strict=True):
            clips = (*given.gestures, *given.others, *given.background, *given.deliberate)
            people = {c.subject for c in clips}
            people |= {r.stream.subject for r in given.streams}
            assert not people & {*fold.judged, *fold.everyday_judged}
            assert {p for p in people if str(p).startswith("s")} == set(fold.taught)
        if inner:
            assert rows["utd-mhad"]["judged"] == "s1 s3 s5 s7"
            assert not {*rows["utkinect"]["judged"].split()} & {f"utkinect_s0{i}" for i in (2, 4, 6)}


def test_everyday_streams_have_no_gestures_and_are_summed() -> None:
    rows = run("arms", "utkinect", "simulated")
    assert rows["negatives"]["hours"] == pytest.approx(rows["utkinect"]["hours"] + rows["simulated"]["hours"])
    for row in rows.values():
        assert (row["events"], row["event_f1"], row["detection_rate"], row["jaccard"]) == (
            0,
            None,
            None,
            None,
        )
    assert rows["utkinect"]["false_commands"] == 0
    assert rows["simulated"]["false_commands"] > 0, "arms go up there too"
    assert rows["simulated"]["false_commands_of"][0].startswith("a"), "and it is said at what"


def test_the_same_movement_by_another_name_is_counted_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    before = run("arms", "simulated")["simulated"]
    names = {s.partition(" on ")[2].partition(":")[0:2] for s in before["false_commands_of"]}
    assert names
    monkeypatch.setitem(TWINS, "simulated:reach_up", "a1")
    after = run("arms", "simulated")["simulated"]
    assert after["twins"] > before["twins"]
    assert after["false_commands"] == before["false_commands"] - (after["twins"] - before["twins"])
    assert after["false_commands_per_hour_with_twins"] == pytest.approx(
        before["false_commands_per_hour_with_twins"]
    )


def test_own_examples_are_not_judged(two_classes: list[Lesson]) -> None:
    row = run("arms", "own", rounds=1)["own"]
    assert row["events"] == 4 * 2 * 2, "of three trials one is the example"
    assert row["judged"] == "s2 s4 s6 s8"
    for given in two_classes:
        assert sorted(c.label for c in given.gestures) == ["a1", "a6"]
        assert not any(r.marks for r in given.streams), "nobody else shows them"
    two_classes.clear()
    run("arms", "own+others", rounds=1)
    assert all(len(given.gestures) == 4 * 2 * 3 + 2 for given in two_classes)


def test_faults_are_counted_and_exceptions_do_not_stop_it() -> None:
    rows = run("broken", "utd-mhad", corrupt=("jitter", "gap", "missing"), rounds=1)
    assert rows["utd-mhadjitter"]["exceptions"] > 0
    assert rows["utd-mhadgap"]["exceptions"] == rows["utd-mhadmissing"]["exceptions"] == 0
    for kind in ("jitter", "gap", "missing"):
        row = rows[f"utd-mhad{kind}"]
        assert row["f1_lost"] == pytest.approx(rows["utd-mhad"]["event_f1"] - row["event_f1"])
    with pytest.raises(RuntimeError, match="time"):
        stream = person_stream(material(), "s2", CLASSES, [], [0])
        poses = [Pose(np.zeros((13, 3)), np.ones(13), s) for s in (5, 3)]
        watch(Broken(), stream, poses)


def test_a_record_is_there_before_the_next_is_begun() -> None:
    steps: list[str] = []
    config = StreamBenchmarkConfig("6", rounds=1, lesson_rounds=1, corrupt=("nan",))
    for row in run_system(
        material(), "arms", ["utd-mhad", "utkinect"], config, lambda what, done, total: steps.append(what)
    ):
        steps.append(f"{row['data']} {row['corrupt']}")
    first = steps.index("utd-mhad None")
    assert steps[first + 1] == "utd-mhad nan"
    assert all(step.startswith("utkinect") for step in steps[first + 2 :])


def test_what_is_not_there_is_said() -> None:
    with pytest.raises(DataError, match="precog: nothing was read that could be shown"):
        run("deaf", "precog")
    with pytest.raises(InputError, match=r"no system 'oracle'\. Available systems: stream, "):
        run("oracle", "utd-mhad")
    with pytest.raises(InputError, match="rounds must be 1 or more"):
        StreamBenchmarkConfig(rounds=0)
    with pytest.raises(InputError, match="no corruption"):
        StreamBenchmarkConfig(corrupt=("fog",))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="--vocabulary must be one of 27, 6, 7"):
        run_system(material(), "deaf", ["utd-mhad"], StreamBenchmarkConfig("5"))
    with pytest.raises(DataError, match="no recording of a1, a6 by s9"):
        person_stream(material(), "s9", CLASSES, [], [0])


def test_action_points_are_judged_by_their_moment() -> None:
    from tests.evaluate.stream.test_points import marked

    given = material()
    for i in range(3, 31, 3):
        recording = marked("s1", trials=3)
        stream = replace(recording.stream, subject=f"msrc12_p{i:02d}", name=f"P1_1_1_p{i:02d}")
        given.msrc12.append(replace(recording, stream=stream))
    config = StreamBenchmarkConfig("6", rounds=1)

    class AtTheTop(Arms):
        height_m = 0.45

        def update(self, pose: Pose) -> Gesture | None:
            said = super().update(pose)
            return None if said is None else replace(said, label="g1")

    systems.SYSTEMS["arms"] = lambda _: AtTheTop()
    rows = {row["data"]: row for row in run_system(given, "arms", ["msrc12"], config)}
    assert rows["msrc12"]["people"] == 10
    assert rows["msrc12, judged only"]["people"] == 5
    assert rows["msrc12"]["events"] == 30
    assert rows["msrc12"]["event_f1"] is None
    assert [said.partition(":")[0] for said in rows["msrc12"]["action_point_f1_of"]] == [
        f"fold {number}" for number in range(1, 6)
    ]
    assert 0.5 < rows["msrc12"]["action_point_f1"] <= 1
    assert rows["msrc12"]["false_positive_rate"] == pytest.approx(1 - rows["msrc12"]["detection_rate"])


def test_figures_of_fewer_repeats_are_less_sure() -> None:
    session = watch(Deaf(), person_stream(material(), "s2", CLASSES, [], [0]))
    widths = [figures([session] * 4, repeats)["false_commands_ci95"][1] for repeats in (1, 2, 4)]
    assert widths[0] < widths[1] < widths[2]


def test_seated_movements_do_not_stand_between_where_getting_up_is_a_gesture() -> None:
    seated = [
        Shown(walk("utkinect_s01"), f"utkinect:{name}") for name in ("sitDown", "standUp", "throw", "carry")
    ]
    given = Material([], seated)
    assert [s.source for s in shown_between(given, ("a1",))] == [s.source for s in seated]
    assert [s.source for s in shown_between(given, ("a24",))] == ["utkinect:throw", "utkinect:carry"]
    assert [s.source for s in shown_between(given, ("a5",))] == [
        s.source for s in (seated[0], seated[1], seated[3])
    ]


def test_everyday_sets_take_turns_and_none_is_shown_twice_too_soon() -> None:
    given = material()
    few = [Shown(walk("precog_s02"), "precog"), Shown(walk("precog_s04"), "precog")]
    recording = person_stream(given, "s2", CLASSES, [*given.everyday, *few], [0])
    counts = Counter(scene.label.partition(":")[0] for scene in recording.scenes)
    assert len(recording.scenes) == 6, "one before each gesture"
    assert counts == {"utkinect": 2, "precog": 2, "utd": 2}


def test_sitting_down_comes_before_standing_up() -> None:
    utd = [swing("s2", label, trial=t) for label in ("a24", "a25", "a1") for t in (1, 2)]
    recording = person_stream(Material(utd), "s2", ("a24", "a25", "a1"), [], [3])
    labels = [m.label for m in recording.marks]
    assert sorted(labels) == ["a1", "a1", "a24", "a24", "a25", "a25"]
    assert all(labels[i + 1] == "a24" for i, label in enumerate(labels) if label == "a25")


def test_who_may_teach() -> None:
    assert [taught(p) for p in ("utkinect_s01", "utkinect_s02", "precog_s11", "precog_s12")] == [
        True,
        False,
    ] * 2
    assert [taught(p) for p in ("msrc12_p06", "msrc12_p09")] == [True, False]
    assert set(NEGATIVES) == {"utkinect", "precog", "msrc12-negative", "simulated"}


def test_background_holds_nothing_that_is_a_gesture_by_another_name() -> None:
    given = lesson(material(), folds(material(), False)[0], ("a1", "a3"), rounds=1)
    simulated = [c for c in given.background if str(c.subject).startswith("person")]
    everything = lesson(material(), folds(material(), False)[0], ("a1", "a6"), rounds=1)
    whole = [c for c in everything.background if str(c.subject).startswith("person")]
    assert len(whole) == 4
    assert len(simulated) > 4, "waves are cut out of it: a3 waves"
    assert sum(len(c) for c in simulated) < sum(len(c) for c in whole)
    made, left = own_lesson(material(), folds(material(), False)[0], CLASSES, "s2", trial=9)
    assert [c.name for c in made.gestures] == ["a1_s2_t1", "a6_s2_t1"], "the first, where there are fewer"
    assert len(left) == 4


def test_deliberate_movement_that_is_no_command_is_of_people_who_may_teach() -> None:
    everyone = material()
    for number in (3, 6, 12):
        for gesture in ("g2", "g4"):
            name = f"msrc12_p{number:02}"
            stream = replace(walk(name, 4.0), name=f"{name} {gesture}")
            scene = Mark(f"msrc12:{gesture}", 0, int(stream.stamps_ns[-1]))
            everyone.streams.setdefault("msrc12", []).append(Recording(stream, (), (scene,)))
    fold = folds(everyone, False)[0]
    ducking = [c.name for c in lesson(everyone, fold, ("a1", "a6"), rounds=1).deliberate]
    assert ducking == ["msrc12_p06 g2", "msrc12_p06 g4", "msrc12_p12 g2", "msrc12_p12 g4"]
    squatting = [c.name for c in lesson(everyone, fold, ("a1", "a27"), rounds=1).deliberate]
    assert squatting == ["msrc12_p06 g4", "msrc12_p12 g4"], "who ducks squats: a27"


def test_reading_takes_what_is_there(tmp_path: Path) -> None:
    tree(tmp_path / "utd_mhad", (1, 6), (1, 2), (1,))
    given = read_material(tmp_path)
    assert (len(given.utd), given.everyday, given.streams) == (4, [], {})
    assert all(isinstance(c, Clip) for c in given.utd)
    with pytest.raises(DataError):
        read_material(tmp_path / "nowhere")
    assert len(load_skeletons(tmp_path / "utd_mhad").clips) == 4
    assert "a1" in ACTIONS
