"""The README's tables come from the records, and nowhere else."""

import json
import re
from pathlib import Path

import pytest

from wigwag.errors import InputError
from wigwag.evaluate.tables import BEGIN, END, PARTS, fill, stream_table

RECORDS = Path(__file__).parents[2] / "docs" / "records"

LIFT = {
    "landmark": "wrist", "median_abs_mm": 15.1, "bias_mm": 0.0, "beyond_150_mm": 0.034, "missing": 0.001,
    "knock_out": 0.1, "within_1_sigma": 0.663, "within_2_sigma": 0.901, "frames": 1838,
    "subjects": "s2 s4 s6 s8 (not fitted on)",
}  # fmt: skip


def test_tables_stand_between_the_markers(tmp_path: Path) -> None:
    page, records = tmp_path / "README.md", tmp_path / "lift.json"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", "utf-8")
    records.write_text(json.dumps([LIFT, LIFT | {"subjects": "all"}, LIFT | {"landmark": "left_wrist"}]))
    fill(page, {"lift": [records]})
    text = page.read_text("utf-8")
    assert text.startswith("before\n") and text.endswith("after\n") and "old" not in text
    assert text.count("| wrist | 10 | 15.1 | 3.4 | 0.1 | 66.3 | 90.1 | 1838 |") == 1
    assert "left_wrist" not in text


