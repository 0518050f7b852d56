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


__all__ = ["monocular_table", "operator_table", "smooth_table"]
