"""A system is taught and watches everything; what came of it becomes the benchmark's records."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from wigwag.datasets.recording import Recording
from wigwag.errors import DataError
from wigwag.evaluate.stream.corrupt import corrupted
from wigwag.evaluate.stream.lessons import Lesson
from wigwag.evaluate.stream.material import Material, taught
from wigwag.evaluate.stream.plan import NEGATIVES, Part, Show, StreamBenchmarkConfig, parts_of
from wigwag.evaluate.stream.systems import Listener, system_of
from wigwag.evaluate.stream.watch import Session, figures, watch
from wigwag.evaluate.threads import one_thread

Progress = Callable[[str, int, int], None]
"""Called with (what, done, total)."""

Seen = dict[tuple[str, str], list[Session]]
"""Sessions by what was shown and with which fault (``""``: none)."""


def run_system(
    material: Material,
    system: str,
    shows: Sequence[Show],
    config: StreamBenchmarkConfig,
    progress: Progress | None = None,
) -> Iterator[dict[str, Any]]:
    """Teach a system once for each fold and let it watch everything asked for.

    Args:
        material: What was read.
        system: One of :data:`~wigwag.evaluate.stream.systems.SYSTEMS`.
        shows: What is shown.
        config: Vocabulary, people, hours, faults.
        progress: Called before each teaching and each stream.

    Returns:
        A record for each entry of ``shows`` and each fault, over all folds together, as soon as the last of
        them is through; all negatives together where there are several; of MSRC-12, those people again by
        whom no setting may have been chosen.

    Raises:
        DataError: If what is to be shown was not read.
        InputError: If there is no such system or vocabulary.
    """
    teach = system_of(system)
    parts = list(parts_of(material, shows, config))
    shown = {show for part in parts for show in part.shows}
    if missing := [show for show in shows if show not in shown]:
        raise DataError(f"{', '.join(missing)}: nothing was read that could be shown; look at --data-dir.")
    return _records(parts, teach, system, config, progress or (lambda what, done, total: None))


def _records(
    parts: Sequence[Part],
    teach: Callable[[Lesson], Listener],
    system: str,
    config: StreamBenchmarkConfig,
    progress: Progress,
) -> Iterator[dict[str, Any]]:
    seen: Seen = {}
    left = Counter(show for part in parts for show in part.shows)
    with one_thread():
        for number, part in enumerate(parts):
            progress(f"teaching, {part.name}", number, len(parts))
            listener = teach(part.lesson())
            for show, shown in part.shows.items():
                recordings = list(shown())
                for done, recording in enumerate(recordings):
                    progress(f"{show}, {part.name}", done, len(recordings))
                    for kind, session in _sessions(listener, recording, config, done):
                        seen.setdefault((show, kind), []).append(replace(session, fold=part.name))
                left[show] -= 1
                for name in _complete(seen, left, show):
                    for kind in ("", *config.corrupt):
                        yield _record(seen, name, kind, system, config)


def _sessions(
    listener: Listener, recording: Recording, config: StreamBenchmarkConfig, number: int
) -> Iterator[tuple[str, Session]]:
    """Let a listener watch one recording, as it is and with every fault."""
    yield "", watch(listener, recording)
    for kind in config.corrupt:
        poses = corrupted(recording, kind, [config.seed, number])
        yield kind, watch(listener, recording, poses, tolerant=True)


def _complete(seen: Seen, left: Counter[Show], show: Show) -> list[str]:
    """Return what is complete now that a part of ``show`` has been watched, sums over several shows too."""
    if left[show]:
        return []
    if (show, "") not in seen:
        raise DataError(f"{show}: nothing was read that could be shown; look at --data-dir.")
    complete: list[str] = [show]
    negatives = [name for name in NEGATIVES if name in left]
    kinds = [kind for name, kind in seen if name == show]
    if show in negatives and len(negatives) > 1 and not any(left[name] for name in negatives):
        for kind in kinds:
            seen["negatives", kind] = [session for name in negatives for session in seen[name, kind]]
        complete.append("negatives")
    if show == "msrc12" and any(not taught(s.person) for s in seen[show, ""]):
        for kind in kinds:
            seen["msrc12, judged only", kind] = [s for s in seen[show, kind] if not taught(s.person)]
        complete.append("msrc12, judged only")
    return complete


def _record(seen: Seen, show: str, kind: str, system: str, config: StreamBenchmarkConfig) -> dict[str, Any]:
    sessions = seen[show, kind]
    points = show in ("msrc12", "msrc12, judged only")
    names = [session.name.partition(", ")[0] for session in sessions]
    repeats = len(names) / len(set(names))
    people = sorted({session.person for session in sessions})
    record: dict[str, Any] = {
        "data": show,
        "vocabulary": "msrc12" if points else config.vocabulary,
        "system": system,
        "protocol": "inner" if config.inner else "test",
        "corrupt": kind or None,
        "rate_hz": config.rate_hz,
        "lesson_rounds": config.lesson_rounds,
        "repeats": repeats,
        "judged": " ".join(people[:12]) + (f" and {len(people) - 12} more" if len(people) > 12 else ""),
    } | figures(sessions, repeats, points)
    if points:
        record["action_point_f1_of"] = _by_fold(sessions)
    if kind:
        score = "action_point_f1" if points else "event_f1"
        clean = figures(seen[show, ""], repeats, points)
        record["exceptions"] = sum(session.exceptions for session in sessions)
        record["f1_lost"] = None if record[score] is None else clean[score] - record[score]
        record["false_commands_more"] = record["false_commands"] - clean["false_commands"]
    return record


def _by_fold(sessions: Sequence[Session]) -> list[str]:
    """Return the F1 of action points by who had taught."""
    folds: dict[str, list[Session]] = {}
    for session in sessions:
        folds.setdefault(session.fold, []).append(session)
    scores = {fold: figures(mine, points=True)["action_point_f1"] for fold, mine in folds.items()}
    return [f"{fold}: {score:.3f}" for fold, score in sorted(scores.items()) if score is not None]


__all__ = ["run_system"]
