"""Tables of the README, generated from what the commands wrote.

Run ``python -m wigwag.evaluate.tables README.md utd=utd.json lift=lift.json demo=a.json,b.json`` to write
them between the README's markers.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from wigwag.errors import InputError

BEGIN, END = "<!-- results: begin -->", "<!-- results: end -->"

PAPER = {
    ("heavy", 27): "98.27", ("heavy", 6): "98.72", ("heavy", 7): "95.56",
    ("encoded", 27): "83.24", ("encoded", 6): "97.44", ("encoded", 7): "86.67",
}  # fmt: skip
"""Accuracy that the paper reports on its random split, per cent."""


def recognition_table(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag benchmark utd-mhad``."""
    lines = [
        "| recogniser | protocol | classes | accuracy, % (95 % interval) | macro F1, % | ms a case | seeds "
        "| paper |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in records:
        low, high = (100 * float(v) for v in r["accuracy_ci95"])
        classes = int(r["classes"])
        paper = PAPER.get((r["recognizer"], classes), "") if r["protocol"] == "random" else ""
        lines.append(
            f"| {r['recognizer']} | {r['protocol']} | {classes} | {100 * r['accuracy_mean']:.2f} "
            f"({low:.1f} to {high:.1f}) | {100 * r['macro_f1_mean']:.2f} | {r['ms_per_case_median']:.1f} | "
            f"{r['seeds']} | {paper} |"
        )
    return "\n".join(lines)


def lift_table(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag benchmark lift``: people on whom nothing was fitted."""
    lines = [
        "| landmark | median error, mm | beyond 150 mm, % | missing, % | frames |",
        "|---|---|---|---|---|",
    ]
    for r in records:
        if not r["subjects"].startswith("s2 s4 s6 s8") or "_" in r["landmark"]:
            continue
        lines.append(
            f"| {r['landmark']} | {r['median_abs_mm']:.1f} | {100 * r['beyond_150_mm']:.1f} | "
            f"{100 * r['missing']:.1f} | {r['frames']} |"
        )
    return "\n".join(lines)


def demo_table(summaries: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag demo``, a line a run."""
    lines = [
        "| motion, seed | right | wrong | false (others shown) | found | bearing error | distance error | "
        "frames a second of one core | memory |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for s in summaries:
        g, f = s["gestures"], s["follow"]
        b, d = f["bearing_error_deg"], f["distance_error_m"]
        lines.append(
            f"| {s['motion']}, {s['seed']} | {g['recognised']} of {g['shown']} | {g['wrong']} | "
            f"{s['false_commands']} ({s['others_shown']}) | {100 * s['pose']['found']:.1f} % | "
            f"{b['mean']:.2f}° mean, {b['max']:.1f}° max | {d['mean']:.2f} m mean, {d['max']:.2f} m max | "
            f"{s['loop']['hz']:.0f} | {s['rss_mb']} MB |"
        )
        if "clips" in s:
            c = s["clips"]
            lines.append(
                f"| {s['motion']}, one by one | {c['right']} of {c['shown']} | {c['wrong']} | | | | | | |"
            )
    return "\n".join(lines)


def fill(readme: Path, parts: Mapping[str, Sequence[Path]]) -> None:
    """Write the tables between the README's markers.

    Args:
        readme: The page.
        parts: Files under the names ``utd``, ``lift`` and ``demo``; what is absent is left out.

    Raises:
        InputError: If the markers are missing.
    """
    page = readme.read_text("utf-8")
    if BEGIN not in page or END not in page:
        raise InputError(f"{readme}: expected the markers {BEGIN} and {END}, but they are not there.")
    sections = []
    if files := parts.get("demo"):
        table = demo_table([json.loads(f.read_text("utf-8")) for f in files])
        sections.append(f"The whole chain, simulated (`wigwag demo --seed N`):\n\n{table}")
    if files := parts.get("utd"):
        records = json.loads(files[0].read_text("utf-8"))
        note = (
            "UTD-MHAD skeletons (`wigwag benchmark utd-mhad --data DIR --json FILE`), one thread, from "
            "a raw clip to a label. On the random split every test person is also in training; cross-subject "
            "and leave-one-subject-out meet people never seen:"
        )
        sections.append(f"{note}\n\n{recognition_table(records)}")
    if files := parts.get("lift"):
        records = json.loads(files[0].read_text("utf-8"))
        note = (
            "Lifting on UTD-MHAD's real Kinect depth (`wigwag benchmark lift --data DIR --json FILE`), "
            "offsets fitted on subjects 1, 3, 5, 7 and judged on 2, 4, 6, 8:"
        )
        sections.append(f"{note}\n\n{lift_table(records)}")
    before, after = page[: page.index(BEGIN)], page[page.index(END) :]
    readme.write_text(before + BEGIN + "\n" + "\n\n".join(sections) + "\n" + after, encoding="utf-8")


if __name__ == "__main__":
    target, *named = sys.argv[1:]
    fill(Path(target), {n.split("=")[0]: [Path(f) for f in n.split("=")[1].split(",")] for n in named})
