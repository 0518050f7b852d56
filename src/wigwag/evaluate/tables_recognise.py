"""Tables of what is measured of recognition: accuracy, few examples, saying no, speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wigwag.evaluate.markdown import Records, table

PAPER = {
    ("heavy", 27): "98.27", ("heavy", 6): "98.72", ("heavy", 7): "95.56",
    ("encoded", 27): "83.24", ("encoded", 6): "97.44", ("encoded", 7): "86.67",
}  # fmt: skip
"""Accuracy that the paper reports on its random split, per cent."""


def recognition_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark utd-mhad``."""
    rows = []
    for r in records:
        classes = int(r["classes"])
        paper = PAPER.get((r["recognizer"], classes), "") if r["protocol"] == "random" else ""
        rows.append((
            r["recognizer"], r["protocol"], classes, _accuracy(r), f"{100 * r['macro_f1_mean']:.2f}",
            f"{r['ms_per_case_median']:.2f}", r["seeds"], paper,
        ))  # fmt: skip
    return table(
        (
            "recogniser", "protocol", "classes", "accuracy, % (95 % interval)", "macro F1, %", "ms a case",
            "seeds", "paper",
        ),
        rows,
    )  # fmt: skip


def few_shot_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark few-shot``."""
    return table(
        ("recogniser", "whose examples", "a gesture", "accuracy, % (95 % interval)", "enrol, ms", "draws"),
        [
            (
                r["recognizer"], r["setting"], r["examples"], _accuracy(r),
                "" if r["enrol_ms_median"] is None else f"{r['enrol_ms_median']:.0f}", r["draws"],
            )
            for r in records
        ],
    )  # fmt: skip


def reject_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark reject``: means over draws of which gestures are known."""
    settings = dict.fromkeys((r["recognizer"], r["known"], r["unknown"], r["background"]) for r in records)
    figures = ("auroc", "false_accept_at_95", "true_accept_at_threshold", "false_accept_at_threshold")
    rows = []
    for setting in settings:
        draws = [
            r for r in records if (r["recognizer"], r["known"], r["unknown"], r["background"]) == setting
        ]
        means = [100 * sum(float(r[f]) for r in draws) / len(draws) for f in figures]
        name, known, unknown, background = setting
        shown = [f"{mean:.1f}" for mean in means]
        rows.append((name, f"{known} / {unknown}", background, *shown, len(draws)))
    return table(
        (
            "recogniser", "known / unknown", "taught as no gesture", "AUROC, %",
            "false accepts at 95 % true, %", "at its own threshold: true, %", "false, %", "draws",
        ),
        rows,
    )  # fmt: skip


def transfer_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark transfer``."""
    return table(
        ("recogniser", "accuracy, % (95 % interval)", "macro F1, %", "ms a case", "fit, s", "seeds"),
        [
            (
                r["recognizer"], _accuracy(r), f"{100 * r['macro_f1_mean']:.2f}",
                f"{r['ms_per_case_median']:.2f}", f"{r['fit_s']:.1f}", r["seeds"],
            )
            for r in records
        ],
    )  # fmt: skip


def dtw_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark dtw``."""
    return table(
        ("case", "library", "ms a query", "times ours"),
        [
            (r["case"], r["library"], f"{r['ms_per_query_median']:.3f}", f"{r['times_ours']:.1f}")
            for r in records
        ],
    )


def gallery_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark gallery``."""
    return table(
        (
            "enrolled clips", "ms a query (median)", "p95", "recall of the true nearest, %",
            "DTW on all, ms",
        ),
        [
            (
                f"{r['size']:,}", f"{r['ms_per_query_median']:.2f}", f"{r['ms_per_query_p95']:.2f}",
                f"{100 * r['recall']:.1f}", f"{r['ms_exact_median']:.1f}",
            )
            for r in records
        ],
    )  # fmt: skip


def _accuracy(record: Mapping[str, Any]) -> str:
    """Return the accuracy and its interval, per cent."""
    low, high = (100 * float(v) for v in record["accuracy_ci95"])
    return f"{100 * record['accuracy_mean']:.2f} ({low:.1f} to {high:.1f})"


__all__ = [
    "dtw_table",
    "few_shot_table",
    "gallery_table",
    "recognition_table",
    "reject_table",
    "transfer_table",
]
