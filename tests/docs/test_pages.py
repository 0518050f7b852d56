"""What the pages tell readers to type: command lines parse, Python compiles, and what it imports is there."""

import ast
import contextlib
import importlib
import io
import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
import tyro

from wigwag.cli.app import Commands, run
from wigwag.cli.catalogue import catalogue

PAGES = sorted([*Path().glob("*.md"), *Path("docs").rglob("*.md"), *Path("docker").glob("*.md")])
NOTEBOOKS = sorted(Path("docs/notebooks").glob("*.ipynb"))
_FENCE = re.compile(r"^ *```(?P<kind>\w*)[^\n]*\n(?P<text>.*?)^ *```", re.DOTALL | re.MULTILINE)


def fences(page: Path) -> Iterator[tuple[str, str]]:
    for fence in _FENCE.finditer(page.read_text("utf-8")):
        yield fence["kind"], fence["text"]


def command_lines(page: Path) -> Iterator[list[str]]:
    """Yield the command lines of a page's blocks, without comments and without what the shell takes."""
    for kind, text in fences(page):
        if kind in ("python", "text", "json", "ini", "yaml"):
            continue
        for line in text.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True) if re.match(r" *(uv run )?wigwag ", line) else []
            words = words[2:] if words[:2] == ["uv", "run"] else words
            if words and not any(word.startswith("--tyro-") or word == "--help" for word in words):
                stop = next((i for i, word in enumerate(words) if word in (">", "|", "&&", ";")), None)
                yield words[1:stop]


def check_python(source: str) -> None:
    """Compile a piece of Python, and import what it imports from wigwag."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "wigwag":
            module = importlib.import_module(str(node.module))
            for name in node.names:
                there = hasattr(module, name.name)
                assert there or importlib.import_module(f"{node.module}.{name.name}"), ast.unparse(node)


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_command_lines_parse(page: Path) -> None:
    config = (tyro.conf.OmitSubcommandPrefixes, tyro.conf.OmitArgPrefixes)
    for words in command_lines(page):
        try:
            tyro.cli(Commands, args=words, config=config)
        except SystemExit:
            pytest.fail(f"{page}: wigwag does not understand: {shlex.join(words)}")


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_python_compiles_and_imports_what_is_there(page: Path) -> None:
    for kind, text in fences(page):
        if kind == "python":
            check_python(text)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=str)
def test_notebooks_are_kept_without_outputs_and_import_what_is_there(path: Path) -> None:
    cells = json.loads(path.read_text("utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert code and cells[0]["cell_type"] == "markdown"
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    for cell in code:
        check_python("".join(cell["source"]))


def test_pages_name_commands_and_there_are_three_notebooks() -> None:
    assert sum(len(list(command_lines(page))) for page in PAGES) >= 15
    assert len(NOTEBOOKS) >= 3


@pytest.fixture(scope="module")
def options() -> set[str]:
    """All options of all commands, as their help names them."""
    found = {"--help", "--tyro-print-completion"}
    for entry in catalogue():
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
            run([*entry.words, "--help"])
        found |= set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", said.getvalue()))
    return found


def test_options_named_in_a_sentence_are_wigwags(options: set[str]) -> None:
    """Not in the changelog, which names what went, nor where it is another program's."""
    for page in PAGES:
        text = _FENCE.sub("", page.read_text("utf-8"))
        spans = re.findall(r"`([^`\n]+)`", text) if page.name != "CHANGELOG.md" else []
        for span in spans:
            named = set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", span))
            if re.match("(uv run )?wigwag ", span) or (
                span.startswith("--") and page.parent.name != "docker"
            ):
                assert named <= options, f"{page}: `{span}`"
