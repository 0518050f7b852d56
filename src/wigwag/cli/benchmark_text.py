"""What the benchmarks say on screen alike."""

from __future__ import annotations

from rich.console import Console

_SHOWN = 12


def say_left_out(console: Console, left_out: list[tuple[str, str]]) -> None:
    """Name the recordings that were left out and why; many missing ones take one line together."""
    missing = [name for name, reason in left_out if reason == "missing"]
    for name, reason in [entry for entry in left_out if entry[1] != "missing"]:
        console.print(f"[yellow]left out:[/] {name}: {reason}", highlight=False, markup=True)
    if missing:
        more = f" and {len(missing) - _SHOWN} more" if len(missing) > _SHOWN else ""
        console.print(
            f"[yellow]missing:[/] {len(missing)} recording(s): {', '.join(missing[:_SHOWN])}{more}",
            highlight=False,
        )


__all__ = ["say_left_out"]
