"""Tables of the README and the docs, generated from what the commands wrote.

Run ``python -m wigwag.evaluate.tables README.md demo=a.json,b.json utd=utd.json lift=lift.json`` to write
them between the page's markers.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from wigwag.errors import InputError
from wigwag.evaluate.stream.tables import stream_table
from wigwag.evaluate.tables_pose import monocular_table, operator_table, smooth_table

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
            f"({low:.1f} to {high:.1f}) | {100 * r['macro_f1_mean']:.2f} | {r['ms_per_case_median']:.2f} | "
            f"{r['seeds']} | {paper} |"
        )
    return "\n".join(lines)


def lift_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def few_shot_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def reject_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def transfer_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def dtw_table(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag benchmark dtw``."""
    lines = ["| case | library | ms a query | times ours |", "|---|---|---|---|"]
    lines += [
        f"| {r['case']} | {r['library']} | {r['ms_per_query_median']:.3f} | {r['times_ours']:.1f} |"
        for r in records
    ]
    return "\n".join(lines)


def gallery_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def far_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def faults_table(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag benchmark faults``."""
    lines = [
        "| fault | ended as documented | end | within, s | at most, s | nearest to the person, m |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['fault']} | {r['ended_as_documented']} of {r['runs']} | {r['end_state']} | "
        f"{r['documented_s']:g} | {r['time_s_max']:.1f} | {r['nearest_m']:.2f} |"
        for r in records
    ]
    return "\n".join(lines)


def follow_table(records: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of ``wigwag benchmark follow``."""
    lines = [
        "| vehicle | bearing error, mean (worst run) | distance error, mean (worst run) | commands miss "
        "their end by, mean | within 15 %, % | runs |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['vehicle']} | {r['bearing_deg_mean']:.2f}° ({r['bearing_deg_worst_run']:.2f}°) | "
        f"{r['distance_m_mean']:.2f} m ({r['distance_m_worst_run']:.2f} m) | "
        f"{100 * r['command_error_mean']:.1f} % | {100 * r['commands_within_15']:.0f} | {r['runs']} |"
        for r in records
    ]
    return "\n".join(lines)


def pose_table(records: Sequence[Mapping[str, Any]]) -> str:
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


def camera_table(records: Sequence[Mapping[str, Any]]) -> str:
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


Records = Sequence[Mapping[str, Any]]

PARTS: dict[str, tuple[str, Callable[[Records], str]]] = {
    "demo": ("The whole chain, simulated (`wigwag demo --seed N`):", demo_table),
    "utd": (
        "UTD-MHAD skeletons (`wigwag benchmark utd-mhad --data DIR --json FILE`), one thread, from a raw "
        "clip to a label. On the random split every test person is also in training; cross-subject and "
        "leave-one-subject-out meet people never seen:",
        recognition_table,
    ),
    "lift": (
        "Lifting on UTD-MHAD's real Kinect depth (`wigwag benchmark lift --data DIR --json FILE`), "
        "offsets and stated standard deviations fitted on subjects 1, 3, 5, 7 and judged on 2, 4, 6, 8 "
        "(Gaussian errors would lie within one by 68 %, within two by 95 %):",
        lift_table,
    ),
    "far": (
        "Small people in clutter (`wigwag benchmark far --data DIR --json FILE`), the operator photos shrunk "
        "and set before other photos' rooms, 640x480:",
        far_table,
    ),
    "pose": (
        "Pose engines in one run on one core (`wigwag benchmark pose --photos DIR --models lite full heavy "
        "--json FILE`), processor time. `detect`: a picture that stands for itself; `track`: somebody is "
        "followed; `search`: nobody is there. `apart`: between the engines, median over all landmarks:",
        pose_table,
    ),
    "camera": (
        "From a frame with depth, 640x480, to the operator's 3-D pose, one core (`wigwag benchmark camera "
        "--json FILE`):",
        camera_table,
    ),
    "operator": (
        "The operator among passers-by (`wigwag benchmark operator --json FILE`), rendered: kept means "
        "handed on again within 1.5 s after the passer-by is clear (11 s where the operator had walked off "
        "and has to engage again), and nobody else's pose meanwhile:",
        operator_table,
    ),
    "smooth": (
        "The filter in space (`wigwag benchmark smooth --data DIR --json FILE`), UTD-MHAD's fastest swings "
        "by people 2, 4, 6, 8; lag and overshoot without noise, errors with it:",
        smooth_table,
    ),
    "monocular": (
        "People without depth (`wigwag benchmark monocular --json FILE`), rendered, beside the same "
        "people by depth:",
        monocular_table,
    ),
    "few-shot": (
        "Few examples (`wigwag benchmark few-shot --data DIR --json FILE`), UTD-MHAD, 27 classes, test "
        "people 2, 4, 6, 8. `others`: so many examples a gesture from people 1, 3, 5, 7; `own+others`: "
        "everything from those, and so many of the person's own, enrolled; `own`: the person's own alone:",
        few_shot_table,
    ),
    "reject": (
        "Saying no (`wigwag benchmark reject --data DIR --json FILE`), UTD-MHAD, taught by people 1, 3, 5, "
        "7, judged on 2, 4, 6, 8:",
        reject_table,
    ),
    "transfer": (
        "Another data set, no setting touched (`wigwag benchmark transfer --data DIR --json FILE`): "
        "MSR-Action3D, odd subjects, 20 actions, leaving one person out:",
        transfer_table,
    ),
    "stream": (
        "Commands in streams (`wigwag benchmark stream --data-dir DIR --json FILE`). `utd-mhad`: streams "
        "assembled of people 2, 4, 6, 8, taught by 1, 3, 5, 7; `own`: of a person who enrolled one example "
        "of each gesture; `msrc12`: its 12 gestures, people left out in five folds, F1 of action points "
        "within 333 ms; the others hold no command. The interval is the exact Poisson one of a single pass "
        "over the material (distinct hours). Twins are everyday movements that are a gesture by another "
        "name, such as standing up:",
        stream_table,
    ),
    "dtw": (
        "Dynamic time warping of one query against 688 references of 64 frames, one thread, the libraries in "
        "turn in one process (`wigwag benchmark dtw --data DIR --json FILE`):",
        dtw_table,
    ),
    "faults": (
        "Faults in flight (`wigwag benchmark faults --json FILE`):",
        faults_table,
    ),
    "follow": (
        "A person who walks an arc at 0.75 m/s for a minute, and every command, with late frames, noise and "
        "gusts (`wigwag benchmark follow --json FILE`):",
        follow_table,
    ),
    "gallery": (
        "A growing gallery (`wigwag benchmark gallery --data DIR --json FILE`), varied copies of UTD-MHAD's "
        "training clips, queries by its test clips:",
        gallery_table,
    ),
}
"""What can stand between the markers: its heading line, and what lays its records out."""


def fill(page: Path, parts: Mapping[str, Sequence[Path]]) -> None:
    """Write tables between a page's markers, in the order they are named.

    Args:
        page: A Markdown page.
        parts: Names of ``PARTS`` and the files their records are in, joined in that order.

    Raises:
        InputError: If the markers are missing, or there is no such part.
    """
    text = page.read_text("utf-8")
    if BEGIN not in text or END not in text:
        raise InputError(f"{page}: expected the markers {BEGIN} and {END}, but they are not there.")
    sections = []
    for name, files in parts.items():
        if name not in PARTS:
            raise InputError(f"There is no table {name!r}. Available tables: {', '.join(PARTS)}.")
        note, lay_out = PARTS[name]
        read = [json.loads(f.read_text("utf-8")) for f in files]
        records = [
            record for content in read for record in (content if isinstance(content, list) else [content])
        ]
        sections.append(f"{note}\n\n{lay_out(records)}")
    before, after = text[: text.index(BEGIN)], text[text.index(END) :]
    page.write_text(before + BEGIN + "\n" + "\n\n".join(sections) + "\n" + after, encoding="utf-8")


if __name__ == "__main__":
    target, *named = sys.argv[1:]
    fill(Path(target), {n.split("=")[0]: [Path(f) for f in n.split("=")[1].split(",")] for n in named})
