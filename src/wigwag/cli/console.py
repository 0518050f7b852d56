"""``wigwag console``: fly with a page in the browser beside it."""

from __future__ import annotations

from dataclasses import dataclass, field

from wigwag.cli.fly import Fly
from wigwag.cli.looking import Looking
from wigwag.errors import InputError


@dataclass(frozen=True)
class ConsoleCommand(Fly):
    """Fly as wigwag fly does, with a page in the browser: scene, picture, events, stop button, limits.

    By default both camera and drone are simulated, and the operator is too. Open the address that is
    printed. Exit code: 0 flown, 1 not in order or ended in trouble, 2 wrong input.
    Example: wigwag console --camera sim: --vehicle sim: --console-at 127.0.0.1:8080
    """

    looking: Looking = field(default_factory=lambda: Looking(console=True))

    def run(self) -> int:
        """Fly with the page; return the exit code."""
        if not self.looking.console:
            raise InputError("wigwag console is for its page; wigwag fly does without.")
        return super().run()


__all__ = ["ConsoleCommand"]
