"""Tables of figures, laid out at each build from the JSON that benchmarks wrote.

A line ``<!-- table: NAME -->`` becomes the table of ``docs/records/NAME.json`` (and ``NAME.*.json``),
as ``wigwag.evaluate.tables`` lays it out. ``<!-- limitations -->`` becomes that part of the README.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError

from wigwag.errors import WigwagError
from wigwag.evaluate.tables import PARTS

ROOT = Path(__file__).resolve().parents[2]
RECORDS = ROOT / "docs" / "records"

_MARK = re.compile(r"^<!-- table: (?P<name>[a-z-]+) -->$", re.MULTILINE)


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Lay the tables out."""
    markdown = _MARK.sub(lambda mark: table(mark["name"]), markdown)
    return markdown.replace("<!-- limitations -->", section("README.md", "Limitations"))


def table(name: str) -> str:
    """Return a table with the lines before and after it: what it shows, and what remakes it.

    Raises:
        PluginError: If there is no such table, or no record of it.
    """
    paths = sorted(RECORDS.glob(f"{name}.json")) + sorted(RECORDS.glob(f"{name}.*.json"))
    if name not in PARTS or not paths:
        raise PluginError(f"No table {name!r}: expected docs/records/{name}.json, and one of {list(PARTS)}.")
    records = [record for path in paths for record in _listed(json.loads(path.read_text("utf-8")))]
    heading, lay_out = PARTS[name]
    try:
        laid_out = lay_out(records)
    except (KeyError, TypeError, WigwagError) as error:
        raise PluginError(
            f"docs/records/{name}.json: a record lacks {error}. Run the benchmark again."
        ) from error
    made = dict.fromkeys(_made_by(record) for record in records)
    remade = "\n".join(f"- `{command}`" for command in made)
    return f'{heading}\n\n{laid_out}\n\n??? note "Remade by"\n\n{_indented(remade)}\n'


def section(page: str, title: str) -> str:
    """Return what stands under a heading of a page of the repository's root."""
    text = (ROOT / page).read_text("utf-8")
    _, _, after = text.partition(f"\n## {title}\n")
    if not after:
        raise PluginError(f"{page} has no section {title!r}.")
    # Written for the root; here it is shown a folder below.
    return re.sub(r"\]\(docs/", "](", after.partition("\n## ")[0].strip())


def _listed(content: Any) -> list[dict[str, Any]]:
    return content if isinstance(content, list) else [content]


def _made_by(record: dict[str, Any]) -> str:
    command = str(record["command"])
    seed = record.get("seed")
    if command == "demo":
        return f"wigwag demo --motion {record['motion']} --seed {seed}"
    return command


def _indented(text: str) -> str:
    return "\n".join("    " + line for line in text.splitlines())
