"""What every command says to ``--help``, as a page: ``<!-- commands -->`` becomes all of it."""

from __future__ import annotations

import contextlib
import io
import os
import textwrap
from collections.abc import Iterator
from typing import Any


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Write the help of all commands where the mark stands."""
    mark = "<!-- commands -->"
    return markdown.replace(mark, "\n\n".join(_sections())) if mark in markdown else markdown


def _sections() -> Iterator[str]:
    from wigwag.cli.catalogue import catalogue

    for entry in catalogue():
        title = " ".join(("wigwag", *entry.words))
        opened = "\n\n".join([f"```text\n{help_of(entry.words)}\n```"])
        yield f'### `{title}`\n\n{entry.summary}\n\n??? note "Options"\n\n{textwrap.indent(opened, "    ")}'


def help_of(words: tuple[str, ...]) -> str:
    """Return what a command prints on ``--help``, 100 columns wide and without colours."""
    from wigwag.cli.app import run

    said, before = io.StringIO(), dict(os.environ)
    os.environ.update(COLUMNS="100", NO_COLOR="1", TERM="dumb")
    try:
        with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
            run([*words, "--help"])
    finally:
        os.environ.clear()
        os.environ.update(before)
    return said.getvalue().strip()
