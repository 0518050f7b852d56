"""Who may see the page and press its buttons: a pure function of a request's path and headers."""

from __future__ import annotations

import hmac
import ipaddress
import re
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from wigwag.errors import InputError

COOKIE = "wigwag_console"
LEAST_TOKEN = 12
"""Characters that a token has at least."""
_TOKEN = re.compile(rf"[A-Za-z0-9_.~-]{{{LEAST_TOKEN},200}}")

HEADERS = {
    "Referrer-Policy": "no-referrer",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cache-Control": "no-store",
}
"""Go with every page: the token in the address leaves for nowhere, and nobody lays the page under theirs."""


def is_loopback(host: str) -> bool:
    """Say whether a name or address is this machine's own.

    Example:
        >>> is_loopback("127.0.0.1"), is_loopback("localhost"), is_loopback("0.0.0.0"), is_loopback("::1")
        (True, True, False, True)
    """
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a request is not answered."""

    status: HTTPStatus
    text: str


@dataclass(frozen=True, slots=True)
class Gate:
    """Judges every request: of the page, and of the connection over which it is fed and commands.

    A browser sends a page's origin with every connection that the page opens, so that another site's page in
    the same browser cannot command; and a name that only leads here by a trick is refused.

    Args:
        host: The address that is served.
        token: What has to be shown; ``None`` for this machine's own address alone.

    Raises:
        InputError: If a token is needed and there is none, or it is too short to be a secret.
    """

    host: str
    token: str | None = None

    def __post_init__(self) -> None:
        """Check that an open door has a lock."""
        if self.token is None and not is_loopback(self.host):
            raise InputError(f"The console on {self.host} needs a token: others can reach that address.")
        if self.token is not None and not _TOKEN.fullmatch(self.token):
            raise InputError(
                f"The console's token needs {LEAST_TOKEN} or more letters, digits, '-', '_', '.' or '~': it "
                "stands in an address."
            )

    def refuses(self, path: str, headers: Mapping[str, str]) -> Refusal | None:
        """Return why a request is refused; ``None``: it is not.

        Args:
            path: With its query.
            headers: ``Host``, ``Origin``, ``Cookie``.
        """
        host = headers.get("Host", "")
        name = _hostname(host)
        if name is None or (self.token is None and not is_loopback(name)):
            return Refusal(HTTPStatus.MISDIRECTED_REQUEST, f"This console is not at {host!r}.")
        origin = headers.get("Origin")
        if origin is not None and urlsplit(origin).netloc.lower() != host.lower():
            return Refusal(HTTPStatus.FORBIDDEN, "Another site's page may not use this console.")
        if self.token is not None and not self._shown(path, host, headers.get("Cookie", "")):
            return Refusal(
                HTTPStatus.UNAUTHORIZED,
                "This console needs its token: open the address that it printed when it began (?token=...).",
            )
        return None

    def cookie(self, path: str, headers: Mapping[str, str]) -> str | None:
        """Return the cookie to set: what the page asks for afterwards shows the token by it."""
        if self.token is None or not self._is_token(_query(path)):
            return None
        return f"{_cookie_at(headers.get('Host', ''))}={self.token}; Path=/; HttpOnly; SameSite=Strict"

    def _shown(self, path: str, host: str, cookies: str) -> bool:
        if self._is_token(_query(path)):
            return True
        try:
            morsel = SimpleCookie(cookies).get(_cookie_at(host))
        except CookieError:
            return False
        return morsel is not None and self._is_token(morsel.value)

    def _is_token(self, said: str | None) -> bool:
        return (
            said is not None
            and self.token is not None
            and hmac.compare_digest(said.encode("utf-8", "replace"), self.token.encode())
        )


def _cookie_at(host: str) -> str:
    """Return the cookie's name: browsers do not tell ports apart, and there may be two consoles."""
    return f"{COOKIE}_{host.rpartition(':')[2]}" if host.rpartition(":")[2].isdecimal() else COOKIE


def _query(path: str) -> str | None:
    found = parse_qs(urlsplit(path).query).get("token")
    return found[0] if found else None


def _hostname(host: str) -> str | None:
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None


__all__ = ["COOKIE", "HEADERS", "Gate", "Refusal", "is_loopback"]
