"""docs/safety.md says what is flown."""

from __future__ import annotations

from pathlib import Path

import pytest

from wigwag.errors import InputError
from wigwag.fly.describe import PARTS, attributes, filled, limits, transitions
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.transitions import TABLE, Event
from wigwag.fly.watches import WATCHES

PAGE = Path(__file__).parents[2] / "docs" / "safety.md"


def test_the_page_is_up_to_date() -> None:
    text = PAGE.read_text("utf-8")
    assert filled(text) == text, "run: python -m wigwag.fly.describe docs/safety.md"


def test_every_row_and_every_limit_is_in_it() -> None:
    text = PAGE.read_text("utf-8")
    assert all(f"**{row.name}**" in text for row in TABLE)
    assert all(f"`{name}`" in text for name in SupervisorConfig.__dataclass_fields__)
    assert all(row.after == "" or f"`{row.after}`)" in transitions() for row in TABLE)


def test_everything_is_said_in_words() -> None:
    assert set(attributes(SupervisorConfig)) == set(SupervisorConfig.__dataclass_fields__)
    assert {mode.name for mode in Mode} == set(attributes(Mode))
    assert all(watch.__doc__ for watch in WATCHES.values())
    commands = {Event.STOP, Event.LAND, Event.LAND_ASKED, Event.TAKE_OFF, Event.MOVE}
    assert set(WATCHES) | commands == set(Event)
    assert "| `min_distance_m` | 2 m |" in limits()


def test_a_page_without_a_place_for_a_table_is_an_error() -> None:
    with pytest.raises(InputError, match="modes: begin"):
        filled("# nothing")
    page = "".join(f"<!-- {name}: begin -->\n<!-- {name}: end -->\n" for name in PARTS)
    assert filled(filled(page)) == filled(page)
