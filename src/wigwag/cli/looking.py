"""The options by which a command is looked at while it runs: in Rerun, and on a page in the browser."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.view.onlookers import Onlookers


@dataclass(frozen=True)
class Looking:
    """Looking on while it runs."""

    view: bool = False
    """Open Rerun beside it: picture with landmarks, depth, people in space, figures. Needs wigwag[view]."""
    save: Path | None = None
    """Write what --view would show to this .rrd file; rerun FILE opens it."""
    console: bool = False
    """Serve a page for the browser: 3-D scene, picture, state, stop button. Needs wigwag[console]."""
    console_at: str = "127.0.0.1:8080"
    """HOST:PORT of that page. Another address than this machine's own is served behind a token."""
    console_token: str | None = None
    """What the page's address has to end with (?token=...): 12 or more letters and digits. By default it is
    drawn anew where one is needed, and printed."""

    @contextmanager
    def open(
        self,
        console: Console,
        *,
        flies: bool = True,
        teaches: bool = False,
    ) -> Iterator[Onlookers]:
        """Open what was asked for, and close it at the end.

        Args:
            console: Where the page's address is printed.
            flies: Whether there is something to be stopped.
            teaches: Whether gestures are taught.

        Raises:
            InputError: If an option is wrong.
            MissingExtraError: If Rerun or viser is not installed.
            ViewError: If one of them cannot be opened.
        """
        from wigwag.view.onlookers import Onlookers

        if self.console_token is not None and not self.console:
            raise InputError("--console-token is for --console.")
        rerun, page = None, None
        try:
            if self.view or self.save is not None:
                from wigwag.view.rerun import RerunView

                rerun = RerunView(save=self.save, spawn=self.view)
            if self.console:
                from wigwag.view.console.config import ConsoleConfig
                from wigwag.view.console.console import Console as Page

                config = ConsoleConfig.at(self.console_at, self.console_token, flies=flies, teaches=teaches)
                page = Page(config)
                console.print(f"console: [bold]{page.url}[/]", highlight=False, soft_wrap=True)
            yield Onlookers(rerun, page)
        finally:
            if page is not None:
                page.close()
            if rerun is not None:
                rerun.close()


__all__ = ["Looking"]
