"""What was said, as part of the page: always text, never a page of its own."""

from __future__ import annotations

from html import escape

from wigwag.view.console.values import Line

_COLORS = {"gesture": "#5fd39a", "mode": "#8ab4f8", "console": "#f2c94c", "alarm": "#ff7b72", "": "#c9d1d9"}


def line_html(line: Line) -> str:
    """Return one line, coloured by its kind.

    Example:
        >>> line_html(Line(1.26, "<b>", "alarm"))
        '<div style="color:#ff7b72"><span style="opacity:.6">1.3 s</span> &lt;b&gt;</div>'
    """
    color = _COLORS.get(line.kind, _COLORS[""])
    return (
        f'<div style="color:{color}"><span style="opacity:.6">{line.at_s:.1f} s</span> '
        f"{escape(line.text)}</div>"
    )


__all__ = ["line_html"]
