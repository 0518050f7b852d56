"""Sessions in pages (``>>>``) are run; what a page says comes out is what comes out."""

import doctest
import re
from pathlib import Path

import pytest

PAGES = sorted(page for page in Path("docs").rglob("*.md") if ">>>" in page.read_text("utf-8"))
FLAGS = doctest.ELLIPSIS


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_sessions_in_pages_run(page: Path) -> None:
    text = re.sub(r"^ *```.*$", "", page.read_text("utf-8"), flags=re.MULTILINE)  # a fence ends an output
    said: list[str] = []
    test = doctest.DocTestParser().get_doctest(text, {}, str(page), str(page), 0)
    results = doctest.DocTestRunner(optionflags=FLAGS, verbose=False).run(test, out=said.append)
    assert results.attempted > 0
    assert not results.failed, "".join(said)


def test_every_room_of_the_reference_begins_with_an_example() -> None:
    rooms = {page for page in Path("docs/api").glob("*.md") if page.name != "index.md"}
    assert rooms <= set(PAGES)
