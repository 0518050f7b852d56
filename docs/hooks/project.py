"""The site's ``project/`` pages: files of the repository's root, and links that leave ``docs/``.

Pages are written to be read in the repository, too: ``[README](../README.md)`` has to lead somewhere in both.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[2]

PAGES = {
    "README.md": "project/readme.md",
    "ARCHITECTURE.md": "project/architecture.md",
    "CHANGELOG.md": "project/changelog.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "SECURITY.md": "project/security.md",
    "docker/README.md": "project/docker.md",
}
"""Files of the repository, and the pages of the site that show them."""

_LINK = re.compile(r"(?P<open>!?\[(?P<text>[^\]\[]*)\])\((?P<target>[^)\s#]+)(?P<anchor>#[^)\s]*)?\)")
_CODE = re.compile(r"(```.*?```|`[^`\n]*`)", re.DOTALL)


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that are files of the repository."""
    for source, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text("utf-8")))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Turn links between files of the repository into links between pages of the site."""
    shown = page.file.src_uri
    written = next((Path(source) for source, at in PAGES.items() if at == shown), Path("docs") / shown)
    pieces = _CODE.split(markdown)
    pieces[::2] = [_LINK.sub(lambda link: _redirected(link, written, shown), text) for text in pieces[::2]]
    return "".join(pieces)


def _redirected(link: re.Match[str], written: Path, shown: str) -> str:
    target = link["target"]
    if re.match(r"[a-z]+:", target):
        return link[0]
    meant = os.path.normpath(written.parent / target)
    if meant in PAGES:
        page = PAGES[meant]
    elif meant.startswith("docs/"):
        page = meant.removeprefix("docs/")
    elif (ROOT / meant).exists():  # a file that the site does not show
        return link["text"]
    else:
        return link[0]
    return f"{link['open']}({os.path.relpath(page, Path(shown).parent)}{link['anchor'] or ''})"
