"""Notebooks as pages: text, code, and what they put out where they have been run.

``docs/notebooks/*.ipynb`` are kept without outputs. CI runs them into ``build/notebooks`` before it builds
the site; where that has not been done the pages show text and code alone.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[2]
SOURCES, EXECUTED = ROOT / "docs" / "notebooks", ROOT / "build" / "notebooks"

_COLOURS = re.compile(r"\x1b\[[0-9;]*m")


def on_files(files: Files, config: Any) -> Files:
    """Add a page for each notebook, and the pictures it shows."""
    for source in sorted(SOURCES.glob("*.ipynb")):
        executed = EXECUTED / source.name
        notebook = json.loads((executed if executed.exists() else source).read_text("utf-8"))
        pictures: list[bytes] = []
        where = f"From `docs/notebooks/{source.name}`; CI runs it."
        text = "\n\n".join([*_cells(notebook, source.stem, pictures), f"---\n\n*{where}*"])
        files.append(File.generated(config, f"notebooks/{source.stem}.md", content=text + "\n"))
        for number, picture in enumerate(pictures):
            name = f"notebooks/{source.stem}_{number}.png"
            files.append(File.generated(config, name, content=picture))
    return files


def _cells(notebook: dict[str, Any], stem: str, pictures: list[bytes]) -> Iterator[str]:
    for cell in notebook["cells"]:
        source = "".join(cell["source"]).strip()
        if cell["cell_type"] == "markdown":
            yield source
        elif cell["cell_type"] == "code" and source:
            yield f"```python\n{source}\n```"
            for output in cell["outputs"]:
                yield from _output(output, stem, pictures)


def _output(output: dict[str, Any], stem: str, pictures: list[bytes]) -> Iterator[str]:
    data = output.get("data", {})
    if "image/png" in data:
        yield f"![What the cell above draws]({stem}_{len(pictures)}.png)"
        pictures.append(base64.b64decode(data["image/png"]))
        return
    text = "".join(output.get("text", data.get("text/plain", "")))
    if text := _COLOURS.sub("", text).rstrip():
        yield f"```text\n{text}\n```"
