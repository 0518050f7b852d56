"""Tables of what is measured of flights: the demo, faults, following."""

from __future__ import annotations

from wigwag.evaluate.markdown import Records, table


def demo_table(summaries: Records) -> str:
    """Return the table of ``wigwag demo``, a line a run."""
    columns = (
        "motion, seed", "right", "wrong", "false (others shown)", "decided after the end, median", "found",
        "bearing error", "distance error", "frames a second of one core", "memory",
    )  # fmt: skip
    rows: list[tuple[object, ...]] = []
    for s in summaries:
        g, f = s["gestures"], s["follow"]
        b, d = f["bearing_error_deg"], f["distance_error_m"]
        after_s = g["decided_after_end_s_median"]
        rows.append((
            f"{s['motion']}, {s['seed']}", f"{g['recognised']} of {g['shown']}", g["wrong"],
            f"{s['false_commands']} ({s['others_shown']})", "" if after_s is None else f"{after_s:.2f} s",
            f"{100 * s['pose']['found']:.1f} %", f"{b['mean']:.2f}° mean, {b['max']:.1f}° max",
            f"{d['mean']:.2f} m mean, {d['max']:.2f} m max", f"{s['loop']['hz']:.0f}", f"{s['rss_mb']} MB",
        ))  # fmt: skip
        if "clips" in s:
            c = s["clips"]
            clips = (f"{s['motion']}, one by one", f"{c['right']} of {c['shown']}", c["wrong"])
            rows.append(clips + ("",) * (len(columns) - len(clips)))
    return table(columns, rows)


def faults_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark faults``."""
    return table(
        ("fault", "ended as documented", "end", "within, s", "at most, s", "nearest to the person, m"),
        [
            (
                r["fault"], f"{r['ended_as_documented']} of {r['runs']}", r["end_state"],
                f"{r['documented_s']:g}", f"{r['time_s_max']:.1f}", f"{r['nearest_m']:.2f}",
            )
            for r in records
        ],
    )  # fmt: skip


def follow_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark follow``."""
    return table(
        (
            "vehicle", "bearing error, mean (worst run)", "distance error, mean (worst run)",
            "commands miss their end by, mean", "within 15 %, %", "runs",
        ),
        [
            (
                r["vehicle"], f"{r['bearing_deg_mean']:.2f}° ({r['bearing_deg_worst_run']:.2f}°)",
                f"{r['distance_m_mean']:.2f} m ({r['distance_m_worst_run']:.2f} m)",
                f"{100 * r['command_error_mean']:.1f} %", f"{100 * r['commands_within_15']:.0f}", r["runs"],
            )
            for r in records
        ],
    )  # fmt: skip


__all__ = ["demo_table", "faults_table", "follow_table"]
