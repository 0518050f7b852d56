"""The benchmark's rows: which system is taught by whom, and what it is shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from wigwag.datasets.recording import Recording
from wigwag.errors import DataError, InputError
from wigwag.evaluate.stream.assembly import StreamConfig
from wigwag.evaluate.stream.material import (
    Fold,
    Lesson,
    Material,
    classes_of,
    folds,
    lesson,
    person_stream,
    shown_between,
)
from wigwag.evaluate.stream.systems import Listener, system_of
from wigwag.evaluate.stream.watch import Session, figures, watch
from wigwag.evaluate.threads import one_thread

Shows = Literal["utd-mhad", "utkinect", "precog", "msrc12-negative"]
"""What a taught system is shown: streams of UTD-MHAD's people, or only movements that are no command."""

Progress = Callable[[str, int, int], None]
"""Called with (what, done, total)."""


@dataclass(frozen=True, slots=True)
class StreamBenchmarkConfig:
    """One run.

    Raises:
        InputError: If a number is out of range.
    """

    vocabulary: str = "6"
    """UTD-MHAD's classes that are commands: ``"6"``, ``"7"`` or ``"27"``."""
    inner: bool = False
    """Within the training people, one left out in turn; else the benchmark's own split."""
    rounds: int = 8
    """How often every judged recording is shown, each time in another order and between other movements."""
    lesson_rounds: int = 2
    """How many streams each training person has."""
    rate_hz: float = 30.0
    """Poses a second of the judged streams; the taught ones have 30."""
    seed: int = 0

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.rounds < 1 or self.lesson_rounds < 0:
            raise InputError(
                f"--rounds must be 1 or more and --lesson-rounds 0 or more, but got {self.rounds} and "
                f"{self.lesson_rounds}."
            )


def run_system(
    material: Material,
    system: str,
    shows: Sequence[Shows],
    config: StreamBenchmarkConfig,
    progress: Progress | None = None,
) -> Iterator[dict[str, Any]]:
    """Teach a system once for each fold and let it watch everything asked for.

    Args:
        material: What was read.
        system: One of :data:`~wigwag.evaluate.stream.systems.SYSTEMS`.
        shows: What is shown.
        config: Vocabulary, people, hours.
        progress: Called before each teaching and each stream.

    Yields:
        A record for each entry of ``shows``, over all folds together.

    Raises:
        DataError: If what is to be shown was not read.
        InputError: If there is no such system or vocabulary.
    """
    classes, teach = classes_of(config.vocabulary), system_of(system)
    sessions: dict[str, list[Session]] = {show: [] for show in shows}
    parts = folds(material, config.inner)
    with one_thread():
        for number, fold in enumerate(parts):
            if progress is not None:
                progress(f"teaching, {fold.name}", number, len(parts))
            taught = _lesson(material, fold, classes, config)
            listener = teach(taught)
            for show in shows:
                recordings = list(_shown(material, show, fold, classes, config))
                for done, recording in enumerate(recordings):
                    if progress is not None:
                        progress(f"{show}, {fold.name}", done, len(recordings))
                    sessions[show].append(watch(listener, recording))
    for show in shows:
        if not sessions[show]:
            raise DataError(f"{show}: nothing was read that could be shown; look at --data-dir.")
        repeats = config.rounds if show == "utd-mhad" else 1
        yield {
            "data": show,
            "vocabulary": config.vocabulary,
            "system": system,
            "protocol": "inner" if config.inner else "test",
            "rate_hz": config.rate_hz,
            "judged": _people(sessions[show]),
            "folds": len(parts),
            "rounds": repeats,
        } | figures(sessions[show], repeats)


def _lesson(material: Material, fold: Fold, classes: Sequence[str], config: StreamBenchmarkConfig) -> Lesson:
    return lesson(material, fold, classes, seed=config.seed, rounds=config.lesson_rounds)


def _shown(
    material: Material, show: str, fold: Fold, classes: Sequence[str], config: StreamBenchmarkConfig
) -> Iterator[Recording]:
    if show != "utd-mhad":
        for recording in material.streams.get(show.removesuffix("-negative"), []):
            if recording.stream.subject in fold.everyday_judged:
                yield recording
        return
    everyday = [s for s in shown_between(material, classes) if s.clip.subject in fold.everyday_judged]
    stream = StreamConfig(rate_hz=config.rate_hz)
    for turn in range(config.rounds):
        for person in fold.judged:
            yield person_stream(material, person, classes, everyday, [0x1D, config.seed, turn], config=stream)


def _people(sessions: Sequence[Session]) -> str:
    return " ".join(sorted({str(session.recording.stream.subject) for session in sessions}))


__all__ = ["Listener", "Shows", "StreamBenchmarkConfig", "run_system"]
