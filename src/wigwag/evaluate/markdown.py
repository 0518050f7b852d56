"""Markdown tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

Records = Sequence[Mapping[str, Any]]
"""What a benchmark wrote: a row a measurement, by the names of its figures."""


def table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table, without a line break at its end.

    Args:
        columns: What stands above them.
        rows: A cell a column, laid out already.

    Raises:
        ValueError: If a row has more or fewer cells than there are columns.

    Example:
        >>> print(table(["what", "m"], [["near", 2.8], ["far", 5.5]]))
        | what | m |
        |---|---|
        | near | 2.8 |
        | far | 5.5 |
    """
    lines = [_line(columns), "|" + "---|" * len(columns)]
    for row in rows:
        if len(row) != len(columns):
            raise ValueError(f"Expected {len(columns)} cells, one a column, but got {len(row)}: {row}.")
        lines.append(_line(row))
    return "\n".join(lines)


def _line(cells: Iterable[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


__all__ = ["Records", "table"]
