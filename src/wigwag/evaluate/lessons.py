"""What the demo's recogniser is taught: training people only, never the person who is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from wigwag.recognise import EncodedRecognizer, HeavyRecognizer, KernelRecognizer
from wigwag.sim.clips import Session, cut, training_sessions
from wigwag.skeleton import Clip
from wigwag.stream.gesture_stream import StreamConfig, StreamModel
from wigwag.stream.segment import Segment
from wigwag.stream.spot import SpotConfig, background
from wigwag.stream.teach import teach_stream
from wigwag.stream.truth import LabelledStream, Showing

Teachable = HeavyRecognizer | EncodedRecognizer | KernelRecognizer

RECOGNISERS: dict[str, type[HeavyRecognizer] | type[EncodedRecognizer] | type[KernelRecognizer]] = {
    "kernel": KernelRecognizer,
    "heavy": HeavyRecognizer,
    "encoded": EncodedRecognizer,
}

InStreams = StreamModel | Teachable

IN_STREAMS: dict[
    str, type[StreamModel] | type[HeavyRecognizer] | type[EncodedRecognizer] | type[KernelRecognizer]
]
IN_STREAMS = {**RECOGNISERS, "stream": StreamModel}
"""What hears a stream, by the recogniser's name."""

_IN_FLIGHT: dict[str, dict[str, Any]] = {"kernel": {"origin": "drift", "preset": "fast", "copies": 1}}
"""Settings for a camera that moves, and for teaching while the user waits. On recorded people of the training
side, one left out in turn, the coarser sequences are as good as the finer ones (75 and 74 of 80 commands in
streams through pixels, 96 and 96 of 96 one by one). The paper's recognisers fly with their defaults."""


@dataclass(frozen=True, slots=True)
class LessonConfig:
    """How much is taught."""

    people: int = 8
    repetitions: int = 2
    refused_per_person: int = 20
    """Clips a person of what the spotter would propose though it is no gesture."""
    seed: int = 0


def lessons(sessions: Sequence[Session], config: LessonConfig, spot: SpotConfig | None = None) -> list[Clip]:
    """Cut training people's sessions into clips: commands, other gestures by name, and what is none.

    Args:
        sessions: What a camera delivers of training people, with the truth about it.
        config: How much of what is no gesture is taken.
        spot: The spotter's settings, whose wrong proposals are taught as background.
    """
    rng = np.random.default_rng([0x7EAC, config.seed])
    clips = []
    for session in sessions:
        clips += cut(session, seed=config.seed, name_others=True)
        truth = [Segment(round(s.start_s * 1e9), round(s.end_s * 1e9)) for s in session.shown]
        refused = background(session.stream, truth, spot)
        some = rng.permutation(len(refused))[: config.refused_per_person]
        clips += [replace(refused[int(i)], label=None) for i in some]
    return clips


def warm_up() -> None:
    """Compile the kernels of world and lifting into the cache: whoever needs them next only loads them."""
    from wigwag.pose.lift import Lifter
    from wigwag.sim.motion import Operator
    from wigwag.sim.person import Person
    from wigwag.sim.script import plan_session
    from wigwag.sim.world import World, WorldConfig

    person = Person.random(0)
    world = World(WorldConfig(), 0, Operator(person, plan_session(person, 0)))
    for _ in range(3):
        frame = world.step()
    if frame.depth_mm is not None:
        Lifter()(np.full((13, 2), 200.0), np.ones(13), frame.depth_mm, frame.intrinsics)


def usual(recognizer: str) -> LessonConfig:
    """Return how much the demo teaches: streams need many people, each of whom need not show a gesture twice.

    By eight people who show everything twice 117 of 120 commands of further simulated people were heard, one
    false; by sixteen who show it once 118 and none, taught in three quarters of the time.
    """
    return LessonConfig(people=16, repetitions=1) if recognizer == "stream" else LessonConfig()


def teach_procedural(model: Path, recognizer: str = "kernel", config: LessonConfig | None = None) -> int:
    """Teach the ten commands by simulated training people and save the recogniser.

    Returns:
        How many were taught.
    """
    config = config or usual(recognizer)
    sessions = training_sessions(config.people, config.repetitions, config.seed)
    return teach_in_streams(sessions, model, recognizer, config)


def closed_of(recognizer: str) -> str:
    """Return which recogniser names single recordings where ``recognizer`` hears the stream."""
    return "kernel" if recognizer == "stream" else recognizer


def labelled(session: Session) -> LabelledStream:
    """Return a session with what is shown in it, commands and others by name."""
    showings = (Showing(s.label, round(s.start_s * 1e9), round(s.end_s * 1e9)) for s in session.shown)
    return LabelledStream(session.stream, tuple(showings))


def teach_in_streams(
    sessions: Sequence[Session],
    model: Path,
    recognizer: str = "kernel",
    config: LessonConfig | None = None,
) -> int:
    """Teach what hears the demo's stream and save it.

    Args:
        sessions: Of training people; what they show beside commands is known by name and kept silent.
        model: Where to.
        recognizer: ``"stream"``: a stream model; ``"kernel"``, ``"heavy"``, ``"encoded"``: a recogniser of
            clips.
        config: How much is taught of what is no gesture, for a recogniser of clips.

    Returns:
        How many showings, or clips, were taught.
    """
    config = config or LessonConfig()
    if recognizer != "stream":
        return teach(lessons(sessions, config), model, recognizer)
    commands = sorted({s.label for session in sessions for s in session.shown if s.is_command})
    with threadpool_limits(1):
        streams = [labelled(session) for session in sessions]
        settings = StreamConfig(commands=tuple(commands))
        teach_stream((), (), streams, settings, config.seed, origin="drift").save(model)
    return sum(len(session.shown) for session in sessions)


def teach(clips: Sequence[Clip], model: Path, recognizer: str = "kernel", seed: int = 0) -> int:
    """Fit a recogniser on one thread (its matrices are small: more threads only wait) and save it.

    Returns:
        How many clips were taught.
    """
    with threadpool_limits(1):
        settings = _IN_FLIGHT.get(recognizer, {})
        RECOGNISERS[recognizer](random_state=seed, **settings).fit(list(clips)).save(model)
    return len(clips)
