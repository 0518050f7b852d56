"""One form of address for all cameras: ``kind:what?option=value&option=value``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import unquote

from wigwag.errors import InputError


@dataclass(frozen=True, slots=True)
class Address:
    """A camera's address, taken apart.

    Raises:
        InputError: From its methods, if an option's value is not of the type that is asked for.
    """

    kind: str
    """Before the first colon."""
    target: str
    """Device, file or folder; may be empty."""
    options: dict[str, str]
    """After the question mark."""

    def text(self, name: str, default: str = "") -> str:
        """Return an option as it stands."""
        return self.options.get(name, default)

    def number(self, name: str, default: float) -> float:
        """Return an option as a finite number."""
        return default if name not in self.options else self._number(name)

    def whole(self, name: str, default: int) -> int:
        """Return an option as a whole number."""
        value = self.number(name, default)
        if value != int(value):
            raise InputError(f"{self.kind}: ?{name}= must be a whole number, but got {self.options[name]!r}.")
        return int(value)

    def flag(self, name: str, default: bool = False) -> bool:
        """Return an option that is on (1) or off (0)."""
        value = self.options.get(name, "1" if default else "0")
        if value not in ("0", "1"):
            raise InputError(f"{self.kind}: ?{name}= must be 0 or 1, but got {value!r}.")
        return value == "1"

    def _number(self, name: str) -> float:
        try:
            value = float(self.options[name])
        except ValueError:
            value = float("nan")
        if not abs(value) < float("inf"):
            raise InputError(f"{self.kind}: ?{name}= must be a number, but got {self.options[name]!r}.")
        return value


def parse(text: str, options: Iterable[str]) -> Address:
    """Take an address apart.

    Args:
        text: Such as ``bag:flight?color=/camera/color/image_raw``.
        options: Which there are for this kind of camera. A URL may have a query of its own: what is not one
            of these stays with it.

    Raises:
        InputError: If an option is not known, given twice or has no value.

    Example:
        >>> parse("sim:?seed=3", ["seed"]).options
        {'seed': '3'}
        >>> parse("webcam:http://host/video?channel=2&width=640", ["width"]).target
        'http://host/video?channel=2'
    """
    known = sorted(options)
    kind, _, rest = text.partition(":")
    target, _, query = rest.partition("?")
    found: dict[str, str] = {}
    foreign: list[str] = []
    for part in filter(None, query.split("&")):
        name, equals, value = part.partition("=")
        if name not in known and "://" in target:
            foreign.append(part)
            continue
        if name not in known:
            raise InputError(
                f"{hide_password(text)}: has no option {name!r}. {kind}: takes {', '.join(known) or 'none'}."
            )
        if name in found or not equals or not value:
            raise InputError(
                f"{hide_password(text)}: the option {name!r} must be given once, with a value: ?{name}=..."
            )
        found[name] = unquote(value)
    if foreign:
        target = f"{target}?{'&'.join(foreign)}"
    return Address(kind, target, found)


def hide_password(target: str) -> str:
    """Return a URL without the password in it, fit for messages and logs.

    Example:
        >>> hide_password("rtsp://me:secret@10.0.0.2/stream")
        'rtsp://me:***@10.0.0.2/stream'
    """
    return re.sub(r"(://[^/@:]*):[^@]*@", r"\1:***@", target)
