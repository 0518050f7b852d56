"""The process that serves the page: reads snapshots, draws the newest, sends back what is pressed."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
import threading
from collections.abc import Awaitable, Callable
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from wigwag.errors import WigwagError
from wigwag.extras import load
from wigwag.view.console.gate import HEADERS, Gate
from wigwag.view.console.slot import Slot
from wigwag.view.console.values import Snapshot, newer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from multiprocessing.connection import Connection

    from wigwag.view.console.config import ConsoleConfig

PAGE_HZ = 10.0
"""How often the page is drawn anew at most."""
NEWS_S = 1.0
"""A loop that has said nothing for so long is said to be silent: what the page shows is old."""


def serve(link: Connection, config: ConsoleConfig) -> None:
    """Serve the page until the other end of the link is closed. The process's whole life."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the loop, which then closes the link
    sys.stdout = _nowhere()  # viser prints where it listens, without the token
    lock = threading.Lock()

    def tell(message: bytes) -> None:
        with lock:
            link.send_bytes(message)

    try:
        server = guarded_server(Gate(config.host, config.token), config.host, config.port)
    except (WigwagError, OSError) as error:
        tell(json.dumps({"error": str(error)}).encode())
        return
    from wigwag.view.console.page import Page

    page = Page(server, config, lambda ask: tell(ask.to_json()))
    shown = f"[{config.host}]" if ":" in config.host else config.host
    tell(json.dumps({"url": f"http://{shown}:{server.get_port()}"}).encode())
    slot: Slot[Snapshot] = Slot(newer)
    threading.Thread(target=_read, args=(link, slot), daemon=True).start()
    rest = threading.Event()
    silent_s = 0.0
    while not slot.closed:
        snapshot = slot.take(NEWS_S)
        if snapshot is None:
            silent_s += NEWS_S
            page.say_silent(silent_s)
            continue
        silent_s = 0.0
        page.show(snapshot)
        rest.wait(1.0 / PAGE_HZ)
    server.stop()


def _read(link: Connection, slot: Slot[Snapshot]) -> None:
    try:
        while True:
            slot.put(link.recv())
    except (EOFError, OSError):
        slot.close()


def guarded_server(gate: Gate, host: str, port: int) -> Any:
    """Begin a ``viser.ViserServer`` that answers no request which the gate refuses.

    Raises:
        OSError: If the address is not to be had.
        WigwagError: If viser does not let itself be guarded: then nothing is served.
    """
    viser = load("viser", "console", "The console")
    os.environ.pop("_VISER_PORT_OVERRIDE", None)
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((host, port))  # viser would quietly take the next port

    class Server(viser.ViserServer):  # type: ignore[misc, name-defined]  # known at run time only
        def request_share_url(self, verbose: bool = True) -> str | None:
            """Open no tunnel to the internet, though a client may ask for it."""
            return None

    with _guarding(gate) as guarded:
        server = Server(host=host, port=port, label="wigwag", verbose=False)
    if not guarded or (port and server.get_port() != port):
        server.stop()
        raise WigwagError("viser cannot be guarded here; install the version that wigwag[console] names.")
    return server


@contextmanager
def _guarding(gate: Gate) -> Iterator[list[bool]]:
    """Put the gate before every server of websockets that begins meanwhile; note that one did."""
    module = load("websockets.asyncio.server", "console", "The console")
    original, guarded = module.serve, []

    def serve_guarded(*args: Any, process_request: Callable[..., Any] | None = None, **options: Any) -> Any:
        guarded.append(True)
        return original(*args, process_request=_checked(gate, process_request), **options)

    module.serve = serve_guarded
    try:
        yield guarded
    finally:
        module.serve = original


def _checked(gate: Gate, process_request: Callable[..., Any] | None) -> Callable[..., Awaitable[Any]]:
    async def checked(connection: Any, request: Any) -> Any:
        refusal = gate.refuses(request.path, request.headers)
        if refusal is not None:
            return connection.respond(refusal.status, refusal.text + "\n")
        response = None if process_request is None else process_request(connection, request)
        if response is not None:
            for name, value in HEADERS.items():
                response.headers[name] = value
            if (cookie := gate.cookie(request.path, request.headers)) is not None:
                response.headers["Set-Cookie"] = cookie
        return response

    return checked


def _nowhere() -> TextIO:
    return open(os.devnull, "w", encoding="utf-8")  # for as long as the process lives


__all__ = ["NEWS_S", "PAGE_HZ", "guarded_server", "serve"]
