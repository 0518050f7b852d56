"""Who is taught, who is judged, and what stands between their gestures: nobody is on both sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from wigwag.datasets import msrc12, precog, utd_mhad, utkinect
from wigwag.datasets.recording import Mark, Recording
from wigwag.errors import DataError, InputError
from wigwag.evaluate.protocols import CLASS_SETS, TRAIN_SUBJECTS
from wigwag.evaluate.stream.assembly import Body, Shown, StreamConfig, assemble
from wigwag.skeleton import Clip

TWINS: dict[str, str] = {
    "utkinect:walk": "a23", "utkinect:sitDown": "a25", "utkinect:standUp": "a24", "utkinect:throw": "a5",
    "utkinect:push": "a18", "utkinect:waveHands": "a3", "utkinect:clapHands": "a4", "precog": "a13",
    "msrc12:g2": "a27", "msrc12:g8": "a5",
}  # fmt: skip
"""Everyday movements that are the same movement as one of UTD-MHAD's gestures. A command of that name is
neither right nor false while they are shown; it is counted apart. PRECOG punches as a13 does; g2 ducks as
a27 squats."""

SEATED = ("utkinect:sitDown", "utkinect:standUp")
"""Whoever sits down gets up again: not shown between gestures where getting up is one."""

PIECE_S = (2.5, 5.0)
"""Shortest and longest piece of a recording without marked actions that is shown at once."""

LONGEST_HOLE_S = 0.5
"""A recorded action with a longer hole is not shown between gestures."""


@dataclass(frozen=True, slots=True)
class Material:
    """Everything that was read."""

    utd: list[Clip] = field(default_factory=list)
    """UTD-MHAD's recordings."""
    everyday: list[Shown] = field(default_factory=list)
    """Everyday movements of other sets' people, without a label."""
    streams: dict[str, list[Recording]] = field(default_factory=dict)
    """Whole recordings of other sets by its name; everything in them is a scene, nothing a mark."""
    msrc12: list[Recording] = field(default_factory=list)
    """MSRC-12 with its action points as marks."""


def read_material(data: Path) -> Material:
    """Read UTD-MHAD, and UTKinect, PRECOG and MSRC-12 as far as they are there.

    Args:
        data: Folder with ``utd_mhad``, ``utkinect``, ``precog`` and ``msrc12``.

    Raises:
        DataError: If UTD-MHAD is not there.
    """
    material = Material(utd=utd_mhad.load_skeletons(data / "utd_mhad").clips)
    if (data / "utkinect").exists():
        material.streams["utkinect"] = [
            replace(r, scenes=tuple(replace(s, label=f"utkinect:{s.label}") for s in r.scenes))
            for r in utkinect.load_recordings(data / "utkinect").recordings
        ]
        material.everyday.extend(_actions(material.streams["utkinect"]))
    if (data / "precog").exists():
        clips = precog.load_recordings(data / "precog").clips
        material.streams["precog"] = [Recording(clip, (), (_whole(clip, "precog"),)) for clip in clips]
        material.everyday.extend(s for clip in clips for s in _pieces(clip, "precog"))
    if (data / "msrc12").exists():
        material.msrc12.extend(msrc12.load_recordings(data / "msrc12").recordings)
        # Nothing in it is a command of another vocabulary: all of a recording shows its one gesture.
        material.streams["msrc12"] = [
            Recording(r.stream, (), (_whole(r.stream, f"msrc12:{r.marks[0].label}"),))
            for r in material.msrc12
            if r.marks
        ]
    return material


