"""Tables of what is measured of recognition: accuracy, few examples, saying no, speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Records = Sequence[Mapping[str, Any]]

PAPER = {
    ("heavy", 27): "98.27", ("heavy", 6): "98.72", ("heavy", 7): "95.56",
    ("encoded", 27): "83.24", ("encoded", 6): "97.44", ("encoded", 7): "86.67",
}  # fmt: skip
"""Accuracy that the paper reports on its random split, per cent."""


def recognition_table(records: Records) -> str:
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
            f"({low:.1f} to {high:.1f}) | {100 * r['macro_f1_mean']:.2f} | {r['ms_per_case_median']:.2f} | "
            f"{r['seeds']} | {paper} |"
        )
    return "\n".join(lines)


def few_shot_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark few-shot``."""
    lines = [
        "| recogniser | whose examples | a gesture | accuracy, % (95 % interval) | enrol, ms | draws |",
        "|---|---|---|---|---|---|",
    ]
    for r in records:
        low, high = (100 * float(v) for v in r["accuracy_ci95"])
        enrol = "" if r["enrol_ms_median"] is None else f"{r['enrol_ms_median']:.0f}"
        lines.append(
            f"| {r['recognizer']} | {r['setting']} | {r['examples']} | {100 * r['accuracy_mean']:.2f} "
            f"({low:.1f} to {high:.1f}) | {enrol} | {r['draws']} |"
        )
    return "\n".join(lines)


def reject_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark reject``: means over draws of which gestures are known."""
    lines = [
        "| recogniser | known / unknown | taught as no gesture | AUROC, % | false accepts at 95 % true, % "
        "| at its own threshold: true, % | false, % | draws |",
        "|---|---|---|---|---|---|---|---|",
    ]
    settings = dict.fromkeys((r["recognizer"], r["known"], r["unknown"], r["background"]) for r in records)
    figures = ("auroc", "false_accept_at_95", "true_accept_at_threshold", "false_accept_at_threshold")
    for setting in settings:
        draws = [
            r for r in records if (r["recognizer"], r["known"], r["unknown"], r["background"]) == setting
        ]
        means = [100 * sum(float(r[f]) for r in draws) / len(draws) for f in figures]
        name, known, unknown, background = setting
        shown = " | ".join(f"{mean:.1f}" for mean in means)
        lines.append(f"| {name} | {known} / {unknown} | {background} | {shown} | {len(draws)} |")
    return "\n".join(lines)


def transfer_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark transfer``."""
    lines = [
        "| recogniser | accuracy, % (95 % interval) | macro F1, % | ms a case | fit, s | seeds |",
        "|---|---|---|---|---|---|",
    ]
    for r in records:
        low, high = (100 * float(v) for v in r["accuracy_ci95"])
        lines.append(
            f"| {r['recognizer']} | {100 * r['accuracy_mean']:.2f} ({low:.1f} to {high:.1f}) | "
            f"{100 * r['macro_f1_mean']:.2f} | {r['ms_per_case_median']:.2f} | {r['fit_s']:.1f} | "
            f"{r['seeds']} |"
        )
    return "\n".join(lines)


def dtw_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark dtw``."""
    lines = ["| case | library | ms a query | times ours |", "|---|---|---|---|"]
    lines += [
        f"| {r['case']} | {r['library']} | {r['ms_per_query_median']:.3f} | {r['times_ours']:.1f} |"
        for r in records
    ]
    return "\n".join(lines)


def gallery_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark gallery``."""
    lines = [
        "| enrolled clips | ms a query (median) | p95 | recall of the true nearest, % | DTW on all, ms |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['size']:,} | {r['ms_per_query_median']:.2f} | {r['ms_per_query_p95']:.2f} | "
        f"{100 * r['recall']:.1f} | {r['ms_exact_median']:.1f} |"
        for r in records
    ]
    return "\n".join(lines)
