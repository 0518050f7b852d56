"""A table's columns count themselves."""

import pytest

from wigwag.evaluate.markdown import table


def test_the_line_below_the_columns_has_as_many() -> None:
    lines = table(("what", "m", ""), [("near", 2.8, ""), ("far", 5.5, "ok")]).splitlines()
    assert lines == ["| what | m |  |", "|---|---|---|", "| near | 2.8 |  |", "| far | 5.5 | ok |"]


def test_a_row_with_a_cell_too_few_is_refused() -> None:
    with pytest.raises(ValueError, match="Expected 2 cells, one a column, but got 1"):
        table(("what", "m"), [("near",)])
