"""docs/flights.md lists what is written."""

from __future__ import annotations

import re
from pathlib import Path

from wigwag.record.turns import FOXGLOVE_CHANNELS, JSON_CHANNELS, NOTE, VERSION


def test_every_channel_is_documented_with_its_schema() -> None:
    text = (Path(__file__).parents[2] / "docs" / "flights.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(/[^`]+)` \| (.+?) \|", text, re.MULTILINE))
    assert set(rows) == {*FOXGLOVE_CHANNELS, *JSON_CHANNELS, NOTE}
    for topic, name in FOXGLOVE_CHANNELS.items():
        assert f"foxglove.{name}" in rows[topic]
    for topic, kind in JSON_CHANNELS.items():
        assert f"wigwag.{kind.__name__}" in rows[topic]
    assert f"version {VERSION}" in text
