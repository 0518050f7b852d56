"""What is taught: gestures with their names, everything else without, by people who are never shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from wigwag.evaluate.lessons import IN_STREAMS, LessonConfig, lessons, teach, teach_in_streams
from wigwag.fly.values import Command
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer
from wigwag.sim.clips import Session, cut, training_sessions
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamModel

CONFIG = LessonConfig(people=2, repetitions=1, refused_per_person=5)


@pytest.fixture(scope="module")
def sessions() -> list[Session]:
    return training_sessions(CONFIG.people, CONFIG.repetitions, CONFIG.seed)


def test_every_person_teaches_every_command_and_what_is_none(sessions: list[Session]) -> None:
    taught = lessons(sessions, CONFIG)
    people = {clip.subject for clip in taught}
    assert len(people) == CONFIG.people
    commands = {command.value for command in Command}
    for session in sessions:
        labels = {clip.label for clip in taught if clip.subject == session.stream.subject}
        assert labels == {None, *(shown.label for shown in session.shown)}
        assert labels > commands, "other gestures are taught by name too, beside what is none"


def test_training_people_are_never_the_demos(sessions: list[Session]) -> None:
    """``wigwag demo --seed`` ends below a million; training people begin there."""
    for session in sessions:
        assert int(str(session.stream.subject).split()[-1]) >= 1_000_000


def test_wrong_proposals_are_taught_as_nothing_and_not_too_many(sessions: list[Session]) -> None:
    plain = [clip for session in sessions for clip in cut(session, seed=CONFIG.seed)]
    taught = lessons(sessions, CONFIG)
    refused = [clip for clip in taught if clip.name.startswith("no gesture of")]
    assert len(taught) == len(plain) + len(refused)
    assert 0 < len(refused) <= CONFIG.people * CONFIG.refused_per_person
    assert {clip.label for clip in refused} == {None}
    for session in sessions:
        commands = [s for s in session.shown if s.is_command]
        for clip in refused:
            if clip.subject != session.stream.subject:
                continue
            start, end = clip.stamps_ns[0] * 1e-9 + 0.1, clip.stamps_ns[-1] * 1e-9 - 0.1
            for shown in commands:
                inside = min(end, shown.end_s) - max(start, shown.start_s)
                union = max(end, shown.end_s) - min(start, shown.start_s)
                assert inside / union <= 0.6


def test_the_same_seed_teaches_the_same(sessions: list[Session]) -> None:
    one, again = lessons(sessions, CONFIG), lessons(sessions, CONFIG)
    assert [clip.name for clip in one] == [clip.name for clip in again]
    for a, b in zip(one, again, strict=True):
        np.testing.assert_array_equal(a.joints, b.joints)


@pytest.mark.parametrize(("name", "kind"), [("heavy", HeavyRecognizer), ("encoded", EncodedRecognizer)])
def test_what_is_taught_can_be_loaded_and_used(
    sessions: list[Session], tmp_path: Path, name: str, kind: type[HeavyRecognizer | EncodedRecognizer]
) -> None:
    wanted = ("stop", "up")
    clips: list[Clip] = [clip for clip in lessons(sessions, CONFIG) if clip.label in wanted]
    model = tmp_path / "demo.wigwag"
    assert teach(clips, model, name) == len(clips)
    loaded = kind.load(model)
    assert tuple(loaded.classes_) == wanted
    assert set(loaded.predict(clips[:2])) <= set(wanted)


def test_a_stream_model_is_taught_commands_and_keeps_other_gestures_silent(
    sessions: list[Session], tmp_path: Path
) -> None:
    model, commands = tmp_path / "stream.wigwag", {command.value for command in Command}
    shown = [s for session in sessions for s in session.shown]
    assert teach_in_streams(sessions, model, "stream", CONFIG) == len(shown)
    loaded = IN_STREAMS["stream"].load(model)
    assert isinstance(loaded, StreamModel)
    assert set(loaded.config.commands or ()) == {s.label for s in shown if s.is_command} <= commands
    assert set(loaded.prefixes.labels) == {s.label for s in shown}
    stream, heard = loaded.stream(), sessions[0].stream
    said = [
        gesture.label
        for joints, stamp_ns in zip(heard.joints, heard.stamps_ns, strict=True)
        if (gesture := stream.update(Pose(joints, np.ones(13), int(stamp_ns)))) is not None
    ]
    assert set(said) - {None} <= commands
