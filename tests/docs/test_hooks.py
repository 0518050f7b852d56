"""What the site's hooks make of pages, notebooks and records."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest


def hook(name: str) -> ModuleType:
    if importlib.util.find_spec("mkdocs") is None:
        pytest.skip("the site's packages are not installed: uv sync --group docs")
    spec = importlib.util.spec_from_file_location(f"hook_{name}", Path("docs/hooks") / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Page:
    def __init__(self, uri: str) -> None:
        self.file = type("File", (), {"src_uri": uri})


@pytest.fixture
def project() -> ModuleType:
    return hook("project")


@pytest.fixture
def tables() -> ModuleType:
    return hook("tables")


@pytest.fixture
def notebooks() -> ModuleType:
    return hook("notebooks")


@pytest.mark.parametrize(
    ("page", "written", "shown"),
    [
        ("cameras.md", "[R](../README.md#results)", "[R](project/readme.md#results)"),
        ("api/values.md", "[C](../../CONTRIBUTING.md)", "[C](../project/contributing.md)"),
        ("project/readme.md", "![film](docs/demo.webp)", "![film](../demo.webp)"),
        ("project/readme.md", "[cite](CITATION.cff)", "cite"),
        ("project/security.md", "[v](docs/vehicles.md)", "[v](../vehicles.md)"),
        ("project/docker.md", "[v](../docs/vehicles.md)", "[v](../vehicles.md)"),
        ("cameras.md", "[x](nowhere.md)", "[x](nowhere.md)"),
        ("cameras.md", "[x](https://example.org/a.md)", "[x](https://example.org/a.md)"),
        ("cameras.md", "`[R](../README.md)`", "`[R](../README.md)`"),
    ],
)
def test_links_lead_to_pages_of_the_site(project: ModuleType, page: str, written: str, shown: str) -> None:
    assert project.on_page_markdown(written, Page(page), {}, None) == shown


def test_a_table_comes_from_its_records(tables: ModuleType, tmp_path: Path, monkeypatch: Any) -> None:
    record = {"case": "16 features", "library": "wigwag", "ms_per_query_median": 1.25, "times_ours": 1.0}
    (tmp_path / "dtw.json").write_text(json.dumps([record | {"command": "wigwag benchmark dtw"}]))
    monkeypatch.setattr(tables, "RECORDS", tmp_path)
    page = tables.on_page_markdown("# B\n\n<!-- table: dtw -->\n", None, None, None)
    assert "| 16 features | wigwag | 1.250 | 1.0 |" in page
    assert "- `wigwag benchmark dtw`" in page


@pytest.mark.parametrize("name", ["dtw", "nonsense"])
def test_a_table_without_records_fails_the_build(
    tables: ModuleType, tmp_path: Path, monkeypatch: Any, name: str
) -> None:
    monkeypatch.setattr(tables, "RECORDS", tmp_path)
    with pytest.raises(Exception, match=f"docs/records/{name}.json"):
        tables.on_page_markdown(f"<!-- table: {name} -->", None, None, None)


def test_every_published_record_says_what_remakes_it() -> None:
    paths = sorted(Path("docs/records").glob("*.json"))
    assert paths
    for path in paths:
        content = json.loads(path.read_text("utf-8"))
        for record in content if isinstance(content, list) else [content]:
            assert record["command"] and record["version"] and "seed" in record, path
            assert "/" not in str(record["command"]).replace("../", ""), f"{path}: names a machine's path"


def test_a_notebook_becomes_a_page_with_its_pictures(notebooks: ModuleType) -> None:
    pictures: list[bytes] = []
    outputs = [
        {"output_type": "stream", "text": ["\x1b[31mred\x1b[0m\n"]},
        {"output_type": "display_data", "data": {"image/png": "aGk=", "text/plain": ["<Figure>"]}},
    ]
    cells = [
        {"cell_type": "markdown", "source": ["# Title"]},
        {"cell_type": "code", "source": ["print(1)"], "outputs": outputs},
    ]
    page = list(notebooks._cells({"cells": cells}, "look", pictures))
    assert page[:3] == ["# Title", "```python\nprint(1)\n```", "```text\nred\n```"]
    assert page[3].endswith("(look_0.png)")
    assert pictures == [b"hi"]