def taught(person: str) -> bool:
    """Say whether a person of the everyday sets is among those whose movements may be taught.

    Those with an odd number in UTKinect and PRECOG, and an even one in MSRC-12 (whose numbers here are
    multiples of three); the others are only judged.
    """
    number = int(person[-2:])
    return (number % 2 == 0) == person.startswith("msrc12")


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
    """Everyday movements without a label, 1 to 10 s each."""
    streams: list[Recording] = field(default_factory=list)
    """Streams assembled of the above, with their truth; or recorded ones with action points."""
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
    rate_hz: float = 30.0,
) -> Lesson:
    """Return what a fold's training people teach.

    Args:
        material: What was read.
        fold: Who.
        classes: The vocabulary.
        seed: Of the assembled streams.
        rounds: How many streams a training person has.
        rate_hz: Of the streams.
    """
    mine = [clip for clip in material.utd if clip.subject in fold.taught]
    everyday = [s for s in shown_between(material, classes) if s.clip.subject in fold.everyday_taught]
    background = [s.clip for s in everyday if TWINS.get(s.source) not in classes]
    streams = []
    for turn in range(rounds):
        for person in fold.taught:
            streams.append(
                person_stream(
                    material,
                    person,
                    classes,
                    everyday,
                    [0x7A, seed, turn],
                    config=StreamConfig(rate_hz=rate_hz),
                )
            )
    return Lesson(
        [clip for clip in mine if clip.label in classes],
        [clip for clip in mine if clip.label not in classes],
        background,
        streams,
        seed,
    )


def shown_between(material: Material, classes: Sequence[str]) -> list[Shown]:
    """Return everyday movements that may be shown between gestures of a vocabulary."""
    seat = {"a24", "a25"} & set(classes)
    kept = []
    for shown in material.everyday:
        twin = TWINS.get(shown.source) in classes and shown.source.startswith("utkinect")
        if not twin and not (seat and shown.source in SEATED):
            kept.append(shown)
    return kept


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

    Between gestures come everyday movements drawn from ``everyday`` and from the person's own jogging and
    walking, unless those are in the vocabulary.

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
    if not shown:
        raise DataError(f"There is no recording of {', '.join(classes)} by {person}.")
    own = [Shown(c, f"utd:{c.label}") for c in mine if c.label in ("a22", "a23") and c.label not in classes]
    rng = np.random.default_rng([*seed, int(person[1:])])
    groups = _groups(shown)
    pool = [*everyday, *own]
    between = [pool[int(i)] for i in rng.permutation(len(pool))]
    while pool and len(between) < len(groups):
        between += [pool[int(i)] for i in rng.permutation(len(pool))]
    body = Body.of(mine, utd_mhad.RATE_HZ)
    name = f"stream of {person}, {' '.join(map(str, seed))}"
    return assemble(body, groups, between, config, seed=[*seed, int(person[1:])], name=name)


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


def _actions(recordings: Sequence[Recording]) -> list[Shown]:
    """Cut the actions out of recorded streams."""
    cut = []
    for recording in recordings:
        stream = recording.stream
        for number, scene in enumerate(recording.scenes):
            low, high = np.searchsorted(stream.stamps_ns, [scene.onset_ns, scene.end_ns + 1])
            stamps = stream.stamps_ns[low:high]
            if high - low < 4 or float(np.diff(stamps).max()) * 1e-9 > LONGEST_HOLE_S:
                continue
            name = f"{stream.name}_{number}_{scene.label.partition(':')[2]}"
            clip = Clip(stream.joints[low:high], stamps - stamps[0], None, stream.subject, name)
            cut.append(Shown(clip, scene.label))
    return cut


def _pieces(clip: Clip, source: str) -> list[Shown]:
    """Cut a recording into equal pieces of a length that is shown at once."""
    count = max(round(clip.duration_s / (sum(PIECE_S) / 2)), 1)
    edges = np.linspace(0, len(clip), count + 1).astype(int)
    return [
        Shown(replace(_part(clip, low, high), name=f"{clip.name}_{number}"), source)
        for number, (low, high) in enumerate(pairwise(edges))
    ]


def _part(clip: Clip, low: int, high: int) -> Clip:
    stamps = clip.stamps_ns[low:high]
    return replace(clip, joints=clip.joints[low:high], stamps_ns=stamps - stamps[0])


def _whole(clip: Clip, source: str) -> Mark:
    return Mark(source, int(clip.stamps_ns[0]), int(clip.stamps_ns[-1]))


__all__ = [
    "TWINS", "Fold", "Lesson", "Material", "classes_of", "folds", "lesson", "person_stream", "read_material",
    "shown_between", "taught",
]  # fmt: skip
