"""Where the page is, and what it is called."""

from __future__ import annotations

import secrets
from dataclasses import dataclass

from wigwag.errors import InputError
from wigwag.view.console.gate import Gate, is_loopback


@dataclass(frozen=True, slots=True)
class ConsoleConfig:
    """Where the page is, and what it is called.

    Raises:
        InputError: If the address is none, or another one than this machine's own has a token too short.
    """

    host: str = "127.0.0.1"
    port: int = 8080
    """0: any that is free."""
    token: str | None = None
    """What has to be shown; drawn anew for another address than this machine's own."""
    title: str = "wigwag"
    flies: bool = True
    """Whether there is something to be stopped."""
    teaches: bool = False
    """Whether gestures are taught, and can be named on the page."""

    def __post_init__(self) -> None:
        """Check, and draw a token where one is needed."""
        if not self.host or not 0 <= self.port <= 65_535:
            raise InputError(f"The console needs an address such as 127.0.0.1:8080, but got {self.address}.")
        if self.token is None and not is_loopback(self.host):
            object.__setattr__(self, "token", secrets.token_urlsafe(24))
        Gate(self.host, self.token)

    @property
    def address(self) -> str:
        """Host and port."""
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    @classmethod
    def at(
        cls,
        address: str,
        token: str | None = None,
        *,
        flies: bool = True,
        teaches: bool = False,
    ) -> ConsoleConfig:
        """Read HOST:PORT.

        Raises:
            InputError: If it is none.
        """
        host, colon, port = address.rpartition(":")
        if not colon or not port.isdecimal():
            raise InputError(f"The console needs an address such as 127.0.0.1:8080, but got {address!r}.")
        return cls(host.strip("[]"), int(port), token, flies=flies, teaches=teaches)


__all__ = ["ConsoleConfig"]
