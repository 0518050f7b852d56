"""The command line: one file a command, options from dataclasses through tyro."""

from __future__ import annotations

import sys
from collections.abc import Sequence


def main(argv: Sequence[str] | None = None) -> None:
    """Run ``wigwag``: exit code 0 fine, 1 ran and found a failure, 2 wrong use or input."""
    from wigwag.cli.app import run

    sys.exit(run(argv))
