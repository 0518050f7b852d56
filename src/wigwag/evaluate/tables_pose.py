"""Tables of what is measured of perception: passers-by, smoothing, people without depth."""

from __future__ import annotations

from collections.abc import Sequence

from wigwag.evaluate.markdown import Records, table


def operator_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark operator``: a row a condition, all distances together."""
    distances = sorted({float(r["distance_m"]) for r in records})
    columns = (
        "condition", *(f"kept, {d:g} m" for d in distances), "found, % of frames in view",
        "back in view until handed on, s, at most", "frames of passers-by handed on", "frames",
    )  # fmt: skip
    names = dict.fromkeys(r["condition"] for r in records)
    rows = [_condition_row(n, [r for r in records if r["condition"] == n], distances) for n in names]
    return table(columns, [*rows, _condition_row("**all**", records, distances)])


def _condition_row(name: str, rows: Records, distances: Sequence[float]) -> tuple[object, ...]:
    cells = []
    for distance in distances:
        here = [r for r in rows if r["distance_m"] == distance]
        kept, crossings = (sum(r[key] for r in here) for key in ("kept", "crossings"))
        cells.append(f"{kept} of {crossings}" if here else "")
    shown = sum(r["frames_visible"] for r in rows)
    found = sum(r["frames_operator_pct"] * r["frames_visible"] for r in rows) / max(shown, 1)
    back = [r["reacquired_s_max"] for r in rows if r["reacquired_s_max"] is not None]
    return (
        name, *cells, f"{found:.1f}", f"{max(back):.2f}" if back else "",
        sum(r["frames_of_passerby"] for r in rows), sum(r["frames"] for r in rows),
    )  # fmt: skip


def smooth_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark smooth``."""
    rows = []
    for r in records:
        lag, over = (
            " / ".join(f"{scale * r[f'{name}_{part}']:.1f}" for part in ("median", "p95", "max"))
            for name, scale in (("lag_ms", 1), ("overshoot", 100))
        )
        rest = (f"{r[n]:.1f}" for n in ("rms_mm", "rest_rms_mm", "rest_jitter_mm", "heel_rms_mm"))
        rows.append((r["filter"], f"{r['rate_hz']:g}", lag, over, *rest))
    return table(
        (
            "filter", "Hz", "lag, ms, median / 95 % / greatest", "overshoot, %, likewise", "RMS, mm",
            "at rest, mm", "jitter, mm", "heels, mm",
        ),
        rows,
    )  # fmt: skip


def monocular_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark monocular``."""
    return table(
        (
            "m", "placed by", "found, %", "distance error, %, median / 95 %", "landmarks from the hips, mm",
            "within 1 sd stated, %", "within 2 sd, %",
        ),
        [
            (
                f"{r['distance_m']:g}", r["way"], f"{100 * r['found']:.1f}",
                f"{100 * r['distance_error_median']:.1f} / {100 * r['distance_error_p95']:.1f}",
                f"{r['landmark_mm_median']:.0f}", f"{100 * r['within_1_sigma']:.0f}",
                f"{100 * r['within_2_sigma']:.0f}",
            )
            for r in records
        ],
    )  # fmt: skip


def lift_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark lift``: people on whom nothing was fitted."""
    return table(
        (
            "landmark", "pixels knocked out, %", "median error, mm", "beyond 150 mm, %", "missing, %",
            "within 1 sd stated, %", "within 2 sd, %", "frames",
        ),
        [
            (
                r["landmark"], f"{100 * r['knock_out']:.0f}", f"{r['median_abs_mm']:.1f}",
                f"{100 * r['beyond_150_mm']:.1f}", f"{100 * r['missing']:.1f}",
                f"{100 * r['within_1_sigma']:.1f}", f"{100 * r['within_2_sigma']:.1f}", r["frames"],
            )
            for r in records
            if r["subjects"].startswith("s2 s4 s6 s8") and "_" not in r["landmark"]
        ],
    )  # fmt: skip


def far_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark far``: all photos, single pictures and streams together."""
    streams = {r["person_px"]: r for r in records if r["mode"] == "stream" and r["data"] == "all"}
    rows: list[tuple[object, ...]] = []
    for r in records:
        if r["mode"] != "picture" or r["data"] != "all":
            continue
        low, high = r["found_ci95"]
        stream = ("", "", "")
        if s := streams.get(r["person_px"]):
            frames = f"{s['frames_to_acquire_median']:.0f} / {s['frames_to_acquire_max']}"
            stream = (f"{s['acquired_pct']:.1f}", frames, f"{s['kept_pct']:.1f}")
        rows.append((
            f"{r['person_px']} ({r['distance_m_at_640x480']:.1f})", r["n"],
            f"{r['found_pct']:.1f} ({low:.1f} to {high:.1f})", f"{r['full_frame_found_pct']:.1f}",
            f"{r['landmark_error_torso_median']:.3f}", *stream,
        ))  # fmt: skip
    text = table(
        (
            "person, px (about m)", "composites", "rightly found, % (95 % interval)", "full frame alone, %",
            "landmark error, torsos", "stream: acquired, %", "frames to acquire, median / max", "kept, %",
        ),
        rows,
    )  # fmt: skip
    empty = [r for r in records if r["mode"] == "nobody"]
    if empty:
        false, n = (sum(r[key] for r in empty) for key in ("false_found", "n"))
        text += f"\n\nWalls and furniture without a person: somebody found in {false} of {n} pictures."
    return text


def pose_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark pose``."""
    figures = (("ms_median", 1), ("ms_p95", 1), ("times_litert", 2), ("agreement_px_median", 2))
    return table(
        ("network", "mode", "pictures", "engine", "found", "ms (median)", "p95", "times LiteRT", "apart, px"),
        [
            (
                r["model"], r["mode"], r["data"], r["engine"], f"{r['found']} of {r['frames']}",
                *("" if r[name] is None else f"{r[name]:.{digits}f}" for name, digits in figures),
            )
            for r in records
        ],
    )  # fmt: skip


def camera_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark camera``."""
    figures = ("frames_per_s", "ms_median", "ms_p95", "ms_max", "rss_mb")
    return table(
        ("measure", "expected", "frames a second of one core", "ms (median)", "p95", "at most", "memory, MB"),
        [
            (
                r["measure"], r["expected"],
                *("" if r[name] is None else f"{r[name]:.1f}" for name in figures),
            )
            for r in records
        ],
    )  # fmt: skip


__all__ = [
    "camera_table",
    "far_table",
    "lift_table",
    "monocular_table",
    "operator_table",
    "pose_table",
    "smooth_table",
]
