"""The console's two processes: what is served, who is refused, and that the loop never waits."""

from __future__ import annotations

import http.client
import os
import signal
import socket
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from wigwag import extras
from wigwag.errors import InputError, MissingExtraError, ViewError, WigwagError
from wigwag.fly.operator import Mount
from wigwag.view.console import process
from wigwag.view.console.config import ConsoleConfig
from wigwag.view.console.console import PICTURE_PX, Console
from wigwag.view.console.gate import Gate
from wigwag.view.console.measure import _looking
from wigwag.view.console.slot import Slot
from wigwag.view.console.values import Picture, Snapshot, newer

WEBSOCKET = {
    "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}  # fmt: skip


@pytest.fixture
def viser() -> None:
    pytest.importorskip("viser", reason="needs viser: pip install 'wigwag[console]'")


@pytest.fixture
def page(viser: None) -> Iterator[Console]:
    console = Console(ConsoleConfig(port=0))
    yield console
    console.close()


def snapshot(number: int = 0) -> Snapshot:
    picture = Picture(np.full((480, 640, 3), number % 256, np.uint8), (640, 480), 0.9)
    return Snapshot(number, picture, (), None, Mount(), None, "nobody", 0.0, 30.0, 10.0, 1.0, ())


def status(console: Console, path: str = "/", **headers: str) -> int:
    """Ask for a path as one might, and return how that is answered."""
    port = int(console.url.rpartition(":")[2].strip("/").partition("/")[0])
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request(
        "GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()}
    )
    answer = connection.getresponse()
    connection.close()
    return answer.status


def test_the_page_is_there_for_this_machine_and_for_no_other_site(page: Console) -> None:
    assert page.url.startswith("http://127.0.0.1:") and "token" not in page.url
    assert status(page) == 200
    assert status(page, "/../../etc/passwd") == 404
    assert status(page, Host="evil.example") == 421
    evil = {"Origin": "http://evil.example", **WEBSOCKET}
    assert status(page, **{name.replace("-", "_"): value for name, value in evil.items()}) == 403


def test_with_a_token_neither_page_nor_connection_is_had_without_it(viser: None) -> None:
    console = Console(ConsoleConfig(port=0, token="a-long-enough-secret"))
    upgrade = {name.replace("-", "_"): value for name, value in WEBSOCKET.items()}
    try:
        for path in ("/", "/?token=", "/?token=a-wrong-one-of-length", "/index.html"):
            assert status(console, path) == 401
            assert status(console, path, **upgrade) == 401, "nothing that is said on it would be heard"
        assert status(console, "/", Cookie="wigwag_console=a-long-enough-secret") == 401
        right = "/?token=a-long-enough-secret"
        assert (status(console, right), status(console, right, **upgrade)) == (200, 101)
        assert status(console, right, Origin="http://evil.example", **upgrade) == 403
    finally:
        console.close()


def test_a_page_that_nobody_draws_does_not_hold_up_the_loop(page: Console) -> None:
    child = page._process.pid
    assert child is not None
    os.kill(child, signal.SIGSTOP)
    try:
        for number in range(200):
            page.show(snapshot(number))
        assert page._slot.replaced >= 190, "what nobody takes is replaced, not queued"
        assert page.asks() == [] and page.trouble == ""
    finally:
        os.kill(child, signal.SIGCONT)


def test_viewers_are_all_sent_what_is_shown(page: Console) -> None:
    with _looking(page.url, 3):
        page.show(snapshot())


def test_a_page_that_dies_is_said_and_the_loop_goes_on(viser: None) -> None:
    console = Console(ConsoleConfig(port=0))
    assert console._process.pid is not None
    os.kill(console._process.pid, signal.SIGKILL)
    console._process.join(10)
    for thread in console._threads[1:]:
        thread.join(10)
    for number in range(10):
        console.show(snapshot(number))
    assert "page is gone" in console.trouble and console.asks() == []
    console.close()


def test_an_address_that_is_taken_is_said(viser: None) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with pytest.raises(ViewError, match=r"cannot be served on 127\.0\.0\.1.*in use"):
            Console(ConsoleConfig(port=other.getsockname()[1]))


def test_a_missing_extra_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"pip install 'wigwag\[console\]'"):
        Console()


@pytest.mark.parametrize("address", ["", "here", "8080", ":8080", "127.0.0.1:", "127.0.0.1:99999", "h:-1"])
def test_what_is_no_address_is_said(address: str) -> None:
    with pytest.raises(InputError, match="needs an address such as"):
        ConsoleConfig.at(address)


def test_an_open_address_gets_a_token_of_its_own() -> None:
    one, other = ConsoleConfig.at("0.0.0.0:8080"), ConsoleConfig.at("[::]:8080")
    assert one.token and other.token and one.token != other.token and len(one.token) >= 32
    assert ConsoleConfig.at("127.0.0.1:0").token is None and ConsoleConfig.at("[::1]:80").host == "::1"
    assert ConsoleConfig.at("0.0.0.0:1", "my-own-long-secret").token == "my-own-long-secret"


def test_a_picture_that_was_missed_comes_with_the_next_snapshot() -> None:
    slot: Slot[Snapshot] = Slot(newer)
    for number in range(6):
        slot.put(snapshot(number) if number % 2 == 0 else replace(snapshot(number), picture=None))
    taken = slot.take()
    assert taken is not None and taken.now_ns == 5
    assert taken.picture is not None and taken.picture.rgb[0, 0, 0] == 4


def test_pictures_leave_small() -> None:
    from wigwag.view.console.console import _small

    picture = _small(snapshot()).picture
    assert picture is not None and picture.rgb.shape == (240, 320, 3)
    assert picture.rgb.shape[1] <= PICTURE_PX
    assert picture.size_px == (640, 480)


def test_a_server_that_cannot_be_guarded_is_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    stopped = []

    class Unguarded:
        class ViserServer:
            def __init__(self, **options: object) -> None:
                pass

            def stop(self) -> None:
                stopped.append(self)

    real = process.load
    monkeypatch.setattr(process, "load", lambda name, *a: Unguarded if name == "viser" else real(name, *a))
    pytest.importorskip("websockets", reason="needs viser: pip install 'wigwag[console]'")
    with pytest.raises(WigwagError, match="cannot be guarded"):
        process.guarded_server(Gate("127.0.0.1"), "127.0.0.1", 0)
    assert len(stopped) == 1 and stopped[0].request_share_url() is None, "and opens no tunnel"
