"""Tables of what is measured of the product: teaching, recordings, the console, a whole flight."""

from __future__ import annotations

from wigwag.evaluate.markdown import Records, table
from wigwag.evaluate.metrics import wilson_interval


def teach_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark teach``: a row a pair of people, and one of all."""
    rows = []
    for kind in dict.fromkeys(r["kind"] for r in records):
        pairs = [r for r in records if r["kind"] == kind]
        rows += [_teach_row(f"{r['teacher']}, {r['performer']}", [r]) for r in pairs]
        if len(pairs) > 1:
            rows.append(_teach_row("**all**", pairs))
    return table(
        (
            "model", "gestures", "teacher, performer", "recognised", "95 % interval, %", "wrong",
            "false commands", "the ten commands, before", "the ten commands, after",
        ),
        rows,
    )  # fmt: skip


def _teach_row(who: str, rows: Records) -> tuple[object, ...]:
    right, shown, wrong, false, before, after, commands = (
        sum(int(r[key]) for r in rows)
        for key in (
            "right", "shown", "wrong", "false_commands", "commands_right_before", "commands_right",
            "commands_shown",
        )
    )  # fmt: skip
    low, high = wilson_interval(right, shown)
    gestures = ", ".join(dict.fromkeys(name for r in rows for name in r["gestures"]))
    return (
        rows[0]["kind"], gestures, who, f"{right} of {shown}", f"{100 * low:.0f} to {100 * high:.0f}",
        wrong, false, f"{before} of {commands}", f"{after} of {commands}",
    )  # fmt: skip


def record_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark record``, and below it what kills left."""
    costs = table(
        (
            "pictures", "depth", "MB in 10 minutes", "ms a frame in the loop, mean", "p99",
            "ms a frame in the writer, mean", "seconds measured",
        ),
        [
            (
                r["pictures"], "yes" if r["depth"] else "no", f"{r['mb_ten_minutes']:.0f}",
                f"{r['loop_ms_mean']:.3f}", f"{r['loop_ms_p99']:.3f}", f"{r['writer_ms_mean']:.2f}",
                f"{r['seconds']:.0f}",
            )
            for r in records
            if r["measure"] == "cost"
        ],
    )  # fmt: skip
    kills = [
        f"Killed (`kill -9`) at random moments: {r['opened']} of {r['kills']} files open in the mcap "
        f"library's own reader, {r['needed_repair']} needed a repair; lost "
        f"{r['lost_s_median']:.2f} s in the median, {r['lost_s_max']:.2f} s at most; "
        f"{r['decided_alike']} are decided again alike."
        for r in records
        if r["measure"] != "cost"
    ]
    return "\n\n".join([costs, *kills])


def console_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark console``."""
    rows = []
    for r in records:
        who = f"{r['viewers']} viewers" if r["viewers"] else r["load"]
        low, high = 100 * r["rate_left_low"], 100 * r["rate_left_high"]
        left = f"{100 * r['rate_left']:.1f} ({low:.1f} to {high:.1f})"
        costs = (f"{r['loop_ms']:.2f}", f"{r['process_ms']:.2f}", r["turns"])
        rows.append((who, f"{r['rate_hz']:.1f}", left, *costs))
    return table(
        (
            "who looks on", "turns a second", "of it left, % (95 % interval)", "loop, ms a turn",
            "process, ms a turn", "turns",
        ),
        rows,
    )  # fmt: skip


def mission_table(records: Records) -> str:
    """Return the table of ``wigwag benchmark mission``: a row a finding."""
    rows = []
    for r in records:
        if r["value"] is None:  # nothing to measure: it was done, or it was not
            flown = "done" if r["good"] else "never"
        else:
            unit = next((u for u in ("%", "degrees", "m") if u in r["asked"].split()), "")
            flown = f"{r['value']:.3g} {unit}".rstrip()
        rows.append((r["vehicle"], r["what"], flown, r["asked"], "ok" if r["good"] else "**missed**"))
    return table(("vehicle", "what", "flown", "asked", ""), rows)


__all__ = ["console_table", "mission_table", "record_table", "teach_table"]
