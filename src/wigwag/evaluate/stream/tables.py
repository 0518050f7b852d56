"""Tables of ``wigwag benchmark stream`` for the README and the docs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wigwag.evaluate.markdown import Records, table


def stream_table(records: Records) -> str:
    """Return the tables of ``wigwag benchmark stream``: streams, faults, and what listening costs."""
    clean = [r for r in records if r["data"] != "cost" and r["corrupt"] is None]
    faulty = [r for r in records if r["data"] != "cost" and r["corrupt"] is not None]
    cost = [r for r in records if r["data"] == "cost"]
    tables = []
    if clean:
        tables.append(_streams(clean))
    if faulty:
        tables.append("With faults:\n\n" + _faults(faulty))
    if cost:
        tables.append("An hour without a break, one thread:\n\n" + _cost(cost))
    return "\n\n".join(tables)


def stream_of(record: Mapping[str, Any]) -> str:
    """Say what was shown: the stream, its rate if it is not the usual one, and what was wrong with it."""
    assembled = record["data"] in ("utd-mhad", "own", "own+others")
    rate = f" at {record['rate_hz']:g} Hz" if assembled and record["rate_hz"] != 30 else ""
    return f"{record['data']}{rate}" + (f", {record['corrupt']}" if record["corrupt"] else "")


def _streams(records: Records) -> str:
    rows = []
    for r in records:
        low, high = r["false_commands_ci95"]
        score = r["event_f1"] if r["action_point_f1"] is None else r["action_point_f1"]
        false = f"{r['false_commands_per_hour']:.1f} ({low:.1f} to {high:.1f})"
        if r["twins"]:
            false += f"; {r['false_commands_per_hour_with_twins']:.1f} with twins"
        rows.append((
            r["system"], stream_of(r), r["vocabulary"], f"{r['hours']:.1f} ({r['hours_distinct']:.1f})",
            r["events"] or "", _shown(score, 3), _shown(r["detection_rate"], 1, 100), false,
            _shown(r["jaccard"], 3), _shown(r["delay_from_end_s_median"], 2),
            _shown(r["decided_before_end"], 0, 100), _shown(r["share_seen_median"], 0, 100),
            f"{r['ms_per_pose_mean']:.2f}",
        ))  # fmt: skip
    return table(
        (
            "system", "stream", "classes", "hours (distinct)", "gestures", "F1", "found, %",
            "false commands an hour (95 %)", "Jaccard", "after the end, s", "before the end, %", "seen, %",
            "ms a pose",
        ),
        rows,
    )  # fmt: skip


def _faults(records: Records) -> str:
    return table(
        ("system", "stream", "classes", "fault", "F1 lost", "false commands more", "exceptions"),
        [
            (
                r["system"], r["data"], r["vocabulary"], r["corrupt"], _shown(r["f1_lost"], 3),
                f"{r['false_commands_more']:+d} in {r['hours']:.1f} h", r["exceptions"],
            )
            for r in records
        ],
    )  # fmt: skip


def _cost(records: Records) -> str:
    return table(
        (
            "system", "gestures", "ms a pose", "99 % below", "at most", "last to first quarter",
            "memory, MB (growth)",
        ),
        [
            (
                r["system"], r["gestures"], f"{r['ms_per_pose_mean']:.3f}", f"{r['ms_per_pose_p99']:.2f}",
                f"{r['ms_per_pose_max']:.1f}", f"{r['last_to_first_quarter']:.2f}",
                f"{r['rss_mb']:.0f} ({r['rss_growth_mb']:+.1f})",
            )
            for r in records
        ],
    )  # fmt: skip


def _shown(value: float | None, digits: int, times: float = 1.0) -> str:
    return "" if value is None else f"{times * value:.{digits}f}"


__all__ = ["stream_of", "stream_table"]
