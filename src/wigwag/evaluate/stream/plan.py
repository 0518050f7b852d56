"""What the benchmark teaches, and what it shows to whom it taught."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal, get_args

from wigwag.datasets.recording import Recording
from wigwag.errors import InputError
from wigwag.evaluate.protocols import TRAIN_SUBJECTS
from wigwag.evaluate.stream.assembly import StreamConfig
from wigwag.evaluate.stream.corrupt import CORRUPTIONS, Corruption
from wigwag.evaluate.stream.lessons import Fold, Lesson, classes_of, folds, lesson, own_lesson, person_stream
from wigwag.evaluate.stream.material import Material, shown_between, taught
from wigwag.evaluate.stream.points import point_folds, point_lesson
from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.skeleton import Clip

Show = Literal[
    "utd-mhad", "own", "own+others", "msrc12", "utkinect", "precog", "msrc12-negative", "simulated"
]  # fmt: skip
"""What a system is shown. utd-mhad: streams of people it never met; own, own+others: streams of a person who
enrolled one example of each gesture, alone or beside what others taught; msrc12: its 12 gestures, people
left out; the rest: only movements that are no command."""

SHOWS: tuple[Show, ...] = get_args(Show)

NEGATIVES: tuple[Show, ...] = ("utkinect", "precog", "msrc12-negative", "simulated")
"""They are also counted together."""

SIMULATED_PEOPLE = 40
"""Of three minutes each; a fold of ``inner`` has a quarter of them."""


@dataclass(frozen=True, slots=True)
class StreamBenchmarkConfig:
    """One run.

    Raises:
        InputError: If a number is out of range.
    """

    vocabulary: str = "6"
    """UTD-MHAD's classes that are commands: ``"6"``, ``"7"`` or ``"27"``. MSRC-12 has its own 12."""
    inner: bool = False
    """Within the training people, some left out in turn; else the benchmark's own split."""
    rounds: int = 8
    """How often every judged recording is shown, each time in another order and between other movements."""
    lesson_rounds: int = 2
    """How many streams each training person has."""
    rate_hz: float = 30.0
    """Poses a second of the judged streams that are assembled; the taught ones have 30."""
    corrupt: tuple[Corruption, ...] = ()
    """Everything is also shown with these faults."""
    seed: int = 0

    def __post_init__(self) -> None:
        """Check the numbers and names."""
        if self.rounds < 1 or self.lesson_rounds < 0:
            raise InputError(
                f"rounds must be 1 or more and lesson_rounds 0 or more, but got {self.rounds} and "
                f"{self.lesson_rounds}."
            )
        if unknown := sorted(set(self.corrupt) - set(CORRUPTIONS)):
            raise InputError(f"There is no corruption {unknown}. Available: {', '.join(CORRUPTIONS)}.")


@dataclass(frozen=True, slots=True)
class Part:
    """One teaching, and what is shown to who was taught."""

    name: str
    lesson: Callable[[], Lesson]
    shows: Mapping[Show, Callable[[], Iterable[Recording]]]


def parts_of(material: Material, shows: Sequence[Show], config: StreamBenchmarkConfig) -> Iterator[Part]:
    """Yield every teaching that what is to be shown needs."""
    classes = classes_of(config.vocabulary)
    common = [show for show in shows if show == "utd-mhad" or show in NEGATIVES]
    for number, fold in enumerate(folds(material, config.inner)):
        if common:
            shown = {s: partial(_shown, material, s, fold, number, config) for s in common}
            rounds = config.lesson_rounds
            teach = partial(lesson, material, fold, classes, seed=config.seed, rounds=rounds)
            yield Part(fold.name, teach, shown)
        for show in shows:
            if show in ("own", "own+others"):
                for person in fold.judged:
                    yield _own_part(material, show, fold, person, config)
    if "msrc12" in shows and material.msrc12:
        people = {str(r.stream.subject) for r in material.msrc12}
        kept = [person for person in sorted(people) if not config.inner or taught(person)]
        for points in point_folds(kept):
            judged = [r for r in material.msrc12 if r.stream.subject in points.judged]
            mine = [r for r in material.msrc12 if r.stream.subject in kept]
            yield Part(
                points.name,
                partial(point_lesson, mine, points, config.seed),
                {"msrc12": partial(list, judged)},
            )


def _own_part(material: Material, show: Show, fold: Fold, person: str, config: StreamBenchmarkConfig) -> Part:
    beside = show == "own+others"
    classes = classes_of(config.vocabulary)
    made, left = own_lesson(material, fold, classes, person, beside_others=beside, seed=config.seed)
    return Part(
        f"{show} {person}",
        lambda: made,
        {show: partial(_streams, material, fold, (person,), config, left)},
    )


def _shown(
    material: Material, show: Show, fold: Fold, number: int, config: StreamBenchmarkConfig
) -> Iterable[Recording]:
    if show == "utd-mhad":
        return _streams(material, fold, fold.judged, config)
    if show == "simulated" and config.inner:
        return simulated_everyday(SIMULATED_PEOPLE // len(TRAIN_SUBJECTS), "inner", 10 * config.seed + number)
    if show == "simulated":
        return simulated_everyday(SIMULATED_PEOPLE, "test", config.seed)
    whole = material.streams.get(show.removesuffix("-negative"), [])
    return [r for r in whole if r.stream.subject in fold.everyday_judged]


def _streams(
    material: Material,
    fold: Fold,
    people: Sequence[str],
    config: StreamBenchmarkConfig,
    only: Sequence[Clip] | None = None,
) -> Iterator[Recording]:
    classes = classes_of(config.vocabulary)
    everyday = [s for s in shown_between(material, classes) if s.clip.subject in fold.everyday_judged]
    stream = StreamConfig(rate_hz=config.rate_hz)
    for turn in range(config.rounds):
        for person in people:
            seed = [0x1D if only is None else 0x2D, config.seed, turn]
            yield person_stream(material, person, classes, everyday, seed, config=stream, only=only)


__all__ = ["NEGATIVES", "SHOWS", "SIMULATED_PEOPLE", "Part", "Show", "StreamBenchmarkConfig", "parts_of"]
