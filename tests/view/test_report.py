"""The report holds all it shows, the film byte for byte."""

import base64
import re
from pathlib import Path

import numpy as np
import pytest

from wigwag.evaluate.flight import FlightLog, Row
from wigwag.view.report import Still, jpeg, write_report

SUMMARY = {
    "motion": "gestures", "seed": 3, "recognizer": "heavy", "duration_s": 2.0, "version": "0", "rss_mb": 1,
    "gestures": {"shown": 1, "recognised": 1, "wrong": 0, "missed": 0}, "false_commands": 0,
    "others_shown": 0, "pose": {"found": 1.0}, "loop": {"hz": 50.0}, "follow": None,
}  # fmt: skip


def flight() -> FlightLog:
    rows = [
        Row(t / 30, True, True, 1.0, 0.1, (0.0, 0.0, 1.5), (4.0, 0.01 * t, 0.0), 10.0, 20.0, "following")
        for t in range(60)
    ]
    return FlightLog(rows=rows)


@pytest.mark.parametrize("size", [0, 1, 3 * 2**16, 3 * 2**16 + 1, 500_000])
def test_the_film_comes_back_byte_for_byte(tmp_path: Path, size: int) -> None:
    film, page = tmp_path / "demo.mp4", tmp_path / "report.html"
    film.write_bytes(np.random.default_rng(size).bytes(size))
    write_report(page, SUMMARY, flight(), [], film)
    found = re.search(r'src="data:video/mp4;base64,([^"]*)"', page.read_text("utf-8"))
    assert found is not None
    assert base64.b64decode(found[1], validate=True) == film.read_bytes()


def test_holds_stills_and_four_plots_and_asks_for_nothing_else(tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    still = Still("1.0 s: <land>", jpeg(np.full((480, 640, 3), 90, np.uint8)))
    write_report(page, SUMMARY, flight(), [still])
    text = page.read_text("utf-8")
    assert text.count("<svg") == 4
    assert "1.0 s: &lt;land&gt;" in text
    assert "<video" not in text
    assert not re.search(r'(?:src|href)="https?:', text)
    assert text.rstrip().endswith("</html>")
