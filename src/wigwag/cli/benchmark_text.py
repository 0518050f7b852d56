"""What the benchmarks say on screen alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

if TYPE_CHECKING:
    from wigwag.datasets import Loaded

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


def read(console: Console, name: str, load: Callable[[Callable[[int, int], None]], Loaded]) -> Loaded:
    """Read a data set under a progress bar and say what was left out or repaired, and what there is.

    Args:
        console: Where it is said.
        name: Of the data set.
        load: Called with what reports (done, total).
    """
    from rich.progress import Progress

    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(f"Reading {name}", total=None)
        loaded = load(lambda done, total: bar.update(task, completed=done, total=total))
    say_left_out(console, loaded.left_out)
    for recording, repair in loaded.repaired:
        console.print(f"repaired: {escape(recording)}: {escape(repair)}", highlight=False)
    people = len({clip.subject for clip in loaded.clips})
    console.print(f"{name}: {len(loaded)} clips of {people} people.")
    return loaded


@contextmanager
def bar_of_steps(console: Console) -> Iterator[Callable[[str], Callable[[str, int, int], None]]]:
    """Show a bar of the steps done and the time left.

    What it gives is called with a title for each piece of work, and what that gives with (what, done, total).
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=None)

        def begin(title: str) -> Callable[[str, int, int], None]:
            bar.update(task, description=title, completed=0, total=None)
            return lambda what, done, total: bar.update(
                task, description=f"{title}, {what}" if what else title, completed=done, total=total
            )

        yield begin


def per_cent(share: float, digits: int = 1) -> str:
    """Write a share of 1 in per cent."""
    return f"{100 * share:.{digits}f}"


__all__ = ["bar_of_steps", "per_cent", "read", "say_left_out", "wide_console"]