def test_a_page_without_markers_is_left_alone(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("nothing here", "utf-8")
    with pytest.raises(InputError, match="markers"):
        fill(page, {})
    assert page.read_text("utf-8") == "nothing here"


def test_an_unknown_table_is_refused(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    with pytest.raises(InputError, match="Available tables: demo, utd"):
        fill(page, {"nonsense": []})


STREAM = {
    "data": "utd-mhad", "system": "stream", "vocabulary": "6", "corrupt": None, "rate_hz": 30.0,
    "hours": 2.04,    "hours_distinct": 0.26, "events": 760, "event_f1": 0.9712, "action_point_f1": None,
    "detection_rate": 0.956, "false_commands_per_hour": 0.98, "false_commands_ci95": [0.0, 14.2], "twins": 0,
    "false_commands_per_hour_with_twins": 0.98, "jaccard": 0.91, "delay_from_end_s_median": -0.21,
    "decided_before_end": 0.61, "share_seen_median": 0.874, "ms_per_pose_mean": 0.312,
}  # fmt: skip
COST = {
    "data": "cost", "system": "stream", "gestures": 30, "ms_per_pose_mean": 0.41, "ms_per_pose_p99": 1.73,
    "ms_per_pose_max": 9.0, "last_to_first_quarter": 1.01, "rss_mb": 411.2, "rss_growth_mb": 0.3,
}  # fmt: skip


def test_streams_faults_and_cost_have_tables_of_their_own() -> None:
    negative = STREAM | {
        "data": "utkinect", "events": 0, "event_f1": None, "detection_rate": None, "jaccard": None,
        "delay_from_end_s_median": None, "decided_before_end": None, "share_seen_median": None, "twins": 3,
        "false_commands_per_hour_with_twins": 2.4,
    }  # fmt: skip
    points = STREAM | {"data": "msrc12", "event_f1": None, "action_point_f1": 0.761, "jaccard": None}
    faulty = STREAM | {"corrupt": "gap", "f1_lost": 0.04, "false_commands_more": 2, "exceptions": 0}
    text = stream_table([STREAM, negative, points, faulty, COST])
    head = "| stream | utd-mhad | 6 | 2.0 (0.3) | 760 | 0.971 | 95.6 | 1.0 (0.0 to 14.2) | 0.910 |"
    assert head + " -0.21 | 61 | 87 | 0.31 |" in text
    assert (
        "| utkinect | 6 | 2.0 (0.3) |  |  |  | 1.0 (0.0 to 14.2); 2.4 with twins |  |  |  |  | 0.31 |" in text
    )
    assert "| msrc12 | 6 | 2.0 (0.3) | 760 | 0.761 |" in text
    assert "With faults:\n\n" in text and "| gap | 0.040 | +2 in 2.0 h | 0 |" in text
    assert "| stream | 30 | 0.410 | 1.73 | 9.0 | 1.01 | 411 (+0.3) |" in text
    assert "With faults" not in stream_table([STREAM])
    assert "| utd-mhad at 18 Hz |" in stream_table([STREAM | {"rate_hz": 18.0}])
    assert stream_table([COST]).startswith("An hour without a break")


def test_rejection_is_averaged_over_draws_and_nothing_else(tmp_path: Path) -> None:
    page, records = tmp_path / "page.md", tmp_path / "reject.json"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    one = {
        "recognizer": "kernel", "known": 6, "unknown": 21, "background": "other classes", "auroc": 0.99,
        "false_accept_at_95": 0.02, "true_accept_at_threshold": 0.96, "false_accept_at_threshold": 0.01,
    }  # fmt: skip
    other = one | {"known": 21, "unknown": 6, "auroc": 0.5}
    records.write_text(json.dumps([one, one | {"false_accept_at_95": 0.04}, other]))
    fill(page, {"reject": [records]})
    text = page.read_text("utf-8")
    assert "| kernel | 6 / 21 | other classes | 99.0 | 3.0 | 96.0 | 1.0 | 2 |" in text
    assert "| kernel | 21 / 6 | other classes | 50.0 |" in text


def test_engines_and_chain_with_gaps_where_nothing_was_measured(tmp_path: Path) -> None:
    page, pose, camera = tmp_path / "page.md", tmp_path / "pose.json", tmp_path / "camera.json"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    engine = {
        "engine": "litert", "model": "full", "mode": "track", "data": "photos", "frames": 280, "found": 279,
        "timed": 278, "ms_median": 9.31, "ms_p95": 10.1, "times_litert": 1.0, "agreement_px_median": None,
    }  # fmt: skip
    memory = {
        "measure": "memory of a process", "expected": "<= 350 MB", "frames_per_s": None, "ms_median": None,
        "ms_p95": None, "ms_max": None, "rss_mb": 267.4,
    }  # fmt: skip
    pose.write_text(json.dumps([engine]))
    camera.write_text(json.dumps([memory]))
    fill(page, {"pose": [pose], "camera": [camera]})
    text = page.read_text("utf-8")
    assert "| full | track | photos | litert | 279 of 280 | 9.3 | 10.1 | 1.00 |  |" in text
    assert "| memory of a process | <= 350 MB |  |  |  |  | 267.4 |" in text


def test_passers_by_are_summed_over_distances(tmp_path: Path) -> None:
    page, records = tmp_path / "perception.md", tmp_path / "operator.json"
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    row = {
        "condition": "dark", "distance_m": 4.0, "crossings": 5, "kept": 5, "frames": 900,
        "frames_visible": 800, "frames_operator_pct": 100.0, "frames_of_passerby": 0,
        "reacquired_s_max": 0.3,
    }  # fmt: skip
    far = row | {"distance_m": 8.0, "kept": 4, "frames_visible": 200, "frames_operator_pct": 50.0}
    other = row | {"condition": "dusk", "reacquired_s_max": None, "frames_of_passerby": 2}
    records.write_text(json.dumps([row, far, other]))
    fill(page, {"operator": [records]})
    text = page.read_text("utf-8")
    assert "| condition | kept, 4 m | kept, 8 m |" in text
    assert "| dark | 5 of 5 | 4 of 5 | 90.0 | 0.30 | 0 | 1800 |" in text
    assert "| dusk | 5 of 5 |  | 100.0 |  | 2 | 900 |" in text
    assert "| **all** | 10 of 10 | 4 of 5 | 94.4 | 0.30 | 2 | 2700 |" in text


def test_smoothing_and_people_without_depth_have_tables(tmp_path: Path) -> None:
    page, smooth, monocular = (tmp_path / name for name in ("p.md", "s.json", "m.json"))
    page.write_text(f"{BEGIN}\n{END}\n", "utf-8")
    spread = {
        f"{n}_{part}": v for n, v in (("lag_ms", 3.0), ("overshoot", 0.01)) for part in ("median", "p95")
    }
    errors = {"rms_mm": 20.0, "rest_rms_mm": 15.0, "rest_jitter_mm": 3.0, "heel_rms_mm": 40.0}
    record = spread | errors | {"filter": "none", "rate_hz": 30.0, "lag_ms_max": 9.0, "overshoot_max": 0.02}
    smooth.write_text(json.dumps([record]))
    monocular.write_text(json.dumps([{
        "distance_m": 4.0, "way": "stature stated", "found": 0.995, "distance_error_median": 0.021,
        "distance_error_p95": 0.07, "landmark_mm_median": 61.2, "within_1_sigma": 0.7, "within_2_sigma": 0.96,
    }]))  # fmt: skip
    fill(page, {"smooth": [smooth], "monocular": [monocular]})
    text = page.read_text("utf-8")
    assert "| none | 30 | 3.0 / 3.0 / 9.0 | 1.0 / 1.0 / 2.0 | 20.0 | 15.0 | 3.0 | 40.0 |" in text
    assert "| 4 | stature stated | 99.5 | 2.1 / 7.0 | 61 | 70 | 96 |" in text


TEACH = {
    "kind": "KernelRecognizer", "gestures": ["goalpost", "crane"], "teacher": 11, "performer": 12,
    "right": 40, "shown": 40, "wrong": 0, "false_commands": 1, "commands_shown": 20, "commands_right": 19,
    "commands_right_before": 18,
}  # fmt: skip


def test_taught_gestures_are_counted_a_pair_of_people_and_together() -> None:
    lines = PARTS["teach"][1]([TEACH, TEACH | {"teacher": 13, "performer": 14, "right": 38}]).splitlines()
    new = "| KernelRecognizer | goalpost, crane |"
    assert lines[2] == f"{new} 11, 12 | 40 of 40 | 91 to 100 | 0 | 1 | 18 of 20 | 19 of 20 |"
    assert lines[4] == f"{new} **all** | 78 of 80 | 91 to 99 | 0 | 2 | 36 of 40 | 38 of 40 |"
    assert len(PARTS["teach"][1]([TEACH]).splitlines()) == 3, "one pair is all there is"


def test_recordings_have_a_row_a_kind_and_a_sentence_of_kills() -> None:
    cost = {
        "measure": "cost", "mb_ten_minutes": 369.64, "pictures": "jpeg", "depth": False, "seconds": 600.0,
        "loop_ms_mean": 0.0479, "loop_ms_p99": 0.2122, "writer_ms_mean": 2.2066,
    }  # fmt: skip
    kills = {
        "measure": "kills", "kills": 100, "opened": 99, "needed_repair": 3, "decided_alike": 98,
        "lost_s_median": 0.267, "lost_s_max": 0.8,
    }  # fmt: skip
    table = PARTS["record"][1]([cost, kills])
    assert "| jpeg | no | 370 | 0.048 | 0.212 | 2.21 | 600 |" in table
    assert table.splitlines()[-1].startswith("Killed (`kill -9`) at random moments: 99 of 100 files open")
    assert "lost 0.27 s in the median, 0.80 s at most; 98 are decided again alike" in table


def test_viewers_and_missions_have_tables() -> None:
    load = {
        "load": "viewers", "viewers": 10, "turns": 600, "rate_hz": 31.25, "loop_ms": 12.3, "process_ms": 14.0,
        "rate_left": 0.981, "rate_left_low": 0.96, "rate_left_high": 1.002,
    }  # fmt: skip
    assert "| 10 viewers | 31.2 | 98.1 (96.0 to 100.2) | 12.30 | 14.00 | 600 |" in PARTS["console"][1]([load])
    alone = PARTS["console"][1]([load | {"load": "nobody", "viewers": 0}])
    assert "| nobody | 31.2 |" in alone
    found = {"vehicle": "PX4", "what": "left", "value": 0.04321, "asked": "15 %", "good": True}
    rows = PARTS["mission"][1]([found, found | {"value": None, "good": False}]).splitlines()
    assert rows[2:] == ["| PX4 | left | 0.0432 % | 15 % | ok |", "| PX4 | left | never | 15 % | **missed** |"]
    landed = {"vehicle": "PX4", "what": "land", "value": None, "asked": "disarmed", "good": True}
    assert "| land | done |" in PARTS["mission"][1]([landed])


@pytest.mark.parametrize("page", sorted(RECORDS.glob("*.json")), ids=lambda path: path.stem)
def test_published_records_can_be_laid_out_and_name_no_machine(page: Path) -> None:
    text = page.read_text("utf-8")
    assert not re.search(r"/(home|work|tmp|root|Users)/", text)
    name, content = page.stem.partition(".")[0], json.loads(text)
    if name in PARTS:
        assert PARTS[name][1](content if isinstance(content, list) else [content]).count("\n") >= 2
