"""What goes beside the code: container, cards, templates, and the extras that pages name."""

import re
import tomllib
from pathlib import Path

import pytest

TEXTS = sorted(
    [*Path().glob("*.md"), *Path("docs").rglob("*.md"), *Path("docker").glob("*"), *Path("src").rglob("*.py")]
)


def test_extras_that_are_named_are_there() -> None:
    extras = tomllib.loads(Path("pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    named = {
        (extra.strip(), path)
        for path in TEXTS
        for group in re.findall(r"(?:wigwag|wheel\})\[([a-z0-9, -]+)\]", path.read_text("utf-8"))
        for extra in group.split(",")
    }
    assert {"realsense", "mavlink", "record", "console", "view"} <= {extra for extra, _ in named}
    assert not [(extra, str(path)) for extra, path in named if extra not in extras]


def test_no_page_stands_twice_in_the_menu() -> None:
    pages = re.findall(r"^ +- (?:.*: )?(\S+\.md)$", Path("mkdocs.yml").read_text("utf-8"), re.MULTILINE)
    assert len(pages) > 40 and len(pages) == len(set(pages))


def test_what_the_container_copies_is_there() -> None:
    lines = Path("docker/Dockerfile").read_text("utf-8").splitlines()
    copied = [word for line in lines if line.startswith("COPY ") for word in line.split()[1:-1]]
    assert copied and all(Path(word).exists() for word in copied)
    seen = set(Path("docker/Dockerfile.dockerignore").read_text("utf-8").splitlines())
    assert {f"!{word}" for word in copied} <= seen, "a file that is ignored cannot be copied"


@pytest.mark.parametrize("kind", ["model", "data"])
def test_the_demos_card_follows_the_template(kind: str) -> None:
    template, card = (
        re.findall(r"^## (.*)", Path(f"docs/{kind}_card_{name}.md").read_text("utf-8"), re.MULTILINE)
        for name in ("template", "demo")
    )
    assert template and card == template


def test_forms_for_issues_ask_for_what_doctor_says() -> None:
    forms = {path.stem: path.read_text("utf-8") for path in Path(".github/ISSUE_TEMPLATE").glob("*.yml")}
    assert {"bug", "feature", "benchmark_result"} <= set(forms)
    assert all("wigwag doctor" in forms[name] for name in ("bug", "benchmark_result"))
