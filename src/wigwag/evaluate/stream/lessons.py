"""Who teaches, who is judged, and what is taught: nobody is on both sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from wigwag.datasets import utd_mhad
from wigwag.datasets.recording import Mark, Recording
from wigwag.errors import DataError, InputError
from wigwag.evaluate.protocols import CLASS_SETS, TRAIN_SUBJECTS
from wigwag.evaluate.stream.assembly import Body, Shown, StreamConfig, assemble
from wigwag.evaluate.stream.material import TWINS, Material, shown_between, taught
from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.skeleton import Clip


@dataclass(frozen=True, slots=True)
class Fold:
    """One way of parting people into those who are taught and those who are judged."""

    name: str
    taught: tuple[str, ...]
    """People of UTD-MHAD."""
    judged: tuple[str, ...]
    everyday_taught: tuple[str, ...]
    """People of the everyday sets."""
    everyday_judged: tuple[str, ...]


def folds(material: Material, inner: bool) -> list[Fold]:
    """Return the one split of the benchmark, or with ``inner`` those within its training people.

    The benchmark's: UTD-MHAD's subjects 1, 3, 5, 7 teach and 2, 4, 6, 8 are judged; everyday people as
    :func:`taught` says. Inner: each of 1, 3, 5, 7 is judged by the other three, and of the everyday people
    who may be taught every second one teaches while the others are judged, in turn.
    """
    clips = [s.clip for s in material.everyday] + [r.stream for rs in material.streams.values() for r in rs]
    everyday = sorted({str(clip.subject) for clip in clips})
    teachers = [person for person in everyday if taught(person)]
    others = tuple(person for person in everyday if not taught(person))
    if not inner:
        rest = tuple(s for s in utd_mhad.SUBJECTS if s not in TRAIN_SUBJECTS)
        return [Fold("test", TRAIN_SUBJECTS, rest, tuple(teachers), others)]
    split = []
    for number, person in enumerate(TRAIN_SUBJECTS):
        judged = tuple(p for i, p in enumerate(teachers) if i % 2 == number % 2)
        left = tuple(p for p in teachers if p not in judged)
        split.append(
            Fold(f"inner {person}", tuple(s for s in TRAIN_SUBJECTS if s != person), (person,), left, judged)
        )
    return split


@dataclass(frozen=True, slots=True)
class Lesson:
    """What a system is taught by."""

    gestures: list[Clip]
    """Recordings of the vocabulary, labelled, as they were recorded (with the rest at their ends)."""
    others: list[Clip] = field(default_factory=list)
    """Recordings of further gestures of the same people, labelled, which are no command."""
    background: list[Clip] = field(default_factory=list)
    """Everyday movements without a label: recorded ones of 1 to 10 s, simulated ones of minutes."""
    deliberate: list[Clip] = field(default_factory=list)
    """Further people's gestures that are no command, whole recordings without a label: MSRC-12's."""
    streams: list[Recording] = field(default_factory=list)
    """Streams assembled of gestures, others and background, with their truth; or recorded, with action
    points."""
    seed: int = 0

    @property
    def vocabulary(self) -> tuple[str, ...]:
        """The labels that are commands."""
        return tuple(sorted({str(clip.label) for clip in self.gestures}))


def classes_of(vocabulary: str) -> tuple[str, ...]:
    """Return UTD-MHAD's labels in a vocabulary.

    Raises:
        InputError: If there is no such vocabulary.
    """
    if vocabulary not in CLASS_SETS:
        raise InputError(f"--vocabulary must be one of {', '.join(CLASS_SETS)}, but got {vocabulary!r}.")
    return CLASS_SETS[vocabulary]


def lesson(
    material: Material,
    fold: Fold,
    classes: Sequence[str],
    *,
    seed: int = 0,
    rounds: int = 1,
    simulated: int = 4,
) -> Lesson:
    """Return what a fold's training people teach.

    Args:
        material: What was read.
        fold: Who.
        classes: The vocabulary.
        seed: Of the assembled streams.
        rounds: How many streams a training person has.
        simulated: How many simulated people's everyday movements are taught beside the recorded ones.
    """
    mine = [clip for clip in material.utd if clip.subject in fold.taught]
    everyday = [s for s in shown_between(material, classes) if s.clip.subject in fold.everyday_taught]
    return Lesson(
        [clip for clip in mine if clip.label in classes],
        [clip for clip in mine if clip.label not in classes],
        _background(everyday, classes, simulated, seed),
        _deliberate(material, fold, classes),
        [
            person_stream(material, person, classes, everyday, [0x7A, seed, turn])
            for turn in range(rounds)
            for person in fold.taught
        ],
        seed,
    )


def own_lesson(
    material: Material,
    fold: Fold,
    classes: Sequence[str],
    person: str,
    *,
    trial: int = 1,
    beside_others: bool = False,
    seed: int = 0,
) -> tuple[Lesson, list[Clip]]:
    """Return what one example of each gesture teaches that the person themselves shows.

    Args:
        material: What was read.
        fold: Whose everyday movements, and, with ``beside_others``, whose gestures are taught too.
        classes: The vocabulary.
        person: Who enrols.
        trial: Which recording of each gesture is the example, from 1; the first where there are fewer.
        beside_others: Whether the gestures of the fold's training people are taught beside.
        seed: Of the assembled streams.

    Returns:
        The lesson, and the person's other recordings of the vocabulary, by which to judge.
    """
    mine = [clip for clip in material.utd if clip.subject == person and clip.label in classes]
    examples = []
    for label in classes:
        takes = [clip for clip in mine if clip.label == label]
        examples += takes[trial - 1 : trial] or takes[:1]
    names = {clip.name for clip in examples}
    left = [clip for clip in mine if clip.name not in names]
    if beside_others:
        taught = lesson(material, fold, classes, seed=seed)
        return replace(taught, gestures=taught.gestures + examples), left
    everyday = [s for s in shown_between(material, classes) if s.clip.subject in fold.everyday_taught]
    streams = [person_stream(material, p, classes, everyday, [0x0E, seed], only=()) for p in fold.taught]
    background = _background(everyday, classes, 4, seed)
    return Lesson(examples, [], background, _deliberate(material, fold, classes), streams, seed), left


def _deliberate(material: Material, fold: Fold, classes: Sequence[str]) -> list[Clip]:
    """Return a recording of each of MSRC-12's gestures by each who may be taught, unless it is a command."""
    chosen: dict[tuple[str, str], Clip] = {}
    for recording in material.streams.get("msrc12", []):
        clip, source = recording.stream, recording.scenes[0].label
        if clip.subject in fold.everyday_taught and TWINS.get(source) not in classes:
            chosen.setdefault((str(clip.subject), source), clip)
    return [chosen[key] for key in sorted(chosen)]


