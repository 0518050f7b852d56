"""Tables of what is measured of perception: passers-by, smoothing, people without depth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Records = Sequence[Mapping[str, Any]]


def operator_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark operator``: a row a condition, all distances together."""
    distances = sorted({float(r["distance_m"]) for r in records})
    lines = [
        "| condition | " + " | ".join(f"kept, {d:g} m" for d in distances) + " | found, % of frames in view "
        "| back in view until handed on, s, at most | frames of passers-by handed on | frames |",
        "|---|" + "---|" * (len(distances) + 4),
    ]
    for name in dict.fromkeys(r["condition"] for r in records):
        lines.append(_condition_row(name, [r for r in records if r["condition"] == name], distances))
    lines.append(_condition_row("**all**", records, distances))
    return "\n".join(lines)


def _condition_row(name: str, rows: Records, distances: Sequence[float]) -> str:
    cells = []
    for distance in distances:
        here = [r for r in rows if r["distance_m"] == distance]
        kept, crossings = (sum(r[key] for r in here) for key in ("kept", "crossings"))
        cells.append(f"{kept} of {crossings}" if here else "")
    shown = sum(r["frames_visible"] for r in rows)
    found = sum(r["frames_operator_pct"] * r["frames_visible"] for r in rows) / max(shown, 1)
    back = [r["reacquired_s_max"] for r in rows if r["reacquired_s_max"] is not None]
    cells += [
        f"{found:.1f}",
        f"{max(back):.2f}" if back else "",
        str(sum(r["frames_of_passerby"] for r in rows)),
        str(sum(r["frames"] for r in rows)),
    ]
    return f"| {name} | " + " | ".join(cells) + " |"


def smooth_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark smooth``."""
    lines = [
        "| filter | Hz | lag, ms, median / 95 % / greatest | overshoot, %, likewise | RMS, mm | at rest, mm "
        "| jitter, mm | heels, mm |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in records:
        lag, over = (
            " / ".join(f"{scale * r[f'{name}_{part}']:.1f}" for part in ("median", "p95", "max"))
            for name, scale in (("lag_ms", 1), ("overshoot", 100))
        )
        rest = " | ".join(f"{r[n]:.1f}" for n in ("rms_mm", "rest_rms_mm", "rest_jitter_mm", "heel_rms_mm"))
        lines.append(f"| {r['filter']} | {r['rate_hz']:g} | {lag} | {over} | {rest} |")
    return "\n".join(lines)


def monocular_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark monocular``."""
    lines = [
        "| m | placed by | found, % | distance error, %, median / 95 % | landmarks from the hips, mm "
        "| within 1 sd stated, % | within 2 sd, % |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in records:
        lines.append(
            f"| {r['distance_m']:g} | {r['way']} | {100 * r['found']:.1f} "
            f"| {100 * r['distance_error_median']:.1f} / {100 * r['distance_error_p95']:.1f} "
            f"| {r['landmark_mm_median']:.0f} | {100 * r['within_1_sigma']:.0f} "
            f"| {100 * r['within_2_sigma']:.0f} |"
        )
    return "\n".join(lines)


def lift_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark lift``: people on whom nothing was fitted."""
    lines = [
        "| landmark | pixels knocked out, % | median error, mm | beyond 150 mm, % | missing, % "
        "| within 1 sd stated, % | within 2 sd, % | frames |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in records:
        if not r["subjects"].startswith("s2 s4 s6 s8") or "_" in r["landmark"]:
            continue
        lines.append(
            f"| {r['landmark']} | {100 * r['knock_out']:.0f} | {r['median_abs_mm']:.1f} | "
            f"{100 * r['beyond_150_mm']:.1f} | {100 * r['missing']:.1f} | {100 * r['within_1_sigma']:.1f} | "
            f"{100 * r['within_2_sigma']:.1f} | {r['frames']} |"
        )
    return "\n".join(lines)


def far_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark far``: all photos, single pictures and streams together."""
    lines = [
        "| person, px (about m) | composites | rightly found, % (95 % interval) | full frame alone, % "
        "| landmark error, torsos | stream: acquired, % | frames to acquire, median / max | kept, % |",
        "|---|---|---|---|---|---|---|---|",
    ]
    streams = {r["person_px"]: r for r in records if r["mode"] == "stream" and r["data"] == "all"}
    for r in records:
        if r["mode"] != "picture" or r["data"] != "all":
            continue
        low, high = r["found_ci95"]
        line = (
            f"| {r['person_px']} ({r['distance_m_at_640x480']:.1f}) | {r['n']} | {r['found_pct']:.1f} "
            f"({low:.1f} to {high:.1f}) | {r['full_frame_found_pct']:.1f} "
            f"| {r['landmark_error_torso_median']:.3f} "
        )
        s = streams.get(r["person_px"])
        line += (
            "| | | |"
            if s is None
            else f"| {s['acquired_pct']:.1f} | {s['frames_to_acquire_median']:.0f} / "
            f"{s['frames_to_acquire_max']} | {s['kept_pct']:.1f} |"
        )
        lines.append(line)
    empty = [r for r in records if r["mode"] == "nobody"]
    if empty:
        false, n = (sum(r[key] for r in empty) for key in ("false_found", "n"))
        lines += ["", f"Walls and furniture without a person: somebody found in {false} of {n} pictures."]
    return "\n".join(lines)


def pose_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark pose``."""
    lines = [
        "| network | mode | pictures | engine | found | ms (median) | p95 | times LiteRT | apart, px |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in records:
        figures = " | ".join(
            "" if r[name] is None else f"{r[name]:.{digits}f}"
            for name, digits in (
                ("ms_median", 1), ("ms_p95", 1), ("times_litert", 2), ("agreement_px_median", 2),
            )
        )  # fmt: skip
        lines.append(
            f"| {r['model']} | {r['mode']} | {r['data']} | {r['engine']} | {r['found']} of {r['frames']} | "
            f"{figures} |"
        )
    return "\n".join(lines)


def camera_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark camera``."""
    lines = [
        "| measure | expected | frames a second of one core | ms (median) | p95 | at most | memory, MB |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in records:
        names = ("frames_per_s", "ms_median", "ms_p95", "ms_max", "rss_mb")
        figures = " | ".join("" if r[name] is None else f"{r[name]:.1f}" for name in names)
        lines.append(f"| {r['measure']} | {r['expected']} | {figures} |")
    return "\n".join(lines)


__all__ = ["monocular_table", "operator_table", "smooth_table"]
