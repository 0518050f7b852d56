"""What the benchmarks say on screen alike."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape

_SHOWN = 20
_WIDTH = 130


def wide_console() -> Console:
    """Return a console that is wide enough for the tables where it writes into a file or pipe."""
    console = Console()
    return console if console.is_terminal else Console(width=max(console.width, _WIDTH))


def say_left_out(console: Console, left_out: list[tuple[str, str]]) -> None:
    """Name the recordings that were left out and why; many missing ones take one line together."""
    missing = [name for name, reason in left_out if reason == "missing"]
    for name, reason in [entry for entry in left_out if entry[1] != "missing"]:
        console.print(f"[yellow]left out:[/] {escape(name)}: {escape(reason)}", highlight=False)
    if missing:
        more = f" and {len(missing) - _SHOWN} more" if len(missing) > _SHOWN else ""
        console.print(
            f"[yellow]missing:[/] {len(missing)} recording(s): {', '.join(missing[:_SHOWN])}{more}",
            highlight=False,
        )


__all__ = ["say_left_out", "wide_console"]
