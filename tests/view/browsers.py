"""A headless browser for pages that the tests look at, where this machine has one."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

_FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


PICTURES = os.environ.get("WIGWAG_TEST_PICTURES")
"""A folder for what was to be seen, to look at."""


@contextmanager
def serving(folder: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run a wigwag command with a console until the end of the block; give the process and its page."""
    wigwag = Path(sys.executable).parent / "wigwag"
    line = [str(wigwag), *words, "--console-at", "127.0.0.1:0"]
    # Whatever runs in a shell's background is deaf to Ctrl-C, and so is all that it starts.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        started = subprocess.Popen(line, cwd=folder, stdout=subprocess.PIPE, text=True)
    finally:
        signal.signal(signal.SIGINT, before)
    with started as process:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found is not None
        try:
            yield process, found.group()
        finally:
            process.kill()


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the system's Chromium; skip the test where there is none."""
    pytest.importorskip("viser", reason="needs viser: pip install 'wigwag[console]'")
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright: pip install playwright")
    path = next(
        (
            found
            for name in ("chromium", "chromium-browser", "google-chrome")
            if (found := shutil.which(name))
        ),
        None,
    )
    if path is None:
        pytest.skip("needs Chromium: apt-get install chromium")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=path, args=_FLAGS)
        yield browser
        browser.close()


class Tab:
    """A page that is open, and all that it complains of."""

    def __init__(self, browser: Any, url: str) -> None:
        self.complaints: list[str] = []
        self.page = browser.new_page(viewport={"width": 1000, "height": 900})
        self.page.on("console", self._note)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("requestfailed", lambda request: self.complaints.append(f"failed: {request.url}"))
        self.page.set_default_timeout(120_000)
        self.page.goto(url)

    def _note(self, message: Any) -> None:
        if message.type == "error":
            self.complaints.append(message.text)

    def picture(self) -> np.ndarray:
        """What is to be seen, RGB."""
        data = np.frombuffer(self.page.screenshot(), np.uint8)
        return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR)[:, :, ::-1])

    def keep(self, name: str) -> np.ndarray:
        """Return what is to be seen, RGB; keep it where somebody wants to look at it."""
        picture = self.picture()
        if PICTURES:
            cv2.imwrite(str(Path(PICTURES) / f"{name}.png"), picture[:, :, ::-1])
        return picture

    def press(self, name: str) -> float:
        """Press a button; return when the page saw it, seconds since the epoch."""
        self.page.evaluate(
            """document.addEventListener('click', () => {
                window.pressed = (performance.timeOrigin + performance.now()) / 1000 }, true)"""
        )
        self.page.get_by_role("button", name=name, exact=True).click(force=True)
        return float(self.page.evaluate("window.pressed"))

    def until(self, text: str) -> None:
        """Wait until something is to be read."""
        self.page.get_by_text(text).first.wait_for()


def of_color(picture: np.ndarray, rgb: tuple[int, int, int], within: int = 45) -> np.ndarray:
    """Say where a picture is of a colour, more or less."""
    away = np.abs(picture.astype(int) - np.array(rgb)).max(axis=2)
    return np.asarray(away < within)