def _background(everyday: Sequence[Shown], classes: Sequence[str], simulated: int, seed: int) -> list[Clip]:
    """Return what is taught as no gesture: nothing that is a gesture of the vocabulary by another name."""
    recorded = [s.clip for s in everyday if TWINS.get(s.source) not in classes]
    made = []
    for recording in simulated_everyday(simulated, "teach", seed):
        twins = [s for s in recording.scenes if TWINS.get(s.label) in classes]
        made += _without(recording.stream, twins)
    return recorded + made


def _without(stream: Clip, scenes: Sequence[Mark], least: int = 60) -> list[Clip]:
    """Cut scenes out of a stream; return what is left, in pieces of ``least`` frames or more."""
    if not scenes:
        return [stream]
    keep = np.ones(len(stream), dtype=bool)
    for scene in scenes:
        keep &= (stream.stamps_ns < scene.onset_ns) | (stream.stamps_ns > scene.end_ns)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], keep, [False]]).astype(int)))
    pieces = []
    for number, (low, high) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        if high - low >= least:
            stamps = stream.stamps_ns[low:high]
            name = f"{stream.name}, part {number}"
            pieces.append(
                replace(stream, joints=stream.joints[low:high], stamps_ns=stamps - stamps[0], name=name)
            )
    return pieces


def person_stream(
    material: Material,
    person: str,
    classes: Sequence[str],
    everyday: Sequence[Shown],
    seed: Sequence[int],
    *,
    config: StreamConfig | None = None,
    only: Sequence[Clip] | None = None,
) -> Recording:
    """Assemble one stream of one of UTD-MHAD's people: every recording of the vocabulary once.

    Between gestures come everyday movements, drawn in turn from each set in ``everyday`` and from the
    person's own jogging and walking, unless those are in the vocabulary.

    Args:
        material: What was read.
        person: ``"s1"`` to ``"s8"``.
        classes: The vocabulary.
        everyday: Of whom everyday movements are taken.
        seed: Of order and choice.
        config: How the stream is put together.
        only: Show these recordings of the person alone; ``None``: all of the vocabulary.

    Raises:
        DataError: If the person has no recordings.
    """
    mine = [clip for clip in material.utd if clip.subject == person]
    shown = [c for c in mine if c.label in classes] if only is None else list(only)
    if not mine or (only is None and not shown):
        raise DataError(f"There is no recording of {', '.join(classes)} by {person}.")
    own = [Shown(c, f"utd:{c.label}") for c in mine if c.label in ("a22", "a23") and c.label not in classes]
    rng = np.random.default_rng([*seed, int(person[1:])])
    groups = _groups(shown)
    between = _in_turn([*everyday, *own], len(groups) or len(everyday), rng)
    body = Body.of(mine, utd_mhad.RATE_HZ)
    name = f"stream of {person}, {' '.join(map(str, seed))}"
    return assemble(body, groups, between, config, seed=[*seed, int(person[1:])], name=name)


def _in_turn(pool: Sequence[Shown], count: int, rng: np.random.Generator) -> list[Shown]:
    """Draw everyday movements from each set in turn, none again before all of its set have been shown."""
    sets: dict[str, list[Shown]] = {}
    for shown in pool:
        sets.setdefault(shown.source.partition(":")[0], []).append(shown)
    decks: dict[str, list[Shown]] = {name: [] for name in sets}
    drawn: list[Shown] = []
    while sets and len(drawn) < count:
        for name, deck in decks.items():
            if not deck:
                deck += [sets[name][int(i)] for i in rng.permutation(len(sets[name]))]
            drawn.append(deck.pop())
    return [drawn[int(i)] for i in rng.permutation(len(drawn))]


def _groups(clips: Sequence[Clip]) -> list[list[Shown]]:
    """Sit down before standing up where both are shown; everything else by itself."""
    shown = {clip.name: Shown(clip, f"utd:{clip.label}", clip.label) for clip in clips}
    groups = []
    for clip in clips:
        if clip.label == "a25" and (up := clip.name.replace("a25", "a24")) in shown:
            groups.append([shown[clip.name], shown[up]])
        elif not (clip.label == "a24" and clip.name.replace("a24", "a25") in shown):
            groups.append([shown[clip.name]])
    return groups


__all__ = [
    "Fold", "Lesson", "classes_of", "folds", "lesson", "own_lesson", "person_stream",
]  # fmt: skip
