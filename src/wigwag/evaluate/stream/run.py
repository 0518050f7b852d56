"""A system is taught and watches everything; what came of it becomes the benchmark's records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from wigwag.errors import DataError
from wigwag.evaluate.stream.corrupt import corrupted
from wigwag.evaluate.stream.material import Material, taught
from wigwag.evaluate.stream.plan import NEGATIVES, Show, StreamBenchmarkConfig, parts_of
from wigwag.evaluate.stream.systems import system_of
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
) -> list[dict[str, Any]]:
    """Teach a system once for each fold and let it watch everything asked for.

    Args:
        material: What was read.
        system: One of :data:`~wigwag.evaluate.stream.systems.SYSTEMS`.
        shows: What is shown.
        config: Vocabulary, people, hours, faults.
        progress: Called before each teaching and each stream.

    Returns:
        A record for each entry of ``shows`` and each fault, over all folds together; all negatives together
        where there are several; of MSRC-12, those people again by whom no setting may have been chosen.

    Raises:
        DataError: If what is to be shown was not read.
        InputError: If there is no such system or vocabulary.
    """
    teach = system_of(system)
    seen: Seen = {}
    parts = list(parts_of(material, shows, config))
    with one_thread():
        for number, part in enumerate(parts):
            if progress is not None:
                progress(f"teaching, {part.name}", number, len(parts))
            listener = teach(part.lesson())
            for show, shown in part.shows.items():
                recordings = list(shown())
                for done, recording in enumerate(recordings):
                    if progress is not None:
                        progress(f"{show}, {part.name}", done, len(recordings))
                    seen.setdefault((show, ""), []).append(watch(listener, recording))
                    for kind in config.corrupt:
                        poses = corrupted(recording, kind, [config.seed, done])
                        session = watch(listener, recording, poses, tolerant=True)
                        seen.setdefault((show, kind), []).append(session)
    if missing := [show for show in shows if (show, "") not in seen]:
        raise DataError(f"{', '.join(missing)}: nothing was read that could be shown; look at --data-dir.")
    _add_sums(seen, shows)
    return [_record(seen, show, kind, system, config) for show, kind in seen]


def _add_sums(seen: Seen, shows: Sequence[Show]) -> None:
    negatives = [show for show in shows if show in NEGATIVES]
    for kind in dict.fromkeys(kind for _, kind in seen):
        if len(negatives) > 1:
            seen["negatives", kind] = [session for show in negatives for session in seen[show, kind]]
        unseen = [s for s in seen.get(("msrc12", kind), []) if not taught(s.person)]
        if unseen:
            seen["msrc12, judged only", kind] = unseen


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
    if kind:
        score = "action_point_f1" if points else "event_f1"
        clean = figures(seen[show, ""], repeats, points)
        record["exceptions"] = sum(session.exceptions for session in sessions)
        record["f1_lost"] = None if record[score] is None else clean[score] - record[score]
        record["false_commands_more"] = record["false_commands"] - clean["false_commands"]
    return record


__all__ = ["run_system"]
