"""Who gets through to the page, and who never does."""

from __future__ import annotations

from http import HTTPStatus

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.view.console.gate import Gate, is_loopback

TOKEN = "correct-horse-battery"
HERE, OPEN = Gate("127.0.0.1"), Gate("0.0.0.0", TOKEN)


def asked(host: str = "10.0.0.7:8080", **headers: str) -> dict[str, str]:
    return {"Host": host, **headers}


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.4", "::", "drone.local", "example.com"])
def test_an_open_address_needs_a_token(host: str) -> None:
    assert not is_loopback(host)
    with pytest.raises(InputError, match="needs a token"):
        Gate(host)
    assert Gate(host, TOKEN)


@pytest.mark.parametrize(
    "token", ["", "short", "ünïcode-and-long-enough", "with spaces in it", "semi;colon;in;it"]
)
def test_a_token_is_a_secret(token: str) -> None:
    with pytest.raises(InputError, match="12 or more letters"):
        Gate("0.0.0.0", token)


@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost:9", "[::1]:8080", "localhost"])
def test_this_machine_asks_itself_freely(host: str) -> None:
    assert HERE.refuses("/", asked(host)) is None
    assert HERE.refuses("/", asked(host, Origin=f"http://{host}")) is None
    assert HERE.cookie("/?token=x", asked(host)) is None


@pytest.mark.parametrize("host", ["evil.example:8080", "10.0.0.7:8080", "", "[bad", "127.0.0.1.evil.example"])
def test_a_name_that_only_leads_here_is_refused(host: str) -> None:
    refusal = HERE.refuses("/", asked(host))
    assert refusal is not None and refusal.status is HTTPStatus.MISDIRECTED_REQUEST


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://127.0.0.1:9999", "null", "https://127.0.0.1.evil.example:8080"]
)
def test_another_sites_page_is_refused(origin: str) -> None:
    refusal = HERE.refuses("/", asked("127.0.0.1:8080", Origin=origin))
    assert refusal is not None and refusal.status is HTTPStatus.FORBIDDEN
    refusal = OPEN.refuses(f"/?token={TOKEN}", asked(Origin=origin))
    assert refusal is not None and refusal.status is HTTPStatus.FORBIDDEN


def test_the_token_opens_in_the_address_and_then_by_cookie() -> None:
    path = f"/?token={TOKEN}"
    assert OPEN.refuses(path, asked()) is None
    cookie = OPEN.cookie(path, asked())
    assert cookie == f"wigwag_console_8080={TOKEN}; Path=/; HttpOnly; SameSite=Strict"
    assert OPEN.refuses("/", asked(Cookie=f"other=1; wigwag_console_8080={TOKEN}")) is None
    assert OPEN.cookie("/", asked()) is None, "who did not show it is not given it"


@pytest.mark.parametrize(
    ("path", "cookie"),
    [
        ("/", ""), ("/?token=", ""), ("/?token=wrong", ""), (f"/?token={TOKEN}x", ""),
        (f"/?Token={TOKEN}", ""), (f"/{TOKEN}", ""), ("/", f"wigwag_console_9999={TOKEN}"),
        ("/", "wigwag_console_8080=wrong"), ("/", "=;;;\x00"), (f"/?token=wrong&token={TOKEN}", ""),
    ],
)  # fmt: skip
def test_without_it_nothing_opens(path: str, cookie: str) -> None:
    refusal = OPEN.refuses(path, asked(Cookie=cookie))
    assert refusal is not None and refusal.status is HTTPStatus.UNAUTHORIZED
    assert TOKEN not in refusal.text


@given(st.text(max_size=60), st.text(max_size=60), st.text(max_size=40))
def test_no_request_gets_through_by_chance(path: str, cookie: str, host: str) -> None:
    assert OPEN.refuses(path, {"Host": host, "Cookie": cookie}) is not None
